// SPDX-License-Identifier: Apache-2.0
#include "cli/data/match_reader.hpp"

#include <filesystem>
#include <weft/core/quote.hpp>
#include <weft/truth/match_labels.hpp>

#include "cli/standard_components.hpp"
#include "host/calling/execution_context.hpp"
#include "host/roles/role_rules.hpp"
#include "lab/metrics/runs/run_reader.hpp"
#include "pipeline/configuration/config.hpp"
#include "pipeline/execution/checks.hpp"
#include "pipeline/survey/data_layout.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;
using host::Outcome;
using lab::FrameRecords;
using lab::MatchRecords;
using lab::RunReader;

/// Copies what the frames of a source hold.
Result<void> copy_source(const host::ComponentSpec& spec, const std::atomic<bool>& cancel,
                         MatchWriter& writer) {
  host::ExecutionContext context(0, {});
  context.cancellation().watch([&] { return cancel.load(); });
  const auto source = context.instantiate(spec, "sources");
  if (!source) return source.error();
  const Outcome opened = context.call(**source, kOpenSource, {}, host::kOfflineFrame);
  if (!opened.usable()) return opened.error;
  if (auto valid = check_camera(*opened.find("camera")); !valid) return valid;
  if (auto begun = writer.begin(*host::view_as<weft::Camera>(*opened.find("camera"))); !begun)
    return begun;
  const Outcome counted = context.call(**source, kCountFrames, {}, host::kOfflineFrame);
  if (!counted.usable()) return counted.error;
  const std::int64_t count = host::view_as<Count>(*counted.find("count"))->frames;
  for (std::int64_t i = 0; (count < 0 || i < count) && !cancel.load(); ++i) {
    const Outcome read = context.call(**source, kReadFrame, {}, static_cast<std::uint64_t>(i));
    if (count < 0 && read.status == WEFT_NO_RESULT) break;
    if (!read.usable() && cancel.load()) break;
    if (!read.usable()) return read.error;
    const host::RecordPtr matches = read.find("correspondences"), truth = read.find("ground_truth");
    if (matches == nullptr) continue;
    std::optional<GroundTruth> known;
    if (truth != nullptr) known = *host::view_as<GroundTruth>(*truth);
    auto copied =
        writer.add(static_cast<std::uint64_t>(i), *host::view_as<Correspondences>(*matches), known);
    if (!copied) return copied;
  }
  return {};
}

/// The matches of STAGE, or what is left of them behind STAGE.FILTER, in one frame of a run.
class StageMatches {
 public:
  StageMatches(const RunReader& run, const MatchOrigin& origin) : run_(run), origin_(origin) {}

  /// Nothing where the stage made none in this frame.
  Result<std::optional<Correspondences>> in(const FrameRecords& frame) const {
    const std::size_t dot = origin_.stage.find('.');
    const std::string stage = origin_.stage.substr(0, dot);
    std::string known;
    for (const MatchRecords& made : frame.matches) {
      known += (known.empty() ? "" : ", ") + made.stage;
      for (const auto& filter : made.filters) known += ", " + made.stage + "." + filter.stage;
      if (stage.empty() && frame.matches.size() > 1) continue;
      if (!stage.empty() && made.stage != stage) continue;
      if (dot == origin_.stage.npos) return std::optional(made.matches);
      for (const auto& filter : made.filters) {
        if (filter.stage != origin_.stage.substr(dot + 1)) continue;
        Correspondences left = made.matches;
        left.kept = filter.after;
        left.score = filter.score;
        return std::optional(std::move(left));
      }
    }
    if (known.empty()) return std::optional<Correspondences>();
    return Error{Errc::invalid_value,
                 (stage.empty() ? "several stages made matches: choose one with --stage"
                                : "no stage " + quote(origin_.stage) + " made matches") +
                     ", of " + known,
                 run_.folder()};
  }

 private:
  const RunReader& run_;
  const MatchOrigin& origin_;
};

/// Labels where the truth has no true images of the matches themselves.
Result<void> add_labels(const Correspondences& matches, const RunReader& run, double tolerance_px,
                        GroundTruth& truth) {
  const auto map = TruthMap::create(truth);
  if (!map) return map.error();
  if (has_own_truth(matches, *map)) return {};
  const weft::Camera& c = run.camera();
  const auto labels =
      label_matches(matches, *map, run.sheet(), Pinhole{c.fx, c.fy, c.cx, c.cy}, tolerance_px);
  truth.match_xy_px = {};
  truth.match_label = Array<std::int8_t>({matches.count()});
  std::copy(labels.begin(), labels.end(), truth.match_label.data());
  return {};
}

Result<void> copy_run(const MatchOrigin& origin, const std::atomic<bool>& cancel,
                      MatchWriter& writer) {
  const auto run = RunReader::open(origin.path);
  if (!run) return run.error();
  if (auto begun = writer.begin(run->camera()); !begun) return begun;
  const StageMatches stage(*run, origin);
  for (const lab::FrameLine& line : run->lines()) {
    if (cancel.load()) break;
    auto frame = run->read(line);
    if (!frame) return frame.error();
    const auto matches = stage.in(*frame);
    if (!matches) return matches.error();
    if (!*matches) continue;
    std::optional<GroundTruth> truth = frame->ground_truth;
    if (truth) {
      auto labelled = add_labels(**matches, *run, origin.tolerance_px, *truth);
      if (!labelled) return labelled;
    }
    if (auto copied = writer.add(line.frame, **matches, truth); !copied) return copied;
  }
  return {};
}

std::string pipeline_in(const MatchOrigin& origin) {
  std::error_code code;
  const fs::path path(origin.path);
  for (const char* name : {"pipeline.yaml", "sequence.yaml"}) {
    if (fs::is_regular_file(path / name, code)) return (path / name).string();
  }
  const bool is_yaml = path.extension() == ".yaml" || path.extension() == ".yml";
  return is_yaml ? origin.path : std::string();
}

/// Fails where an option could change nothing.
Result<void> check_options(const MatchOrigin& origin, bool is_run, bool has_pipeline) {
  if (!is_run && !origin.stage.empty()) {
    return Error{Errc::invalid_value, "is no run folder: leave --stage out", origin.path};
  }
  if (origin.settings.empty() || (has_pipeline && !is_run)) return {};
  return Error{Errc::invalid_value, "--set changes pipelines only: leave it out", origin.path};
}

}  // namespace

Result<yaml::Node> read_matches(const MatchOrigin& origin, const host::Registry& registry,
                                const std::atomic<bool>& cancel, MatchWriter& writer) {
  yaml::Node templ;
  const std::string file = pipeline_in(origin);
  std::error_code code;
  const bool is_run = fs::is_regular_file(fs::path(origin.path) / "frames.jsonl", code);
  if (auto fits = check_options(origin, is_run, !file.empty()); !fits) return fits.error();
  std::optional<host::ComponentSpec> source;
  if (!file.empty()) {
    auto [config, report] = load_pipeline(file, registry, "", origin.settings);
    if (!report.ok() && !origin.settings.empty()) {
      return Error{Errc::invalid_value, report.problems.front().message, file};
    }
    if (report.ok()) {
      templ = config.templ->component.effective;
      source = std::move(config.source->component);
    }
  }
  if (is_run) {
    if (auto copied = copy_run(origin, cancel, writer); !copied) return copied.error();
    return templ;
  }
  if (!source) {
    const auto layout = find_data_layout(origin.path, standard_sources(), origin.camera);
    if (!layout) return layout.error();
    std::vector<yaml::Problem> problems;
    source = host::resolve_component(
        registry, *layout->source.find("use"), layout->source.find("params"),
        host::PathRules::of_process({layout->folder}, layout->folder), problems);
    if (!source) return Error{Errc::invalid_value, problems.front().message, origin.path};
  }
  if (auto copied = copy_source(*source, cancel, writer); !copied) return copied.error();
  return templ;
}

}  // namespace weft::cli
