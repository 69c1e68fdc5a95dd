// SPDX-License-Identifier: Apache-2.0
#include "cli/results/varied_plan.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <utility>
#include <weft/core/quote.hpp>
#include <weft/core/text_file.hpp>
#include <weft/core/whole_file.hpp>

#include "cli/output/generated_text.hpp"
#include "cli/output/outcome.hpp"
#include "cli/standard_components.hpp"
#include "lab/ablation/plan/grid.hpp"
#include "lab/metrics/forms/metric_path.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMostValues = 10'000;

struct Varied {
  std::string argument;  ///< "--vary filters.use=filters/aem,filters/vfc"
  std::string path;
  std::vector<yaml::Node> values;
};

/// The ends of "1..8".
std::optional<std::pair<std::int64_t, std::int64_t>> range_in(const yaml::Node& value) {
  const std::size_t dots = value.scalar.find("..");
  if (value.kind != yaml::Kind::scalar || dots == std::string::npos) return std::nullopt;
  const auto first = yaml::as_int64(yaml::plain_node(value.scalar.substr(0, dots)));
  const auto last = yaml::as_int64(yaml::plain_node(value.scalar.substr(dots + 2)));
  if (!first || !last) return std::nullopt;
  return std::pair(*first, *last);
}

Result<Varied> split(const std::string& text) {
  Varied varied{"--vary " + text, text.substr(0, text.find('=')), {}};
  const auto fail = [&](const std::string& message) {
    return Error{Errc::invalid_value, message, varied.argument};
  };
  if (varied.path.empty() || varied.path == text) {
    return fail("expected PATH=VALUE,VALUE, such as filters.use=filters/aem,filters/vfc");
  }
  const auto list = yaml::parse("[" + text.substr(varied.path.size() + 1) + "]", "");
  if (!list || !list->problems.empty()) {
    return fail("its values are no list in YAML: " +
                (list ? list->problems.front().message : list.error().message));
  }
  for (const yaml::Node& value : list->root.items) {
    const auto range = range_in(value);
    if (!range) {
      varied.values.push_back(value);
      continue;
    }
    if (range->second < range->first || range->second - range->first >= kMostValues) {
      return fail(quote(value.scalar) + " must be a range of 1 to " + std::to_string(kMostValues) +
                  " whole numbers, the lower one first");
    }
    for (std::int64_t i = range->first; i <= range->second; ++i) {
      varied.values.push_back(yaml::plain_node(std::to_string(i)));
    }
  }
  if (varied.values.empty()) return fail("it has no value");
  return varied;
}

yaml::Node list_of(const std::vector<yaml::Node>& values) {
  yaml::Node list;
  list.kind = yaml::Kind::sequence;
  list.items = values;
  return list;
}

yaml::Node map_of(std::vector<yaml::Entry> entries) {
  yaml::Node map;
  map.kind = yaml::Kind::map;
  map.entries = std::move(entries);
  return map;
}

/// One entry of a map as text, indented.
std::string entry_text(const std::string& key, const yaml::Node& value, int indent) {
  std::istringstream lines(yaml::emit(map_of({{key, {}, value}})));
  std::string text;
  for (std::string line; std::getline(lines, line);) text += std::string(indent, ' ') + line + "\n";
  return text;
}

std::string name_part(const std::string& text) {
  std::string name = text;
  std::replace_if(
      name.begin(), name.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '_' && c != '.'; }, '_');
  return name;
}

std::string name_of(const VariedPipeline& given) {
  constexpr std::size_t kLongest = 100;
  std::string name = name_part(fs::path(given.pipeline).stem().string());
  for (const std::string& each : given.varied)
    name += "-" + name_part(each.substr(0, each.find('=')));
  return name.substr(0, kLongest);
}

Result<GeneratedText> plan_text(const VariedPipeline& given) {
  std::vector<Varied> axes, data_seeds, run_seeds;
  for (const std::string& text : given.varied) {
    auto varied = split(text);
    if (!varied) return varied.error();
    const std::string& path = varied->path;
    const bool is_data_seed = path == "source.seed" || path == "source.params.seed";
    (is_data_seed ? data_seeds : path == "seed" ? run_seeds : axes).push_back(*std::move(varied));
  }
  for (const auto* seeds : {&data_seeds, &run_seeds}) {
    if (seeds->size() > 1) {
      return Error{Errc::invalid_value, "an earlier one varies the same", seeds->back().argument};
    }
  }
  GeneratedText plan("weft ablate");
  plan.add("# The plan of `weft ablate --vary`; weft ablate runs it again.\nweft: 1\n");
  plan.add("name: " + name_of(given) + "\n");
  plan.add(entry_text("pipeline", yaml::text_node(fs::absolute(given.pipeline).string()), 0),
           given.pipeline);
  const auto first =
      data_seeds.empty() ? std::nullopt : yaml::as_int64(data_seeds.front().values.front());
  const bool is_tuning = first && *first <= static_cast<std::int64_t>(lab::kLastTuningSeed);
  plan.add(std::string("data_use: ") + (is_tuning ? "tuning" : "reporting") + "\n",
           data_seeds.empty() ? "" : data_seeds.front().argument);
  plan.add(data_seeds.empty() ? "data: {own: {}}\n" : "data:\n  own:\n");
  for (const Varied& each : data_seeds) {
    plan.add(entry_text("seeds", list_of(each.values), 4), each.argument);
  }
  for (const Varied& each : run_seeds) {
    plan.add(entry_text("seeds", list_of(each.values), 0), each.argument);
  }
  plan.add(fmt::format("show: [{}, counts.solved_percent]\n", lab::kErrorMetric));
  if (!axes.empty()) plan.add("axes:\n");
  for (const Varied& each : axes) {
    const yaml::Node axis =
        map_of({{"set", {}, yaml::plain_node(each.path)}, {"values", {}, list_of(each.values)}});
    plan.add(entry_text(name_part(each.path), axis, 2), each.argument);
  }
  const auto is_compared = [](const Varied& each) { return each.values.size() > 1; };
  if (std::any_of(axes.begin(), axes.end(), is_compared)) plan.add("comparisons:\n");
  for (const Varied& each : axes) {
    if (!is_compared(each)) continue;
    plan.add(fmt::format("  - {{axis: {}, metric: {}}}\n", name_part(each.path), lab::kErrorMetric),
             each.argument);
  }
  return plan;
}

}  // namespace

std::optional<std::string> write_varied_plan(const VariedPipeline& varied,
                                             const host::Registry& registry,
                                             const ScratchFolder& scratch, bool is_dry,
                                             std::string& folder) {
  const auto fail = [](const Error& error) {
    print_error(error);
    return std::nullopt;
  };
  const std::string& pipeline = varied.pipeline;
  if (auto found = check_input(pipeline, InputKind::file); !found) return fail(found.error());
  if (lab::is_plan(pipeline)) {
    return fail({Errc::invalid_value,
                 "is a plan; --vary is for a pipeline: change the axes of the plan", pipeline});
  }
  const auto text = plan_text(varied);
  if (!text) return fail(text.error());
  const std::string trial = scratch.path() + "/plan.yaml";
  if (auto written = write_whole(text->text(), trial); !written) return fail(written.error());
  const auto [grid, report] =
      lab::load_grid(trial, registry, varied.settings, standard_helpers(), varied.without);
  if (!report.ok()) {
    fmt::print(stderr, "{}", text->report_text(report, trial));
    return std::nullopt;
  }
  if (folder.empty()) folder = "ablations/" + grid.plan().name;
  if (is_dry) return trial;
  const std::string plan = folder + ".yaml";
  std::error_code code;
  fs::create_directories(fs::absolute(plan).parent_path(), code);
  if (auto written = write_whole(text->text(), plan); !written) return fail(written.error());
  fmt::print(stderr, "plan: {}\n", plan);
  return plan;
}

}  // namespace weft::cli
