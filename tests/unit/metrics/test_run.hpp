// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <weft/data/ground_truth.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/template.hpp>
#include <weft/data/visibility.hpp>
#include <weft/testing/synthetic.hpp>

#include "host/records/npz.hpp"
#include "lab/metrics/metrics.hpp"
#include "lab/metrics/runs/run_registrations.hpp"

namespace weft::lab {

/// A run folder in a temporary place, written frame by frame with known errors. The surface has 4 x
/// 3 vertices, 0.3 m x 0.2 m and texels of 5 mm x 4 mm. It is flat and tilted before the camera.
class TestRun {
 public:
  TestRun() : templ_(testing::make_template({4, 3, 0.3, 0.2, 60, 50})) {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = ::testing::TempDir() + "weft_" + test->test_suite_name() + "_" + test->name() + "_" +
              std::to_string(getpid()) + "_" +
              std::to_string(reinterpret_cast<std::uintptr_t>(this));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ + "/frames");
    write_template(templ_);
    write_text("frames.jsonl", "");
  }
  ~TestRun() { std::filesystem::remove_all(folder_); }
  TestRun(const TestRun&) = delete;
  TestRun& operator=(const TestRun&) = delete;

  const std::string& folder() const { return folder_; }
  const Template& sheet() const { return templ_; }

  void write_template(const Template& templ) const {
    write_npz("template.npz", {{"template", host::Record::copy_of(templ)},
                               {"camera", host::Record::copy_of(testing::make_camera())}});
  }

  /// Where the template's point xy [m] is in the camera frame: affine, so that interpolation over a
  /// face is exact and so is extrapolation.
  static Eigen::Vector3d place(const Eigen::Vector2d& xy_m) {
    return {xy_m.x() * 0.8 - 0.1, xy_m.y() - 0.1, 0.6 + 0.6 * xy_m.x()};
  }

  /// The true vertices [V,3] m.
  Points3 vertices() const {
    Points3 result(templ_.vertices_m.rows(), 3);
    for (Eigen::Index v = 0; v < result.rows(); ++v) {
      result.row(v) = place({templ_.vertices_m(v, 0), templ_.vertices_m(v, 1)});
    }
    return result;
  }

  /// The true vertices moved by `z_mm` along the camera's axis.
  Points3 shifted(double z_mm) const {
    Points3 result = vertices();
    result.col(2).array() += z_mm / 1000.0;
    return result;
  }

  /// Truth at the points xy [T,2] m.
  static GroundTruth truth_at(const Points2& xy_m, const std::string& kind,
                              const std::string& exclusion = "") {
    Points3 points_m(xy_m.rows(), 3);
    for (Eigen::Index i = 0; i < xy_m.rows(); ++i) points_m.row(i) = place(xy_m.row(i));
    return {make_array<double>(xy_m), make_array<double>(points_m), kind, exclusion};
  }

  /// Truth at five points, among them a vertex, an edge, and insides of faces.
  static GroundTruth truth(const std::string& kind, const std::string& exclusion = "") {
    Points2 xy_m(5, 2);
    xy_m << 0.0, 0.0, 0.05, 0.0, 0.1234, 0.0567, 0.2, 0.17, 0.28, 0.03;
    return truth_at(xy_m, kind, exclusion);
  }

  /// Writes the next frame; its stem is "f" and its index. Without vertices the state is none.
  void add(ShapeState state, const std::optional<Points3>& vertices_m,
           const std::optional<GroundTruth>& truth, bool failed = false,
           const std::optional<Visibility>& visibility = std::nullopt) {
    host::NamedRecords records;
    if (vertices_m) {
      Shape shape;
      shape.vertices_m = make_array<double>(*vertices_m);
      shape.state = static_cast<std::int32_t>(state);
      shape.confidence = confidence_;
      shape.source = Array<std::uint8_t>({vertices_m->rows()}, 0);
      records.emplace_back("shape", host::Record::copy_of(shape));
    }
    if (truth) records.emplace_back("ground_truth", host::Record::copy_of(*truth));
    if (visibility) records.emplace_back("visibility", host::Record::copy_of(*visibility));
    if (!records.empty()) write_npz(frame_name(count_), records);
    const std::string index = std::to_string(count_++);
    append_line("{\"frame\": " + index + ", \"stem\": \"f" + index + "\", \"state\": \"" +
                to_string(state) + "\", \"age\": 0, \"failed\": " + (failed ? "true" : "false") +
                ", \"stages\": [], \"ms\": {}}\n");
  }

  /// The confidence of the frames from now on.
  void say(double confidence) { confidence_ = confidence; }

  void solved(double z_mm, const std::optional<GroundTruth>& truth) {
    add(ShapeState::estimated, shifted(z_mm), truth);
  }

  /// Writes what `weft eval --flat-reference` stores in the folder.
  void measure(const std::map<std::uint64_t, Registration>& frames) const {
    MeasuredFrames records;
    for (const auto& [frame, made] : frames) records[frame] = host::Record::copy_of(made);
    if (auto written = write_registrations(folder_, records); !written) {
      throw std::runtime_error(written.error().message);
    }
  }

  static std::string frame_name(int frame) {
    char name[32];
    std::snprintf(name, sizeof(name), "frames/%06d.npz", frame);
    return name;
  }

  void append_line(const std::string& text) const {
    std::ofstream(folder_ + "/frames.jsonl", std::ios::app | std::ios::binary) << text;
  }
  void write_text(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ + "/" + name, std::ios::binary) << text;
  }
  std::string read_text(const std::string& name) const {
    std::ifstream stream(folder_ + "/" + name, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void write_npz(const std::string& name, const host::NamedRecords& records) const {
    if (auto written = host::write_npz(folder_ + "/" + name, records); !written) {
      throw std::runtime_error(written.error().message);
    }
  }

 private:
  std::string folder_;
  Template templ_;
  int count_ = 0;
  double confidence_ = 1.0;
};

inline RunMetrics evaluated(const TestRun& run, Alignment alignment = Alignment::none) {
  const auto metrics = evaluate_run(run.folder(), {alignment});
  if (!metrics) throw std::runtime_error(metrics.error().where + ": " + metrics.error().message);
  return *metrics;
}

}  // namespace weft::lab
