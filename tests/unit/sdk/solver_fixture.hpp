// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/owned.hpp>
#include <weft/sdk/solver.hpp>

namespace weft::welding_test {

/// A host that keeps the output arrays of a call, and the templates that go to nested components.
struct OutputHost {
  OutputHost() {
    table = {sizeof(table), WEFT_ABI_MAJOR, WEFT_ABI_MINOR, "",      "",     &alloc,
             &is_cancelled, nullptr,        &invoke,        nullptr, nullptr};
    call = {sizeof(call), 0, &table, this, 42, 9, 3, 0};
  }
  OutputHost(const OutputHost&) = delete;

  struct Kept {
    std::vector<std::int64_t> shape;
    std::vector<std::uint64_t> words;

    const double* numbers() const { return reinterpret_cast<const double*>(words.data()); }
    const std::uint8_t* bytes() const {
      return reinterpret_cast<const std::uint8_t*>(words.data());
    }
  };

  static OutputHost& of(const weft_call* raw) { return *static_cast<OutputHost*>(raw->context); }
  static void* alloc(const weft_call* raw, const weft_output* output) {
    Kept& kept = of(raw).outputs[output->array];
    kept.shape.assign(output->shape, output->shape + output->ndim);
    std::int64_t bytes = dtype_size(output->dtype);
    for (const std::int64_t length : kept.shape) bytes *= length;
    kept.words.assign(to_index(bytes) / 8 + 1, 0);
    return kept.words.data();
  }
  static std::int32_t is_cancelled(const weft_call*) { return 0; }
  static std::int32_t invoke(const weft_call* raw, weft_invocation* asked, weft_error* error) {
    for (std::uint64_t i = 0; i < asked->input_count; ++i) {
      if (std::string_view(asked->inputs[i].type) != Template::kType) continue;
      of(raw).nested_revisions.push_back(asked->inputs[i].revision);
      of(raw).nested_seams.push_back(find_array(asked->inputs[i], "welded_vertex") != nullptr);
    }
    error->code = static_cast<std::int32_t>(Errc::unsupported);
    return WEFT_ERROR;
  }

  weft_host table{};
  weft_call call{};
  std::map<std::string, Kept> outputs;
  std::vector<std::uint64_t> nested_revisions;
  std::vector<bool> nested_seams;
};

/// A solver that runs the script of its test.
struct Scripted : Solver {
  Result<Shape> solve(const SolverInput& in) override { return script(in); }
  bool joins_seams() const override { return joins; }

  std::function<Result<Shape>(const SolverInput&)> script;
  bool joins = true;
};

/// The template's vertices at rest, 1 m in front of the camera.
inline Shape at_rest(const Template& templ) {
  Shape shape;
  shape.vertices_m = owned(templ.vertices_m);
  for (std::int64_t v = 0; v < templ.vertices_m.rows(); ++v) shape.vertices_m(v, 2) += 1.0;
  shape.source = Array<std::uint8_t>({templ.vertices_m.rows()}, 1);
  return shape;
}

class SolverFixture : public ::testing::Test {
 protected:
  /// Calls the solver with `script`, through the contract.
  std::int32_t run(const Template& templ, std::function<Result<Shape>(const SolverInput&)> script) {
    solver_.script = std::move(script);
    input_.templ = templ;
    const RecordView<Template> template_view("template", templ);
    const RecordView<Camera> camera_view("camera", camera_);
    std::vector<weft_record> records{template_view.raw(), camera_view.raw()};
    std::optional<RecordView<Sightlines>> sightlines;
    std::optional<RecordView<Visibility>> visibility;
    std::optional<RecordView<KnownPoints>> known_points;
    std::optional<RecordView<Shape>> previous;
    const auto add = [&](auto& view, const char* slot, const auto& typed) {
      if (typed) records.push_back(view.emplace(slot, *typed).raw());
    };
    add(sightlines, "sightlines", input_.sightlines);
    add(visibility, "visibility", input_.visibility);
    add(known_points, "known_points", input_.known_points);
    add(previous, "previous.shape", input_.previous_shape);
    ProcessCall process(host_.call, records.data(), records.size(), &error_);
    return solver_.process(process);
  }

  OutputHost host_;
  Scripted solver_;
  Camera camera_{500.0, 500.0, 320.0, 240.0, 640, 480};
  SolverInput input_{Call(host_.call)};
  weft_error error_{};
};

}  // namespace weft::welding_test
