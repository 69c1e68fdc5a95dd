// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>
#include <utility>
#include <weft/data/matrix.hpp>
#include <weft/sdk/template_builder.hpp>

#include "closed_surface.hpp"
#include "tetrahedra.hpp"

namespace weft::volume {
namespace {

/// A solid object: the closed surface of another template, filled with tetrahedra.
class VolumeTemplate final : public TemplateBuilder {
 public:
  static constexpr About kAbout{
      .reference =
          "own: Labelle and Shewchuk, Isosurface stuffing (2007); Jacobson et al., Robust "
          "inside-outside segmentation (2013); Barill et al., Fast winding numbers (2018)"};

  explicit VolumeTemplate(Params& p) {
    p.component("surface", surface_, "template of the object's closed surface");
    p.read("pitch_m", pitch_m_, "m", {0.0, 100.0},
           "side of the lattice's cubes; 0: a twelfth of the object's diagonal");
  }

  Result<Template> build(const Call& call) override {
    auto templ = surface_.build(call);
    if (!templ) return templ;
    if (templ->is_solid()) {
      return about("surface", {Errc::invalid_value,
                               "the surface is a solid already: use it as the template without "
                               "templates/volume"});
    }
    const auto surface = closed_surface_of(*templ);
    if (!surface) return surface.error();
    const double pitch_m = pitch_m_ > 0.0 ? pitch_m_ : default_pitch(surface->vertices_m);
    const auto solid = fill_with_tetrahedra(*surface, pitch_m);
    if (!solid) return solid.error();
    store(*solid, *templ);
    std::string note = templ.degenerate_reason();
    if (solid->parts > surface->parts) {
      note += (note.empty() ? "" : "; ") + std::string("the tetrahedra form ") +
              std::to_string(solid->parts) + " pieces that share no face, the surface " +
              std::to_string(surface->parts) + ": give a smaller 'pitch_m'";
    }
    if (note.empty()) return *std::move(templ);
    return degenerate(*std::move(templ), std::move(note));
  }

 private:
  static double default_pitch(const Points3& vertices_m) {
    constexpr double kPitches = 12.0;
    return (vertices_m.colwise().maxCoeff() - vertices_m.colwise().minCoeff()).norm() / kPitches;
  }

  static void store(const Solid& solid, Template& templ) {
    const auto vertices = static_cast<std::int64_t>(solid.vertex_tetrahedron.size());
    const auto tetrahedra = static_cast<std::int64_t>(solid.filled_share.size());
    templ.nodes_m = make_array<double>(solid.nodes_m);
    templ.tetrahedra = make_array<std::int32_t>(solid.tetrahedra);
    templ.vertex_barycentric = make_array<double>(solid.vertex_barycentric);
    templ.vertex_tetrahedron = Array<std::int32_t>({vertices});
    std::copy(solid.vertex_tetrahedron.begin(), solid.vertex_tetrahedron.end(),
              templ.vertex_tetrahedron.data());
    Array<double> filled_share({tetrahedra});
    std::copy(solid.filled_share.begin(), solid.filled_share.end(), filled_share.data());
    templ.others.set("x.weft.filled_share", std::move(filled_share));
  }

  TemplateComponent surface_{"templates/mesh"};
  double pitch_m_ = 0.0;
};

}  // namespace
}  // namespace weft::volume

using weft::volume::VolumeTemplate;
WEFT_PLUGIN(VolumeTemplate, "templates/volume", "1.0.0",
            "Fills the closed surface of another template with a lattice of tetrahedra.")
