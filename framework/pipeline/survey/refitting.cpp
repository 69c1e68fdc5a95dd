// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/refitting.hpp"

#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>

namespace weft {
namespace {

/// Half of the residuals are smaller.
double median_size(const TextureResiduals& residuals) {
  std::vector<double> off_px;
  for (Eigen::Index i = 0; i < residuals.off_px.rows(); ++i) {
    off_px.push_back(residuals.off_px.row(i).norm());
  }
  return median(off_px);
}

/// Uses all frames that show the object at rest; `used` is their number.
std::optional<TextureResiduals> residuals_of(const std::vector<Correspondences>& frames,
                                             const Template& templ, const Camera& camera,
                                             std::int64_t& used) {
  constexpr double kAtRest = 0.02;  // relative to the size, see faults_of()
  const Points2 flat_px = templ.flat_px.matrix<2>();
  const double size_px = (flat_px.colwise().maxCoeff() - flat_px.colwise().minCoeff()).norm();
  std::optional<TextureResiduals> all;
  used = 0;
  for (const Correspondences& matches : frames) {
    auto own = residuals_at_rest(templ, camera, matches);
    if (!own || own->at_px.rows() == 0 || median_size(*own) > kAtRest * size_px) continue;
    all = all ? joined(*all, *own) : *std::move(own);
    ++used;
  }
  return all;
}

}  // namespace

Result<RefittedTemplate> refit(const FirstFrame& first) {
  const auto templ = host::view_as<Template>(*first.templ);
  if (!templ) return templ.error();
  const auto camera = host::view_as<Camera>(*first.camera);
  if (!camera) return camera.error();
  std::vector<host::RecordPtr> records = first.others;
  if (first.matches != nullptr) records.push_back(first.matches);
  std::vector<Correspondences> frames;
  for (const host::RecordPtr& record : records) {
    if (auto matches = host::view_as<Correspondences>(*record)) frames.push_back(*matches);
  }
  return refit(*templ, *camera, frames);
}

Result<RefittedTemplate> refit(const Template& templ, const Camera& camera,
                               const std::vector<Correspondences>& frames) {
  constexpr int kRounds = 4;
  RefittedTemplate result{templ, 0, {}, {}};
  for (int round = 0; round <= kRounds; ++round) {
    const auto residuals = residuals_of(frames, result.templ, camera, result.frames);
    const auto field = residuals ? fit_residual_field(result.templ, *residuals) : std::nullopt;
    if (!field) {
      return no_result(
          "no frame shows the object at rest with enough matches to correct its texture "
          "coordinates: give frames that do");
    }
    if (round == 0) result.before = *field;
    result.after = *field;
    if (round < kRounds) result.templ = corrected(result.templ, *field);
  }
  return result;
}

}  // namespace weft
