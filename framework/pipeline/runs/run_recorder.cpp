// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/run_recorder.hpp"

namespace weft {

Result<RunRecorder> RunRecorder::create(const std::string& path, const CheckedPipeline& pipeline,
                                        const PipelineInput& input,
                                        const std::vector<std::string>& dumped_stages,
                                        bool keeps_records) {
  auto folder = RunFolder::create(path);
  if (!folder) return folder.error();
  const auto fail = [&](const Error& error) {
    folder->withdraw();
    return error;
  };
  const auto begun =
      folder->begin(pipeline.config, *input.templ(), *input.camera(), input.frames());
  if (!begun) return fail(begun.error());
  auto trace = Trace::create(folder->path() + "/trace.json");
  if (!trace) return fail(trace.error());
  auto dump =
      Dump::create(folder->path(), pipeline.config, dumped_stages, input.templ(), input.camera());
  if (!dump) return fail(dump.error());
  return RunRecorder(pipeline, *std::move(folder), *std::move(trace), *std::move(dump),
                     keeps_records);
}

Result<void> RunRecorder::add(const FrameOnItsWay& frame) {
  const FrameResult& result = frame.result;
  const auto records = keeps_records_ ? frame_records(pipeline_->graph, result,
                                                      frame.read.input.find("ground_truth"))
                                      : host::NamedRecords();
  if (auto added = folder_.add(result, records); !added) return added;
  if (auto added = trace_.add(result); !added) return added;
  return dump_.add(result);
}

Result<void> RunRecorder::add(host::Timings calls) { return trace_.add(std::move(calls)); }

Result<void> RunRecorder::end(const RunSummary& summary) const {
  return folder_.end(summary, pipeline_->config.latest_only);
}

}  // namespace weft
