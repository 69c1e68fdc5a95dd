// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <vector>
#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace weft::testing {

constexpr int kOpen = 0, kCount = 1, kRead = 2;
constexpr int kColumns = 40, kRows = 28;

/// Parameters: small and quick, unless the test needs more; the texture is 842 x 595 px.
inline std::string params(const std::string& more) {
  return std::string("{texture: ") + WEFT_TEXTURES +
         "sheet_texture.png, columns: " + std::to_string(kColumns) +
         ", rows: " + std::to_string(kRows) +
         ", image_width_px: 320, image_height_px: 240, "
         "focal_px: 400" +
         (more.empty() ? "" : ", ") + more + "}";
}

/// A source, opened, with one frame's outputs at a time.
class OpenFilm {
 public:
  OpenFilm(const std::string& id, const std::string& parameters, std::uint64_t run_seed = 1)
      : plugin_(id, parameters, run_seed) {
    const PluginAnswer opened = plugin_.process(kOpen, {});
    if (opened.status != WEFT_OK) throw std::runtime_error(opened.message);
    camera = *opened.get<Camera>();
  }

  PluginAnswer read(std::uint64_t frame) {
    PluginAnswer outcome = plugin_.process(kRead, {}, frame);
    if (outcome.status != WEFT_OK) throw std::runtime_error(outcome.message);
    return outcome;
  }
  std::vector<std::uint8_t> pixels(std::uint64_t frame) {
    const Array<std::uint8_t> array = read(frame).get<Image>()->pixels;
    return {array.data(), array.data() + array.size()};
  }
  GroundTruth truth(std::uint64_t frame) { return *read(frame).get<GroundTruth>(); }
  Pinhole pinhole() const { return {camera.fx, camera.fy, camera.cx, camera.cy}; }

  Camera camera;

 private:
  PluginUnderTest plugin_;
};

/// The printed surface.
class SmallFilm : public OpenFilm {
 public:
  explicit SmallFilm(const std::string& more = "", std::uint64_t run_seed = 1)
      : OpenFilm("sources/frex", params(more), run_seed) {}
};

/// Largest |l / l0 - 1| over the edges of the true mesh, l0 measured on the template.
inline double worst_strain(const GroundTruth& truth) {
  Points3 flat = Points3::Zero(truth.count(), 3);
  flat.leftCols<2>() = truth.template_xy_m.matrix<2>();
  const auto topology = build_topology(truth.faces.matrix<3>(), truth.count());
  return strain_statistics(*distance_constraints(topology->edges, flat), truth.points_m.matrix<3>())
      .max;
}

}  // namespace weft::testing
