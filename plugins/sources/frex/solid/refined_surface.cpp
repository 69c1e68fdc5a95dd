// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string>
#include <unordered_map>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "solid/solid_rest.hpp"

namespace weft::frex {
namespace {

constexpr std::size_t kMostFaces = 1000000;

using Face = std::array<std::int32_t, 3>;

/// A surface that grows.
class Refinement {
 public:
  Refinement(const Points3& places_m, const Points2& uv_px) {
    for (Eigen::Index v = 0; v < places_m.rows(); ++v) {
      places_m_.emplace_back(places_m.row(v));
      uv_px_.emplace_back(uv_px.row(v));
    }
  }

  std::vector<Face> faces;

  std::int32_t add(const Eigen::RowVector3d& place_m, const Eigen::RowVector2d& uv_px) {
    places_m_.push_back(place_m);
    uv_px_.push_back(uv_px);
    return static_cast<std::int32_t>(places_m_.size() - 1);
  }

  std::int32_t centre_of(const Face& face) {
    const auto [a, b, c] = face;
    return add((place(a) + place(b) + place(c)) / 3.0, (uv(a) + uv(b) + uv(c)) / 3.0);
  }

  /// Halves all edges that are too long. Returns whether there was one.
  bool halve(double edge_m) {
    middles_.clear();
    std::vector<Face> halved;
    halved.reserve(faces.size());
    for (const Face& face : faces) {
      worked_in_loop(static_cast<std::int64_t>(halved.size()), 10);
      divide(face, edge_m, halved);
    }
    faces.swap(halved);
    return !middles_.empty();
  }

  RefinedSurface surface() const {
    RefinedSurface surface;
    const auto count = static_cast<Eigen::Index>(places_m_.size());
    surface.places_m.resize(count, 3);
    surface.uv_px.resize(count, 2);
    for (Eigen::Index v = 0; v < count; ++v) {
      surface.places_m.row(v) = places_m_[to_index(v)];
      surface.uv_px.row(v) = uv_px_[to_index(v)];
    }
    surface.faces = array_of(faces);
    return surface;
  }

  static Faces array_of(const std::vector<Face>& faces) {
    Faces array(static_cast<Eigen::Index>(faces.size()), 3);
    for (std::size_t f = 0; f < faces.size(); ++f) {
      array.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
    }
    return array;
  }

 private:
  const Eigen::RowVector3d& place(std::int32_t v) const { return places_m_[to_index(v)]; }
  const Eigen::RowVector2d& uv(std::int32_t v) const { return uv_px_[to_index(v)]; }

  /// The vertex in the middle of an edge, -1 if it is short enough. The sum does not depend on the
  /// order of its ends, so that both sides of a seam get the same place.
  std::int32_t middle_of(std::int32_t a, std::int32_t b, double edge_m) {
    if ((place(a) - place(b)).norm() <= edge_m) return -1;
    const auto [low, high] = std::minmax(a, b);
    const auto key = static_cast<std::uint64_t>(low) << 32U | static_cast<std::uint64_t>(high);
    const auto [found, is_new] = middles_.try_emplace(key, 0);
    if (is_new) found->second = add(0.5 * (place(a) + place(b)), 0.5 * (uv(a) + uv(b)));
    return found->second;
  }

  void divide(const Face& face, double edge_m, std::vector<Face>& into) {
    std::array<std::int32_t, 3> middles{};  // on the edge behind each corner
    int divided = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      middles[k] = middle_of(face[k], face[(k + 1) % 3], edge_m);
      if (middles[k] >= 0) ++divided;
    }
    if (divided == 0) {
      into.push_back(face);
    } else if (divided == 3) {
      for (std::size_t k = 0; k < 3; ++k) {
        into.push_back({face[k], middles[k], middles[(k + 2) % 3]});
      }
      into.push_back(middles);
    } else {
      divide_partly(face, middles, divided, into);
    }
  }

  /// One or two edges have a middle. The face is turned such that the edge behind its first corner
  /// has one, and the edge before it has none.
  void divide_partly(const Face& face, const std::array<std::int32_t, 3>& middles, int divided,
                     std::vector<Face>& into) const {
    std::size_t first = 0;
    while (middles[first] < 0 || middles[(first + 2) % 3] >= 0) ++first;
    const std::int32_t a = face[first], b = face[(first + 1) % 3], c = face[(first + 2) % 3];
    const std::int32_t ab = middles[first], bc = middles[(first + 1) % 3];
    if (divided == 1) {
      into.insert(into.end(), {{a, ab, c}, {ab, b, c}});
      return;
    }
    into.push_back({ab, b, bc});
    if ((place(a) - place(bc)).squaredNorm() < (place(ab) - place(c)).squaredNorm()) {
      into.insert(into.end(), {{a, ab, bc}, {a, bc, c}});
    } else {
      into.insert(into.end(), {{a, ab, c}, {ab, bc, c}});
    }
  }

  std::vector<Eigen::RowVector3d> places_m_;
  std::vector<Eigen::RowVector2d> uv_px_;
  std::unordered_map<std::uint64_t, std::int32_t> middles_;
};

}  // namespace

Result<RefinedSurface> refined(const Points3& places_m, const Points2& uv_px, const Faces& faces,
                               double edge_m) {
  Refinement refinement(places_m, uv_px);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Face face{faces(f, 0), faces(f, 1), faces(f, 2)};
    const std::int32_t centre = refinement.centre_of(face);
    for (std::size_t k = 0; k < 3; ++k) {
      refinement.faces.push_back({face[k], face[(k + 1) % 3], centre});
    }
  }
  const Faces truth_faces = Refinement::array_of(refinement.faces);
  while (refinement.halve(edge_m)) {
    if (refinement.faces.size() <= kMostFaces) continue;
    return Error{Errc::invalid_value, "'edge_m' of " + std::to_string(edge_m) +
                                          " needs more than " + std::to_string(kMostFaces) +
                                          " triangles: give a larger one"};
  }
  RefinedSurface surface = refinement.surface();
  surface.truth_points = places_m.rows() + faces.rows();
  surface.truth_faces = truth_faces;
  return surface;
}

}  // namespace weft::frex
