// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>
#include <utility>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/sdk/pass.hpp>

#include "common/coarse_mesh/coarse_mesh.hpp"
#include "evidence.hpp"
#include "hysteresis.hpp"
#include "sight.hpp"
#include "warp_folds.hpp"

namespace weft::self_occlusion {
namespace {

/// Which vertices the camera sees: by rays on the shape of this frame or, before there is one, on
/// the previous shape or by the folds of the warp.
class SelfOcclusion final : public Pass {
 public:
  static constexpr About kAbout{
      .reference =
          "own: Wald et al., Embree, ACM Transactions on Graphics 33 (2014); Pizarro, Bartoli, "
          "IJCV 97 (2012) for warps",
      .reads = "shape previous.shape previous.visibility correspondences warp_samples",
      .produces = "visibility"};

  explicit SelfOcclusion(Params& p) {
    p.read("memory", rules_.memory, "", {0.0, 0.99}, "weight of the previous score");
    p.read("hide_below", rules_.hide_below, "", {0.0, 0.5},
           "score below which a visible vertex becomes hidden");
    p.read("show_above", rules_.show_above, "", {0.5, 1.0},
           "score above which a hidden vertex becomes visible");
    p.read(
        "missing_matches", missing_matches_, "", {0.0, 1e6},
        "number of expected matches at which a part without kept matches is unconfirmed; 0: never");
    p.read("match_tolerance_px", match_tolerance_px_, "px", {0.0, 1e6},
           "distance within which two kept matches at a vertex agree and make it visible, "
           "regardless of the shape");
    p.read("longest_age", longest_age_, "frames", {0, 1000000},
           "age from which a previous shape is ignored");
    p.read(
        "vertices", vertices_, "", {0, 1000000},
        "approximate number of vertices of the coarser mesh that replaces a finer one; 0: never");
  }

  Result<PassOutput> run(const PassInput& in) override {
    if (auto ready = prepare_mesh(in.templ); !ready) return ready.error();
    if (auto checked = check(in); !checked) return checked.error();
    if (!coarse_) return seen_on(in);
    auto out = seen_on(on_coarse_mesh(in));
    if (out) out->visibility = on_fine_mesh(*out->visibility);
    return out;
  }

 private:
  /// The visibility of the given mesh.
  Result<PassOutput> seen_on(const PassInput& in) {
    const Shape* shape = shape_to_look_at(in);
    if (!shape && !in.warp_samples) {
      return no_result("there is neither a shape nor a warp to look at");
    }
    Sight sight;
    std::optional<MatchFindings> by_matches;
    if (shape) {
      const Points3View vertices_m = shape->vertices_m.matrix<3>();
      const FacesView faces = in.templ.faces.matrix<3>();
      sight = look(vertices_m, faces, around_, in.camera, *scene_);
      const Scene scene{vertices_m, faces, around_, sight.cosines};
      if (in.correspondences) by_matches = what_matches_tell(in, scene, sight);
    } else {
      sight = look_at_warp(in.templ, *in.warp_samples, around_, in.camera);
    }
    PassOutput out;
    out.visibility = settle(sight, by_matches, in.previous_visibility, rules_);
    out.visibility->diag.set("looked_at", in.shape ? 0.0 : shape ? 1.0 : 2.0);
    return out;
  }

  /// Checked inputs on the coarse mesh.
  PassInput on_coarse_mesh(const PassInput& in) const {
    PassInput asked = in;
    asked.templ = coarse_->of(in.templ);
    if (in.shape) asked.shape = *coarse_->of(*in.shape);
    if (in.previous_shape) asked.previous_shape = *coarse_->of(*in.previous_shape);
    if (in.previous_visibility) asked.previous_visibility = *coarse_->of(*in.previous_visibility);
    if (in.warp_samples) asked.warp_samples = *coarse_->of(*in.warp_samples);
    if (in.correspondences) asked.correspondences = coarse_->of(*in.correspondences);
    return asked;
  }

  /// A fine vertex is seen as the coarse one next to it is.
  Visibility on_fine_mesh(const Visibility& coarse) const {
    const auto count = static_cast<std::int64_t>(coarse_->fine_count());
    Visibility fine{Array<std::uint8_t>({count}), Array<double>({count}),
                    Array<std::uint8_t>({count}), coarse.diag};
    for (std::int64_t v = 0; v < count; ++v) {
      worked_in_loop(v);
      const std::int32_t next = coarse_->nearest(v);
      fine.visible(v) = coarse.visible(next);
      fine.score(v) = coarse.score(next);
      fine.reason(v) = coarse.reason(next);
    }
    fine.diag.set("coarse_vertices", static_cast<double>(coarse_->count()));
    return fine;
  }

  Result<void> prepare_mesh(const Template& templ) {
    if (!scene_) {
      auto scene = scene::RayCaster::create();
      if (!scene) return scene.error();
      scene_ = *std::move(scene);
    }
    if (mesh_revision_ != 0 && templ.revision == mesh_revision_) return {};
    mesh_revision_ = 0;
    const FacesView faces = templ.faces.matrix<3>();
    if (auto checked = check_face_indices(faces, templ.vertices_m.rows()); !checked) return checked;
    around_ = vertex_faces(faces, templ.vertices_m.rows());
    coarse_.reset();
    if (vertices_ > 0 && templ.vertices_m.rows() > vertices_) {
      if (auto built = coarse_.emplace().build(templ, vertices_); !built) return built;
      around_ = vertex_faces(coarse_->faces(), coarse_->count());
    }
    mesh_revision_ = templ.revision;
    return {};
  }

  static Result<void> check(const PassInput& in) {
    const std::int64_t vertices = in.templ.vertices_m.rows();
    const auto of_template = [&](std::int64_t count, const char* what) -> Result<void> {
      if (count == vertices) return {};
      return Error{Errc::invalid_data, std::string(what) + " has " + std::to_string(count) +
                                           " vertices, the template " + std::to_string(vertices) +
                                           ": use one template throughout"};
    };
    Result<void> status;
    if (in.shape) status = of_template(in.shape->vertices_m.rows(), "the shape");
    if (status && in.previous_shape) {
      status = of_template(in.previous_shape->vertices_m.rows(), "the previous shape");
    }
    if (status && in.previous_visibility) {
      status = of_template(in.previous_visibility->visible.rows(), "the previous visibility");
    }
    if (status && in.warp_samples) {
      status = of_template(in.warp_samples->xy_px.rows(), "the warp");
    }
    if (!status || !in.correspondences) return status;
    for (std::int64_t i = 0; i < in.correspondences->count(); ++i) {
      if (in.correspondences->face(i) < in.templ.faces.rows()) continue;
      return Error{Errc::invalid_data,
                   "match " + std::to_string(i) + " lies in face " +
                       std::to_string(in.correspondences->face(i)) + " of a template with " +
                       std::to_string(in.templ.faces.rows()) + ": use one template throughout"};
    }
    return {};
  }

  MatchFindings what_matches_tell(const PassInput& in, const Scene& scene,
                                  const Sight& sight) const {
    MatchFindings by_matches{
        gather_evidence(scene, in.camera, *in.correspondences, match_tolerance_px_), {}};
    by_matches.unconfirmed.assign(sight.reason.size(), 0);
    if (missing_matches_ > 0.0) {
      by_matches.unconfirmed =
          unconfirmed_vertices(scene, sight, by_matches.evidence, missing_matches_);
    }
    return by_matches;
  }

  /// The shape of this frame, else the previous one while it is fresh; only one that lies before
  /// the camera.
  const Shape* shape_to_look_at(const PassInput& in) const {
    const auto usable = [](const Shape& shape) {
      const auto vertices_m = shape.vertices_m.matrix<3>();
      return vertices_m.allFinite() && vertices_m.col(2).minCoeff() > 0.0;
    };
    if (in.shape && usable(*in.shape)) return &*in.shape;
    if (in.shape || !in.previous_shape) return nullptr;
    const bool fresh = in.previous_shape->shape_state() != ShapeState::lost &&
                       in.previous_shape->age_frames < longest_age_;
    if (!fresh || !usable(*in.previous_shape)) return nullptr;
    return &*in.previous_shape;
  }

  Rules rules_;
  double missing_matches_ = 15.0;
  double match_tolerance_px_ = 3.0;
  std::int64_t longest_age_ = 5;
  int vertices_ = 0;

  std::optional<scene::RayCaster> scene_;
  std::optional<coarse_mesh::CoarseMesh> coarse_;  ///< used instead of the template's mesh
  IndexLists around_;                              ///< faces around each vertex of the mesh in use
  std::uint64_t mesh_revision_ = 0;
};

}  // namespace
}  // namespace weft::self_occlusion

using weft::self_occlusion::SelfOcclusion;
WEFT_PLUGIN(SelfOcclusion, "passes/self_occlusion", "1.1.0",
            "Determines the visible vertices by rays on the shape and by the matches.")
