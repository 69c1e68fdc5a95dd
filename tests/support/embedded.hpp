// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <cstdio>
#include <weft/data/owned.hpp>
#include <weft/embedding/pipeline.hpp>

#include "host/records/npz.hpp"
#include "pipeline/dumps/replay.hpp"
#include "pipeline/runs/frame_loop.hpp"
#include "support/run_lines.hpp"

namespace weft::testing {

/// The output of a pipeline's source, as a program would have it in memory.
struct InMemory {
  Camera camera;
  std::vector<Image> images;
  std::vector<double> times_s;

  static InMemory of(const std::string& file, const host::Registry& registry) {
    InMemory all;
    const auto [config, report] = load_pipeline(file, registry, "run");
    EXPECT_TRUE(report.ok()) << report.text();
    if (!report.ok()) return all;
    host::ExecutionContext context(config.seed, {});
    auto input = PipelineInput::open(config, context);
    EXPECT_TRUE(input) << input.error().message;
    if (!input) return all;
    all.camera = *host::view_as<Camera>(*input->camera());
    for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(input->frames()); ++i) {
      const auto read = input->read(i);
      all.images.push_back(owned_record(*host::view_as<Image>(*read->input.find("image"))));
      all.times_s.push_back(host::view_as<Time>(*read->input.find("time"))->t_s);
    }
    return all;
  }
};

/// Results of a pipeline for all these images; it ends with the first refused one.
inline std::vector<ProcessedFrame> processed(Pipeline& pipeline, const InMemory& given) {
  std::vector<ProcessedFrame> frames;
  for (std::size_t i = 0; i < given.images.size(); ++i) {
    auto frame = pipeline.process(given.images[i], given.times_s[i]);
    EXPECT_TRUE(frame) << frame.error().where << ": " << frame.error().message;
    if (!frame) break;
    frames.push_back(*std::move(frame));
  }
  return frames;
}

/// The shape as a call would have given it; no outputs without one.
inline host::Outcome outcome_of(const std::optional<Shape>& shape) {
  host::Outcome outcome;
  if (shape) outcome.outputs.emplace_back("shape", host::Record::copy_of(*shape));
  return outcome;
}

/// The shape that a run folder has of a frame.
inline host::Outcome outcome_of(const std::string& run_folder, std::size_t frame) {
  char name[40];
  std::snprintf(name, sizeof name, "/frames/%06zu.npz", frame);
  host::Outcome outcome;
  const auto records = host::read_npz(run_folder + name);
  if (!records) return outcome;
  for (const auto& [slot, record] : *records) {
    if (slot == "shape") outcome.outputs.emplace_back(slot, record);
  }
  return outcome;
}

/// The same states, reasons, numbers and, bit for bit, shapes; a run has its source and its sinks
/// beside the stages.
inline void expect_same(const std::vector<ProcessedFrame>& frames, const std::string& run_folder) {
  std::vector<nlohmann::json> lines = timeless(run_folder);
  ASSERT_EQ(frames.size(), lines.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_THAT(differences(outcome_of(run_folder, i), outcome_of(frames[i].shape)),
                ::testing::IsEmpty())
        << "frame " << i;
    nlohmann::json embedded_line = timeless_line(frames[i].report);
    lines[i].erase("records");
    nlohmann::json& stages = lines[i]["stages"];
    ASSERT_GE(stages.size(), embedded_line["stages"].size());
    while (stages.size() > embedded_line["stages"].size()) stages.erase(stages.size() - 1);
    stages.erase(stages.begin());
    embedded_line["stages"].erase(embedded_line["stages"].begin());
    EXPECT_EQ(embedded_line, lines[i]);
  }
}

}  // namespace weft::testing
