// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <weft/core/quote.hpp>
#include <weft/data/owned.hpp>
#include <weft/embedding/pipeline.hpp>

#include "host/loading/registry.hpp"
#include "host/records/value_check.hpp"
#include "pipeline/runs/frame_json.hpp"
#include "pipeline/runs/frame_loop.hpp"
#include "pipeline/runs/warning_log.hpp"

namespace weft {
namespace {

using host::RecordPtr;

/// All errors of a file; the first one gives the place.
Error all_mistakes(const ConfigReport& report) {
  Error error{Errc::invalid_value, {}, {}};
  for (const yaml::Problem& problem : report.problems) {
    const std::string place = place_in(report.sources, problem.at);
    if (error.message.empty()) {
      error.where = place;
      error.message = problem.message;
    } else {
      error.message += "\n" + place + ": " + problem.message;
    }
  }
  return error;
}

/// The inputs that process() takes beside an image and its time.
Result<void> check_inputs(const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    if (input == "correspondences" || input == "known_points") continue;
    return Error{Errc::invalid_value,
                 quote(input) +
                     " is no input of a program's frames; there are \"correspondences\" "
                     "and \"known_points\"",
                 "inputs"};
  }
  return {};
}

Error named(const Error& error, const char* slot) { return {error.code, error.message, slot}; }

Result<void> check_pixels(const Array<std::uint8_t>& pixels) {
  const bool grey = pixels.ndim() == 2, colour = pixels.ndim() == 3 && pixels.dim(2) == 3;
  if (pixels.data() != nullptr && (grey || colour)) return {};
  std::string shape;
  for (int axis = 0; axis < pixels.ndim(); ++axis) {
    shape += (axis > 0 ? "," : "") + std::to_string(pixels.dim(axis));
  }
  return Error{Errc::invalid_data,
               "has pixels of the shape [" + shape + "]; give [H,W] grey levels or [H,W,3] BGR",
               "image"};
}

/// A copy of a record struct that is new in the execution context.
template <class RecordType>
Result<RecordPtr> admitted(host::ExecutionContext& context, const RecordType& typed,
                           const char* slot, std::uint64_t frame = host::kOfflineFrame) {
  const auto record = host::Record::copy_of(typed, context.memory());
  if (record == nullptr) return Error{Errc::no_memory, "cannot be copied: memory is short", slot};
  if (auto valid = context.admit(*record, slot); !valid) return named(valid.error(), slot);
  record->set_frame(frame);
  return RecordPtr(record);
}

/// The child of a fork has none of the threads that its parent's pipelines and the libraries below
/// them work with: a call would wait for them for ever.
Error forked_error(const std::string& remedy) {
  return {Errc::unsupported,
          "this process was forked from one that has opened a pipeline, and has none of its "
          "threads; " +
              remedy,
          "pipeline"};
}

/// True if a process that this one was forked from has opened a pipeline. Notes that this one does.
bool parent_has_opened() {
  static std::atomic<pid_t> first{0};
  pid_t opener = 0;
  return !first.compare_exchange_strong(opener, getpid()) && opener != getpid();
}

/// Images come in the order of their times; those of the same time are taken as they come.
Result<void> check_order(double t_s, double last_s) {
  if (!(t_s < last_s)) return {};
  const auto seconds = [](double value) { return nlohmann::json(value).dump() + " s"; };
  return Error{Errc::invalid_value,
               "the time stamp " + seconds(t_s) + " lies before that of the image before, " +
                   seconds(last_s) + "; give images in the order in which they were taken",
               "time"};
}

ProcessedFrame answer_of(const FrameResult& result) {
  ProcessedFrame answer;
  answer.frame = result.index;
  answer.failed = result.failed();
  answer.report = frame_json(result, {});
  if (result.shape != nullptr) {
    auto shape = host::view_as<Shape>(*result.shape);
    if (shape) answer.shape = owned_record(*std::move(shape));
  }
  for (std::size_t i = 1; i < result.stages.size(); ++i) {  // the first one is that of the input
    const StageReport& stage = result.stages[i];
    answer.stages.push_back(
        {stage.stage.str(), to_string(stage.status), stage.reason.str(), stage.took.ms});
  }
  return answer;
}

}  // namespace

/// Objects that must stay at their addresses while the stages run.
class Pipeline::Opened {
 public:
  explicit Opened(const std::vector<std::string>& plugin_path)
      : registry_(host::Registry::scan(host::search_path(plugin_path))) {}

  Result<void> check(const std::string& file, const PipelineOptions& options) {
    auto document =
        read_document(file, options.settings, registry_, host::PathRules::of_process({}, ""));
    document.in_program = true;
    document.given = options.inputs;
    auto [pipeline, report] = check_pipeline(file, std::move(document), registry_, "");
    if (!report.ok()) return all_mistakes(report);
    pipeline_ = std::move(pipeline);
    PipelineConfig& config = pipeline_.config;
    config.frames_at_once = 1;  // so that a call has all threads
    config.latest_only = false;
    for (StageConfig& stage : config.stages) {
      if (stage.isolation) stage.isolation->program = options.worker;
    }
    if (config.templ->isolation) config.templ->isolation->program = options.worker;
    return {};
  }

  Result<void> open(const Camera& camera) {
    auto context =
        context_of(pipeline_.config,
                   [this](const std::string& component, int level, const std::string& text,
                          std::uint64_t frame) { warnings_.note(component, level, text, frame); });
    if (!context) return context.error();
    context_ = *std::move(context);
    auto given = admitted(*context_, camera, "camera");
    if (!given) return given.error();
    auto loop = FrameLoop::open(pipeline_, *context_, *std::move(given));
    if (!loop) return loop.error();
    loop_ = *std::move(loop);
    auto templ = host::view_as<Template>(*loop_->input().templ());
    if (!templ) return templ.error();
    template_ = *std::move(templ);
    return {};
  }

  const Template& templ() const { return template_; }

  bool is_forked() const { return opener_ != getpid(); }

  Result<ProcessedFrame> process(const FrameInputs& inputs, double t_s) {
    if (is_forked()) return forked_error("load a pipeline in a process that is started anew");
    if (inputs.image) {
      if (auto legal = check_pixels(inputs.image->pixels); !legal) return legal.error();
    }
    host::NamedRecords records(context_->memory());
    auto added = add(inputs.image, "image", records);
    if (added) added = add(std::optional(Time{t_s}), "time", records);
    if (added) added = check_order(t_s, last_s_);
    if (added) added = add(inputs.correspondences, "correspondences", records);
    if (added) added = add(inputs.known_points, "known_points", records);
    if (!added) return added.error();
    auto frame = loop_->input().take(frames_, std::move(records));
    if (!frame) return frame.error();
    const FrameResult result = loop_->process(*frame);
    ProcessedFrame answer = answer_of(result);
    last_s_ = t_s;
    warnings_.file(frames_++);
    for (const std::string& text : result.warnings) answer.warnings.push_back("setup: " + text);
    for (const RunWarning& warning : warnings_.take()) {
      answer.warnings.push_back(warning.component + ": " + warning.text);
    }
    return answer;
  }

 private:
  /// Copies an input into the execution context if there is one.
  template <class RecordType>
  Result<void> add(const std::optional<RecordType>& typed, const char* slot,
                   host::NamedRecords& records) {
    if (!typed) return {};
    const std::string_view name = slot;
    const std::vector<std::string>& given = pipeline_.config.given;
    const bool is_given = std::find(given.begin(), given.end(), name) != given.end();
    if (name != "image" && name != "time" && !is_given) {
      return Error{Errc::invalid_value,
                   "the pipeline was loaded without this input; add \"" + std::string(slot) +
                       "\" to the inputs of its options",
                   slot};
    }
    auto record = admitted(*context_, *typed, slot, frames_);
    if (!record) return record.error();
    if (auto legal = host::check_values((*record)->view(slot)); !legal) {
      return named(legal.error(), slot);
    }
    records.emplace_back(slot, *std::move(record));
    return {};
  }

  host::Registry registry_;
  CheckedPipeline pipeline_;
  WarningLog warnings_;
  std::unique_ptr<host::ExecutionContext> context_;
  std::unique_ptr<FrameLoop> loop_;
  Template template_;  ///< borrows from the loop
  std::uint64_t frames_ = 0;
  double last_s_ = -std::numeric_limits<double>::infinity();  ///< [] s of the last image
  pid_t opener_ = getpid();
};

Pipeline::Pipeline(std::unique_ptr<Opened> opened) : opened_(std::move(opened)) {}
Pipeline::Pipeline(Pipeline&& other) noexcept = default;

Pipeline& Pipeline::operator=(Pipeline&& other) noexcept {
  const Pipeline before(std::move(*this));
  opened_ = std::move(other.opened_);
  return *this;
}

/// Threads that only the parent has cannot be ended here, nor are its worker processes this one's.
Pipeline::~Pipeline() {
  if (opened_ && opened_->is_forked()) static_cast<void>(opened_.release());
}

Result<Pipeline> Pipeline::load(const std::string& file, const Camera& camera,
                                const PipelineOptions& options) {
  if (parent_has_opened()) {
    return forked_error(
        "start it anew instead (in Python: multiprocessing's \"spawn\"), or open "
        "pipelines in the children alone");
  }
  if (auto legal = check_inputs(options.inputs); !legal) return legal.error();
  auto opened = std::make_unique<Opened>(options.plugin_path);
  if (auto checked = opened->check(file, options); !checked) return checked.error();
  if (auto ready = opened->open(camera); !ready) return ready.error();
  return Pipeline(std::move(opened));
}

const Template& Pipeline::templ() const { return opened_->templ(); }

Result<ProcessedFrame> Pipeline::process(const Image& image, double t_s) {
  return opened_->process({.image = image}, t_s);
}

Result<ProcessedFrame> Pipeline::process(const FrameInputs& inputs, double t_s) {
  return opened_->process(inputs, t_s);
}

}  // namespace weft
