// SPDX-License-Identifier: Apache-2.0
// results_benchmark make FOLDER [CELLS [FRAMES [SEED]]]: writes the results folder of an ablation
// that nobody ran: 20 solvers at five strengths of noise, otherwise as many sequences as give the
// cells, one seed; errors are random, a cell in fifty failed.
// results_benchmark scan FOLDER: reads what is finished, as an ablation does that goes on.
// results_benchmark report FOLDER [ASSETS]: writes its report.
// Each prints its time on the wall and of the processor, and the most memory that it had.
#include <fmt/core.h>
#include <fmt/ranges.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>
#include <weft/core/rng.hpp>

#include "metrics/forms/json.hpp"
#include "report/report.hpp"
#include "results/cell_line.hpp"
#include "results/cell_record.hpp"
#include "results/plan_record.hpp"

namespace weft::evaluation {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr int kSolvers = 20, kNoises = 5, kFiles = 8;
constexpr double kShareFailed = 0.02;

struct Size {
  std::int64_t cells = 10'000;
  int frames = 10;
  std::uint64_t seed = 1;
};

PlanRecord plan_of(const Size& size) {
  PlanRecord plan;
  plan.name = "results_benchmark";
  plan.command =
      fmt::format("results_benchmark make FOLDER {} {} {}", size.cells, size.frames, size.seed);
  PlanAxis solver{"solver", {}, "", {}, {}}, noise{"noise", {}, "source.noise_px", {}, {}};
  for (int i = 0; i < kSolvers; ++i) solver.values.push_back(fmt::format("solver_{}", i));
  for (int i = 0; i < kNoises; ++i) {
    noise.values.push_back(fmt::format("px_{}", i));
    noise.numbers.push_back(i);
  }
  plan.axes = {solver, noise};
  plan.seeds = {1};
  plan.show = {"all.error_solved.mean_mm", "counts.solved_percent"};
  plan.comparisons = {{"solver", "all.error_solved.mean_mm", "solver_0"}};
  const std::int64_t sequences = std::max<std::int64_t>(1, size.cells / (kSolvers * kNoises));
  for (std::int64_t s = 0; s < sequences; ++s) plan.sequences.push_back(fmt::format("s_{}", s));
  plan.data = {{"s", plan.sequences}};
  for (std::int64_t index = 0; index < size.cells; ++index) {
    const auto combination = static_cast<std::size_t>(index / sequences);
    if (combination >= std::size_t{kSolvers} * kNoises) break;
    plan.cells.push_back(
        {index,
         {solver.values[combination / kNoises], noise.values[combination % kNoises]},
         plan.sequences[static_cast<std::size_t>(index % sequences)],
         1,
         fmt::format("{:032x}", index + 1),
         ""});
  }
  return plan;
}

RunMetrics metrics_of(const Size& size, double level_mm, Rng& rng) {
  RunMetrics metrics;
  metrics.run = "cell";
  double sum_mm = 0.0, worst_mm = 0.0;
  for (int t = 0; t < size.frames; ++t) {
    FrameMetrics frame;
    frame.frame = static_cast<std::uint64_t>(t);
    frame.has_truth = true;
    frame.outcome = FrameOutcome::solved;
    frame.state = ShapeState::estimated;
    frame.error = PointSummary{};
    frame.error->mean_mm = level_mm * std::exp(0.3 * rng.normal());
    sum_mm += frame.error->mean_mm;
    worst_mm = std::max(worst_mm, frame.error->mean_mm);
    metrics.frames.push_back(frame);
  }
  metrics.counts.frames = metrics.counts.estimated = size.frames;
  metrics.all.frames = metrics.all.solved = metrics.all.solved_error.frames = size.frames;
  metrics.all.solved_error.mean_mm = sum_mm / size.frames;
  metrics.all.solved_error.worst_mm = worst_mm;
  metrics.all.solved_error.worst_frame = "0";
  return metrics;
}

std::string line_of(const PlanCell& cell, const Size& size, const CellFile& file, Rng& rng) {
  const auto combination = static_cast<double>(std::stoi(cell.values[0].substr(7)));
  const double level_mm = 1.0 + 0.05 * combination + 0.3 * std::stoi(cell.values[1].substr(3));
  const bool failed = rng.uniform() < kShareFailed;
  return checked_line(
      {{"schema", kLineSchema},
       {"key", cell.key},
       {"rebuilt_key", cell.key},
       {"outcome", failed ? "failed" : "done"},
       {"reason", failed ? "the worker ended with signal 11" : ""},
       {"metrics", failed ? ordered_json() : json_of(metrics_of(size, level_mm, rng))},
       {"stages",
        {{{"stage", "warps"}, {"key", cell.key}}, {{"stage", "solvers"}, {"key", cell.key}}}},
       {"timing", {{"cached", true}}},
       {"machine", {{"processor", "none"}, {"executed", {"solvers"}}}},
       {"files", {{{"name", file.name}, {"bytes", file.bytes}, {"hash", file.hash}}}}});
}

void write(const std::string& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

bool make(const std::string& folder, const Size& size) {
  fs::create_directories(folder + "/results");
  write(folder + "/manifest.json",
        ordered_json{{"schema", kFolderSchema}, {"weft", "0.0.0"}, {"plan", "results_benchmark"}}
                .dump(1) +
            "\n");
  const PlanRecord plan = plan_of(size);
  write(folder + "/plan.json", to_json(plan));
  const std::string settings = "weft: 1\n";
  const CellFile file{"pipeline.yaml", settings.size(), std::string(kKeyDigits, '0')};
  std::vector<std::ofstream> files;
  for (int i = 0; i < kFiles; ++i) {
    files.emplace_back(fmt::format("{}/results/cached-{:06}.jsonl", folder, i + 1),
                       std::ios::binary);
  }
  Rng rng(size.seed);
  std::uintmax_t bytes = 0;
  for (const PlanCell& cell : plan.cells) {
    const std::string line = line_of(cell, size, file, rng) + "\n";
    bytes += line.size();
    files[static_cast<std::size_t>(cell.index % kFiles)] << line;
    fs::create_directories(folder + "/cells/" + cell.key);
    write(folder + "/cells/" + cell.key + "/pipeline.yaml", settings);
  }
  fmt::print("{} cells of {} frames, seed {}: {:.1f} MB of lines\n", plan.cells.size(), size.frames,
             size.seed, static_cast<double>(bytes) / 1e6);
  return true;
}

bool scan(const std::string& folder) {
  const auto records = read_cell_records(folder, {{}, false, false, false});
  if (!records) fmt::print("{}: {}\n", records.error().where, records.error().message);
  if (!records) return false;
  fmt::print("{} finished, {} damaged\n", records->cells.size(), records->damaged.size());
  return true;
}

bool report(const std::string& folder, const std::string& assets) {
  const auto files = write_report(folder, {"", assets});
  if (!files) fmt::print("{}: {}\n", files.error().where, files.error().message);
  if (!files) return false;
  fmt::print("{}: {:.1f} MB\n", files->page, static_cast<double>(fs::file_size(files->page)) / 1e6);
  return true;
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

int run(const std::vector<std::string>& words) {
  const auto number = [&](std::size_t i, std::int64_t otherwise) {
    return i < words.size() ? std::stoll(words[i]) : otherwise;
  };
  const std::string what = words.empty() ? "" : words[0];
  const auto start = std::chrono::steady_clock::now();
  bool good = false;
  if (what == "make" && words.size() > 1) {
    good = make(words[1], {number(2, 10'000), static_cast<int>(number(3, 10)),
                           static_cast<std::uint64_t>(number(4, 1))});
  } else if (what == "scan" && words.size() > 1) {
    good = scan(words[1]);
  } else if (what == "report" && words.size() > 1) {
    good = report(words[1], words.size() > 2 ? words[2] : WEFT_REPORT_ASSETS);
  } else {
    fmt::print("usage: make FOLDER [CELLS [FRAMES [SEED]]] | scan FOLDER | report FOLDER\n");
    return 2;
  }
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  fmt::print("{}: {:.2f} s on the wall, {:.2f} s user, {:.2f} s system, at most {:.0f} MB\n", what,
             wall.count(), seconds(used.ru_utime), seconds(used.ru_stime),
             static_cast<double>(used.ru_maxrss) / 1024.0);
  return good ? 0 : 1;
}

}  // namespace
}  // namespace weft::evaluation

int main(int argc, char** argv) { return weft::evaluation::run({argv + 1, argv + argc}); }
