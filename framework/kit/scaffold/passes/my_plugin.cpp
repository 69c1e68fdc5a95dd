// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/sdk/pass.hpp>

namespace {

/// Share of the mesh's area at rest that these faces have.
double area_share(const weft::Template& templ, const std::vector<bool>& chosen) {
  const auto vertices_m = templ.vertices_m.matrix<3>();
  const auto faces = templ.faces.matrix<3>();
  double part = 0.0, whole = 0.0;
  for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
    const double area = weft::face_area(vertices_m, faces, f);
    whole += area;
    if (chosen[weft::to_index(f)]) part += area;
  }
  return whole > 0.0 ? part / whole : 0.0;
}

/// Puts the place of each kept match on the ray of its pixel.
class MyPluginPass final : public weft::Pass {
 public:
  static constexpr weft::About kAbout{.needs = "correspondences", .produces = "sightlines"};

  explicit MyPluginPass(weft::Params& p) {
    p.read("fewest", fewest_, "", {3, 1000000}, "minimum number of sightlines for a result");
  }

  weft::Result<weft::PassOutput> run(const weft::PassInput& in) override {
    if (!in.correspondences) {
      return weft::Error{weft::Errc::invalid_data, "needs 'correspondences'"};
    }
    const weft::Correspondences& matches = *in.correspondences;
    const std::int64_t face_count = in.templ.faces.rows();
    std::vector<std::int64_t> used;
    std::vector<bool> hit(weft::to_index(face_count), false);
    for (std::int64_t i = 0; i < matches.count(); ++i) {
      const std::int32_t face = matches.face(i);  // -1 where the match is beyond the mesh
      if (matches.kept(i) == 0 || face < 0 || face >= face_count) continue;
      used.push_back(i);
      hit[weft::to_index(face)] = true;
    }
    const std::int64_t count = std::ssize(used);
    if (count < fewest_) {
      return weft::no_result(std::to_string(count) + " matches are kept on the mesh, of at least " +
                             std::to_string(fewest_));
    }
    weft::Sightlines lines;
    lines.vertex = weft::Array<std::int32_t>({count}, -1);  // none: the points lie inside faces
    lines.face = weft::Array<std::int32_t>({count});
    lines.barycentrics = weft::Array<double>({count, 3});
    lines.pixel_px = weft::Array<double>({count, 2});
    lines.ray = weft::Array<double>({count, 3});
    lines.weight = weft::Array<double>({count}, 1.0);
    lines.coverage = area_share(in.templ, hit);
    const weft::Pinhole camera{in.camera.fx, in.camera.fy, in.camera.cx, in.camera.cy};
    for (std::int64_t k = 0; k < count; ++k) {
      weft::worked_in_loop(k, 5);
      const std::int64_t i = used[weft::to_index(k)];
      const Eigen::Vector2d pixel(matches.image_px(i, 0), matches.image_px(i, 1));
      lines.face(k) = matches.face(i);
      lines.barycentrics.matrix<3>().row(k) = matches.barycentrics.matrix<3>().row(i);
      lines.pixel_px.matrix<2>().row(k) = pixel.transpose();
      lines.ray.matrix<3>().row(k) = weft::unit_ray(camera, pixel).transpose();
    }
    weft::PassOutput out;
    out.sightlines = std::move(lines);
    return out;
  }

 private:
  int fewest_ = 8;
};

}  // namespace

WEFT_PLUGIN(MyPluginPass, "passes/my_plugin", "1.0.0", "Gives the sightline of each kept match.")
