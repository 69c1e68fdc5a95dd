// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/cell_group.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <utility>
#include <weft/core/index.hpp>

#include "lab/ablation/kept_frames.hpp"
#include "lab/ablation/worst_frames.hpp"
#include "lab/metrics/runs/run_reader.hpp"
#include "lab/results/cell_line.hpp"
#include "pipeline/execution/input.hpp"
#include "pipeline/runs/run_folder.hpp"

namespace weft::lab {
namespace {

using Clock = std::chrono::steady_clock;
using host::RecordPtr;

void add_facts(const host::ComponentSpec& spec, RunMetrics& metrics) {
  const host::ComponentManifest& component = spec.component();
  if (component.uses_truth) metrics.truth_users.push_back(component.id);
  add_implements(component.id, component.implements, metrics.implements);
  for (const host::NestedSpec& nested : spec.nested) add_facts(nested.component, metrics);
}

std::string text_of(const Error& error) {
  return (error.where.empty() ? "" : error.where + ": ") + error.message;
}

/// True if a failure depends on the pipeline and its data. Other failures may not occur the next
/// time, on the same machine: memory, files that are gone, libraries that cannot be loaded.
bool is_own(Errc code) {
  constexpr Errc kNotOwn[] = {Errc::no_memory, Errc::io, Errc::not_found, Errc::incompatible,
                              Errc::cancelled};
  return std::find(std::begin(kNotOwn), std::end(kNotOwn), code) == std::end(kNotOwn);
}

/// Common parts of the cells of a group.
struct Common {
  host::ExecutionContext& context;
  PipelineInput input;
  RunReader scene;
  StageMemo memo{};
};

/// A cell on its way through the frames.
class Member {
 public:
  Member(const Cell& cell, CheckedPipeline pipeline, std::vector<std::string> stage_keys)
      : cell_(cell), pipeline_(std::move(pipeline)) {
    cell_.identity.stages = std::move(stage_keys);
    result_.pipeline = effective_yaml(pipeline_.config);
  }

  const Cell& cell() const { return cell_; }
  const CheckedPipeline& pipeline() const { return pipeline_; }
  const PipelineConfig& config() const { return pipeline_.config; }

  /// Makes the stages that no member before it has made.
  void open(Common& common, const Measurement& measurement) {
    deadline_s_ = measurement.deadline_s;
    common.context.use_seed(cell_.seed);
    auto executor =
        Executor::create(pipeline_.config, pipeline_.graph, common.context, common.input.templ(),
                         common.input.camera(), {&common.memo, cell_.identity.stages});
    if (!executor) return fail(executor.error());
    auto evaluator = RunEvaluator::create(common.scene, measurement.options, config().is_sequence);
    if (!evaluator) return fail(text_of(evaluator.error()));
    executor_ = *std::move(executor);
    evaluator_.emplace(*std::move(evaluator));
    for (const std::string& stage : cell_.stages) result_.timings.push_back({stage, {}, {}});
  }

  /// Runs and measures a frame, unless the cell has ended.
  void process(const Common& common, const PipelineInput::Frame& read,
               const RecordPtr& kept_truth) {
    if (has_ended()) return;
    FrameResult frame = executor_->process(read.input);
    for (std::size_t i = 0; i < frame.stages.size(); ++i) take(frame.stages[i], i);
    frame.stages.insert(frame.stages.begin(), read.report);
    note_error(frame);
    const FrameLine line{frame.index, frame.stem, frame.state, frame.failed()};
    const auto sorted =
        common.scene.sort(frame_records(pipeline_.graph, frame, read.input.find("ground_truth")),
                          line, "frame " + std::to_string(frame.index));
    const auto measured = sorted ? evaluator_->add(line, *sorted) : Result<void>(sorted.error());
    if (!measured) return fail("cannot be measured: " + text_of(measured.error()));
    kept_.add(frame.index, frame.shape, kept_truth);
    const int matches = pipeline_.graph.latest("correspondences");
    const RecordPtr none;
    worst_.add(evaluator_->frames().back(),
               {{"image", read.input.find("image")},
                {"shape", frame.shape},
                {"correspondences", matches >= 0 ? frame.values[to_index(matches)] : none}});
    if (frame.failed() && config().stop_on_error) {
      blame_frames(first_error_.message + " (on_error: stop)");
    }
    if (!has_ended() && deadline_s_ > 0.0 && spent_ms_ > 1e3 * deadline_s_) {
      fail(fmt::format("frame {}: it ran longer than its deadline (deadline_s: {:g})", frame.index,
                       deadline_s_));
    }
  }

  void draw(const std::string& sink, const host::Registry& registry, const Common& common) {
    result_.pictures =
        worst_.draw(sink, registry, common.context, common.input.templ(), common.input.camera());
  }

  void fail(const std::string& reason) { result_.failure = reason; }
  void fail(const Error& error) {
    (is_own(error.code) ? result_.failure : result_.left) = text_of(error);
  }
  void leave(const std::string& reason) { result_.left = reason; }

  /// `templ` is the template as it is kept.
  CellResult finish(const RecordPtr& templ) {
    if (evaluator_) measure();
    result_.first_error = first_error_.message;
    host::NamedRecords shapes = kept_.records();
    if (!shapes.empty()) shapes.emplace(shapes.begin(), "template", templ);
    result_.shapes = std::move(shapes);
    return std::move(result_);
  }

 private:
  bool has_ended() const { return !result_.failure.empty() || !result_.left.empty(); }

  void take(const StageReport& report, std::size_t stage) {
    if (report.shared) return;
    spent_ms_ += report.took.ms;
    if (report.status != StageStatus::skipped) {
      result_.timings[stage].ms.push_back(report.took.ms);
      result_.timings[stage].processor_ms.push_back(report.took.processor_ms);
    }
    std::vector<std::string>& executed = result_.executed;
    if (std::find(executed.begin(), executed.end(), report.stage) == executed.end()) {
      executed.push_back(report.stage);
    }
  }

  void note_error(const FrameResult& frame) {
    for (const StageReport& report : frame.stages) {
      if (report.status != StageStatus::error) continue;
      const Error error{
          report.code,
          "frame " + std::to_string(frame.index) + ", " + report.stage + ": " + report.reason,
          {}};
      if (error.code == Errc::no_memory && result_.left.empty()) leave(error.message);
      if (first_error_.message.empty()) {
        first_error_ = error;
        // Stages compute; files are read by the source.
        lost_input_ = &report == &frame.stages.front() && !is_own(report.code);
      }
    }
  }

  /// The rule of `weft run`, and that some frame must be without an error.
  void judge(const FrameCounts& counts) {
    if (has_ended()) return;
    if (counts.frames == 0) return fail("the source has no frames");
    const bool all = counts.failed == counts.frames;
    if (!all && counts.failed <= config().max_failed) return;
    blame_frames((all ? "every frame had an error"
                      : too_many_failed(counts.failed, counts.frames, config().max_failed)) +
                 "; the first: " + first_error_.message);
  }

  void blame_frames(const std::string& reason) { lost_input_ ? leave(reason) : fail(reason); }

  void measure() {
    const auto& stages = pipeline_.config.stages;
    RunMetrics metrics =
        evaluator_->finish(std::any_of(stages.begin(), stages.end(), [](const StageConfig& stage) {
          return rules_of(stage.role).solves;
        }));
    metrics.run = cell_.identity.key;
    for (const StageConfig& stage : stages) {
      add_facts(stage.component, metrics);
    }
    judge(metrics.counts);
    result_.metrics = std::move(metrics);
  }

  Cell cell_;
  CheckedPipeline pipeline_;
  std::unique_ptr<Executor> executor_;
  std::optional<RunEvaluator> evaluator_;
  KeptFrames kept_;
  WorstFrames worst_;
  Error first_error_{};      ///< error of a frame; without a message while there is none
  bool lost_input_ = false;  ///< the source could not read that frame's files
  double deadline_s_ = 0.0;  ///< 0: none
  double spent_ms_ = 0.0;    ///< by the stages that it executed
  CellResult result_;
};

class Group {
 public:
  Group(const Grid& grid, const std::vector<const Cell*>& cells, GroupObserver& observer)
      : grid_(grid), observer_(observer) {
    for (const Cell* cell : cells) {
      auto [pipeline, report] = grid.load(*cell);
      if (report.ok()) {
        auto keys = grid.stage_keys(pipeline);
        members_.emplace_back(*cell, std::move(pipeline), std::move(keys));
      } else {
        observer_.cell_left(*cell, report.text());
      }
    }
  }

  Result<void> run() {
    if (members_.empty()) return {};
    const auto context = make_context();
    auto common = context ? open(**context) : context.error();
    if (common) {
      for (Member& member : members_) {
        observer_.cell_works();
        member.open(*common, grid_.plan().measurement);
      }
      run_frames(*common);
      for (Member& member : members_) {
        observer_.cell_works();
        member.draw(grid_.plan().helpers.picture_sink, grid_.registry(), *common);
      }
    } else {
      for (Member& member : members_) member.fail(common.error());
    }
    const RecordPtr templ = common ? without_texture(*common->input.templ()) : nullptr;
    for (Member& member : members_) {
      if (auto kept = hand_over(member, templ); !kept) return kept;
    }
    return {};
  }

 private:
  /// A result belongs to the data of the cell's key, or there is none.
  Result<void> hand_over(Member& member, const RecordPtr& templ) {
    observer_.cell_works();
    const std::string changed = grid_.changed_input(member.pipeline());
    CellResult result = member.finish(templ);
    const auto now = Clock::now();
    result.seconds = std::chrono::duration<double>(now - std::exchange(since_, now)).count();
    if (!changed.empty()) {
      observer_.cell_left(member.cell(), "its data changed while it ran: " + changed);
    } else if (!result.left.empty()) {
      observer_.cell_left(member.cell(), result.left);
    } else {
      return observer_.cell_done(member.cell(), result);
    }
    return {};
  }

  /// Records are in shared memory if a stage runs in a separate process.
  Result<std::unique_ptr<host::ExecutionContext>> make_context() {
    const bool any = std::any_of(members_.begin(), members_.end(), [](const Member& member) {
      return has_isolated(member.config());
    });
    std::shared_ptr<host::SharedArena> arena;
    if (any) {
      auto made = host::SharedArena::create();
      if (!made) return made.error();
      arena = *std::move(made);
    }
    return std::make_unique<host::ExecutionContext>(members_.front().cell().seed,
                                                    host::ExecutionContext::Log(), arena);
  }

  Result<Common> open(host::ExecutionContext& context) {
    auto input = PipelineInput::open(members_.front().config(), context);
    if (!input) return input.error();
    auto scene = RunReader::in_memory("the template",
                                      {{"template", input->templ()}, {"camera", input->camera()}});
    if (!scene) return scene.error();
    return Common{context, *std::move(input), *std::move(scene)};
  }

  void run_frames(Common& common) {
    const std::int64_t frames = common.input.frames();
    for (std::int64_t index = 0; frames < 0 || index < frames; ++index) {
      const auto read = common.input.read(static_cast<std::uint64_t>(index));
      if (!read) break;
      const RecordPtr truth = read->input.find("ground_truth");
      const RecordPtr kept_truth = truth != nullptr ? thinned(*truth) : nullptr;
      common.memo.next_frame();
      for (Member& member : members_) {
        observer_.cell_works();
        member.process(common, *read, kept_truth);
      }
      observer_.frame_done(index + 1, frames);
    }
  }

  const Grid& grid_;
  GroupObserver& observer_;
  Clock::time_point since_ = Clock::now();
  std::deque<Member> members_;  ///< executors refer to what is in them
};

}  // namespace

Result<void> run_group(const Grid& grid, const std::vector<const Cell*>& cells,
                       GroupObserver& observer) {
  return Group(grid, cells, observer).run();
}

}  // namespace weft::lab
