// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/template_faults.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/face_locator.hpp>

namespace weft {
namespace {

constexpr std::array kFlips{Flip::none, Flip::u, Flip::v, Flip::both, Flip::space};

/// A place of the texture where it was before the coordinates were turned.
Eigen::Vector2d turned_back(const Eigen::Vector2d& at_px, Flip flip, const Template& templ) {
  const auto width = static_cast<double>(templ.texture.dim(1));
  const auto height = static_cast<double>(templ.texture.dim(0));
  const bool in_u = flip == Flip::u || flip == Flip::both;
  const bool in_v = flip == Flip::v || flip == Flip::both;
  return {in_u ? width - 1.0 - at_px.x() : at_px.x(), in_v ? height - 1.0 - at_px.y() : at_px.y()};
}

void mirror_rows(const Array<std::uint8_t>& from, Array<std::uint8_t>& to) {
  const std::int64_t width = from.dim(1), channels = from.dim(2);
  for (std::int64_t y = 0; y < from.dim(0); ++y) {
    for (std::int64_t x = 0; x < width; ++x) {
      std::copy_n(from.row(y) + channels * x, channels, to.row(y) + channels * (width - 1 - x));
    }
  }
}

std::string tenths(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", value);
  return text.data();
}

/// The flip of the best fit, and those that a symmetric object does not distinguish from it.
std::string flips_like(const FlippedFit& best, const std::vector<FlippedFit>& fits) {
  constexpr double kAlike = 1.25;  // noise alone makes medians of a few hundred differ by less
  std::string flips;
  std::size_t count = 0;
  for (const FlippedFit& fit : fits) {
    if (fit.pose.median_px > kAlike * best.pose.median_px) continue;
    flips += (count++ == 0 ? "" : " or ") + std::string(to_string(fit.flip));
  }
  return flips + (count == 1 ? "; set that" : ", which fit alike; set one of them");
}

std::string unmatched_text(const ChartMatches& charts) {
  return std::to_string(std::lround(100.0 * charts.unmatched_share)) +
         " % of the object gets no match: " + std::to_string(charts.unmatched) + " of " +
         std::to_string(charts.judged) +
         " charts of the texture that the image should show are without matches; is their part of "
         "the texture that of the object, and does the pipeline judge each chart "
         "(filters/charts)?";
}

/// True if the texture coordinates fit the mirrored image too.
bool mirrors_mesh_too(const FirstLook& look) {
  constexpr double kClearly = 2.0, kNoise_px = 1.0;
  const auto median_of = [&](Flip flip) {
    for (const FlippedFit& fit : look.fits_mirrored) {
      if (fit.flip == flip) return fit.pose.median_px;
    }
    return std::numeric_limits<double>::infinity();
  };
  // Mirroring the image for this look has mirrored its coordinates as well.
  return median_of(Flip::u) > std::max(kNoise_px, kClearly * median_of(Flip::none));
}

}  // namespace

const char* to_string(Flip flip) {
  constexpr std::array kNames{"none", "u", "v", "both", "space"};
  return kNames[static_cast<std::size_t>(flip)];
}

namespace {

/// Kept matches as points of the object at rest and pixels of the image.
struct SeenPoints {
  Points3 points_m;
  Points2 pixels;
};

SeenPoints seen_points(const Template& templ, const FaceLocator& locator,
                       const Correspondences& matches, Flip flip) {
  const auto faces = templ.faces.matrix<3>();
  const Points3 vertices_m = templ.vertices_m.matrix<3>();
  std::vector<Eigen::RowVector3d> points_m;
  std::vector<Eigen::RowVector2d> pixels;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    if (matches.kept(i) == 0) continue;
    const Eigen::Vector2d at(matches.template_px(i, 0), matches.template_px(i, 1));
    const FaceLocation on = locator.locate(turned_back(at, flip, templ));
    if (on.face < 0) continue;
    points_m.emplace_back(interpolate(vertices_m, faces, on.face, on.weights).transpose());
    pixels.emplace_back(matches.image_px(i, 0), matches.image_px(i, 1));
  }
  SeenPoints seen{Points3(static_cast<Eigen::Index>(points_m.size()), 3),
                  Points2(static_cast<Eigen::Index>(points_m.size()), 2)};
  for (Eigen::Index i = 0; i < seen.points_m.rows(); ++i) {
    seen.points_m.row(i) = points_m[to_index(i)];
    seen.pixels.row(i) = pixels[to_index(i)];
  }
  if (flip == Flip::space) seen.points_m.col(0) *= -1.0;
  return seen;
}

}  // namespace

std::vector<FlippedFit> fit_flipped(const Template& templ, const Camera& camera,
                                    const Correspondences& matches) {
  std::vector<FlippedFit> fits;
  const auto locator = FaceLocator::create(templ.flat_px.matrix<2>(), templ.faces.matrix<3>());
  if (!locator) return fits;
  for (const Flip flip : kFlips) {
    const SeenPoints seen = seen_points(templ, *locator, matches, flip);
    const auto pose =
        rest_pose({camera.fx, camera.fy, camera.cx, camera.cy}, seen.points_m, seen.pixels);
    if (pose) fits.push_back({flip, seen.points_m.rows(), *pose});
  }
  return fits;
}

std::optional<RestPose> pose_at_rest(const Template& templ, const Camera& camera,
                                     const Correspondences& matches) {
  const auto locator = FaceLocator::create(templ.flat_px.matrix<2>(), templ.faces.matrix<3>());
  if (!locator) return std::nullopt;
  const SeenPoints seen = seen_points(templ, *locator, matches, Flip::none);
  const auto pose =
      rest_pose({camera.fx, camera.fy, camera.cx, camera.cy}, seen.points_m, seen.pixels);
  if (!pose) return std::nullopt;
  return *pose;
}

std::optional<TextureResiduals> residuals_at_rest(const Template& templ, const Camera& camera,
                                                  const Correspondences& matches) {
  constexpr double kWide = 3.0, kLeast_px = 3.0;  // multiples of the robust scale
  const auto locator = FaceLocator::create(templ.flat_px.matrix<2>(), templ.faces.matrix<3>());
  if (!locator) return std::nullopt;
  const SeenPoints seen = seen_points(templ, *locator, matches, Flip::none);
  const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  const auto pose = rest_pose(pinhole, seen.points_m, seen.pixels);
  if (!pose) return std::nullopt;
  const auto even =
      rest_pose(pinhole, seen.points_m, seen.pixels, std::max(kLeast_px, kWide * pose->median_px));
  if (!even) return std::nullopt;
  return texture_residuals(templ, camera, matches, even->camera_from_template);
}

Template mirrored(const Template& templ) {
  Template result = templ;
  const std::int64_t height = templ.texture.dim(0), width = templ.texture.dim(1);
  result.texture = templ.texture.ndim() == 3
                       ? Array<std::uint8_t>({height, width, templ.texture.dim(2)})
                       : Array<std::uint8_t>({height, width});
  result.mask = Array<std::uint8_t>({height, width});
  mirror_rows(templ.texture, result.texture);
  mirror_rows(templ.mask, result.mask);
  result.flat_px = Array<double>({templ.flat_px.rows(), 2});
  for (std::int64_t v = 0; v < templ.flat_px.rows(); ++v) {
    result.flat_px(v, 0) = static_cast<double>(width - 1) - templ.flat_px(v, 0);
    result.flat_px(v, 1) = templ.flat_px(v, 1);
  }
  result.faces = Array<std::int32_t>({templ.faces.rows(), 3});
  for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
    result.faces(f, 0) = templ.faces(f, 0);
    result.faces(f, 1) = templ.faces(f, 2);
    result.faces(f, 2) = templ.faces(f, 1);
  }
  return result;
}

std::vector<std::string> faults_of(const FirstLook& look) {
  constexpr std::int64_t kFewest = 30;
  constexpr double kClearly = 2.0, kNoise_px = 1.0, kAtRest = 0.02, kUnmatched = 0.2;
  std::vector<std::string> faults;
  const std::string kept = std::to_string(look.kept);
  if (look.kept_mirrored >= kFewest && look.kept_mirrored > 3 * look.kept) {
    faults.push_back("the image of the texture is mirrored: " + kept +
                     " of its matches are kept, and " + std::to_string(look.kept_mirrored) +
                     " once it is mirrored; mirror its file left to right" +
                     (mirrors_mesh_too(look) ? ", and set flip: u" : ""));
    return faults;
  }
  if (look.kept < kFewest) {
    faults.push_back("only " + kept +
                     " matches are kept, too few to judge by: is the texture that of the object, "
                     "and is the object in view, large and sharp enough?");
    return faults;
  }
  if (look.fits.empty() || look.fits.front().flip != Flip::none) {
    faults.push_back(
        "the matches lie beside the mesh in the texture: its texture coordinates are for another "
        "image");
    return faults;
  }
  const FlippedFit& given = look.fits.front();
  const auto best = std::min_element(
      look.fits.begin(), look.fits.end(),
      [](const FlippedFit& a, const FlippedFit& b) { return a.pose.median_px < b.pose.median_px; });
  const double given_px = given.pose.median_px, best_px = best->pose.median_px;
  if (given_px > kNoise_px && given_px > kClearly * best_px && 2 * best->matches >= given.matches) {
    faults.push_back("the mesh is mirrored against its image: at rest it is " + tenths(given_px) +
                     " px off its matches (median), and " + tenths(best_px) +
                     " px with flip: " + flips_like(*best, look.fits));
  } else if (given_px > kNoise_px && given_px > kAtRest * look.size_px) {
    faults.push_back("the object at rest is " + tenths(given_px) +
                     " px off its matches (median), " + tenths(100.0 * given_px / look.size_px) +
                     " % of its size: the texture coordinates disagree with the mesh, or the frame "
                     "does not show it at rest, or the camera is another");
  }
  if (faults.empty() && look.charts && look.charts->unmatched_share >= kUnmatched) {
    faults.push_back(unmatched_text(*look.charts));
  }
  return faults;
}

std::vector<std::string> doubts_of(const FirstLook& look) {
  if (!look.field || !look.field->is_coherent()) return {};
  const ResidualField& field = *look.field;
  return {"the texture coordinates are off by " + tenths(field.rms_px) +
          " px (rms), in a coherent way, where matches scatter by " + tenths(field.noise_px) +
          " px; most, by " + tenths(field.most_px) + " px, near (" + tenths(field.most_at_px.x()) +
          ", " + tenths(field.most_at_px.y()) +
          ") px of the texture: --refit FOLDER writes a template with corrected coordinates, if "
          "the frame shows the object at rest and the camera is right"};
}

}  // namespace weft
