// SPDX-License-Identifier: Apache-2.0
#include "pipeline/execution/compose.hpp"

#include <algorithm>
#include <weft/data/matrix.hpp>
#include <weft/geometry/face_locator.hpp>

namespace weft {

using host::arrays_of;
using host::MemoryPool;
using host::Record;
using host::RecordPtr;

namespace {

/// A copy of a record that shares all arrays but those named; "diag." names all evidence.
std::shared_ptr<Record> share_except(const Record& record,
                                     std::initializer_list<std::string_view> names,
                                     const std::shared_ptr<MemoryPool>& pool = nullptr) {
  auto copy = Record::make(record.type(), pool);
  const weft_record view = record.view("");
  for (std::uint64_t i = 0; i < view.count; ++i) {
    const std::string_view name = view.arrays[i].name;
    const auto is_named = [&](std::string_view left_out) {
      return left_out.ends_with('.') ? name.starts_with(left_out) : name == left_out;
    };
    if (std::none_of(names.begin(), names.end(), is_named)) copy->share(record, name);
  }
  copy->set_producer(view.producer);
  return copy;
}

}  // namespace

Result<RecordPtr> with_mask(const Record& correspondences, const Record& mask,
                            const std::shared_ptr<MemoryPool>& pool) {
  const auto matches = arrays_of<Correspondences>(correspondences);
  const auto verdict = arrays_of<InlierMask>(mask);
  if (!matches) return matches.error();
  if (!verdict) return verdict.error();
  const std::int64_t count = matches->count();
  if (verdict->kept.rows() != count) {
    return Error{Errc::invalid_data, "the mask has " + std::to_string(verdict->kept.rows()) +
                                         " entries for " + std::to_string(count) + " matches"};
  }
  auto composed = share_except(correspondences, {"kept", "score", "diag."}, pool);
  auto* kept = static_cast<std::uint8_t*>(composed->allocate("kept", WEFT_U8, 1, &count));
  auto* score = static_cast<double*>(composed->allocate("score", WEFT_F64, 1, &count));
  for (std::int64_t i = 0; i < count; ++i) {
    kept[i] = matches->kept(i) != 0 && verdict->kept(i) != 0 ? 1 : 0;
    score[i] = verdict->score(i);
  }
  if (verdict->confidence.present()) {
    auto* confidence = static_cast<double*>(composed->allocate("confidence", WEFT_F64, 0, nullptr));
    *confidence = *verdict->confidence.data();
    if (matches->confidence.present()) {
      *confidence = std::min(*confidence, *matches->confidence.data());
    }
  }
  return RecordPtr(std::move(composed));
}

Result<RecordPtr> locate_on_template(const Record& keypoints, const Record& templ) {
  const auto points = arrays_of<Keypoints>(keypoints);
  const auto sheet = arrays_of<Template>(templ);
  if (!points) return points.error();
  if (!sheet) return sheet.error();
  const auto locator = FaceLocator::create(sheet->flat_px.matrix<2>(), sheet->faces.matrix<3>());
  if (!locator) return locator.error();
  auto located = share_except(keypoints, {"face", "barycentrics"});
  const std::int64_t count = points->count();
  const std::int64_t shape[] = {count, 3};
  auto* face = static_cast<std::int32_t*>(located->allocate("face", WEFT_I32, 1, shape));
  auto* weights = static_cast<double*>(located->allocate("barycentrics", WEFT_F64, 2, shape));
  for (std::int64_t i = 0; i < count; ++i) {
    const FaceLocation location = locator->locate({points->xy_px(i, 0), points->xy_px(i, 1)});
    face[i] = location.face;
    for (int k = 0; k < 3; ++k) weights[3 * i + k] = location.weights[k];
  }
  return RecordPtr(std::move(located));
}

Result<const FaceLocator*> MatchPlacer::locator() {
  if (!locator_) {
    const auto sheet = arrays_of<Template>(*template_);
    if (!sheet) return sheet.error();
    auto made = FaceLocator::create(sheet->flat_px.matrix<2>(), sheet->faces.matrix<3>());
    if (!made) return made.error();
    locator_ = *std::move(made);
  }
  return &*locator_;
}

Result<Eigen::Array2d> MatchPlacer::m_per_px() const {
  const auto sheet = arrays_of<Template>(*template_);
  if (!sheet) return sheet.error();
  if (!sheet->m_per_px.present()) {
    return Error{Errc::invalid_data,
                 "matches are in metres on a template that has no m_per_px: give template_px"};
  }
  return Eigen::Array2d(sheet->m_per_px.matrix<1>());
}

Result<RecordPtr> MatchPlacer::place(RecordPtr record) {
  if (record->type() != Correspondences::kType) return record;
  const auto matches = arrays_of<Correspondences>(*record);
  if (!matches) return matches.error();
  const std::int64_t count = matches->count();
  bool complete = !matches->template_xy_m.present();
  for (std::int64_t n = 0; n < count; ++n) complete = complete && matches->face(n) != -1;
  if (complete) return record;
  const bool is_metric = matches->template_xy_m.present();
  const auto scale = is_metric ? m_per_px() : Eigen::Array2d(1.0, 1.0);
  if (!scale) return scale.error();
  const auto mesh = locator();
  if (!mesh) return mesh.error();
  const auto places = (is_metric ? matches->template_xy_m : matches->template_px).matrix<2>();
  auto placed =
      share_except(*record, {"template_px", "template_xy_m", "face", "barycentrics"}, pool_);
  const std::int64_t shape[] = {count, 2}, weights_shape[] = {count, 3};
  auto* px = static_cast<double*>(placed->allocate("template_px", WEFT_F64, 2, shape));
  auto* face = static_cast<std::int32_t*>(placed->allocate("face", WEFT_I32, 1, shape));
  auto* weights =
      static_cast<double*>(placed->allocate("barycentrics", WEFT_F64, 2, weights_shape));
  for (std::int64_t n = 0; n < count; ++n) {
    const Eigen::Vector2d texel = places.row(n).transpose().array() / *scale;
    FaceLocation at{matches->face(n), matches->barycentrics.matrix<3>().row(n), true};
    if (at.face == -1) at = (*mesh)->locate(texel);
    std::copy_n(texel.data(), 2, px + 2 * n);
    std::copy_n(at.weights.data(), 3, weights + 3 * n);
    face[n] = at.face;
  }
  return RecordPtr(std::move(placed));
}

RecordPtr aged_shape(const Record& shape, std::int64_t age, int lost_after,
                     const std::shared_ptr<MemoryPool>& pool) {
  auto aged = share_except(shape, {"state", "age", "confidence", "covariance_m2"}, pool);
  auto* state = static_cast<std::int32_t*>(aged->allocate("state", WEFT_I32, 0, nullptr));
  auto* frames = static_cast<std::int64_t*>(aged->allocate("age", WEFT_I64, 0, nullptr));
  *state = static_cast<std::int32_t>(age > lost_after ? ShapeState::lost : ShapeState::predicted);
  *frames = age;
  *static_cast<double*>(aged->allocate("confidence", WEFT_F64, 0, nullptr)) = 0.0;
  return aged;
}

RecordPtr doubted_shape(const Record& shape, ShapeState state, double confidence,
                        std::string_view reason) {
  auto doubted = share_except(shape, {"state", "confidence"});
  *static_cast<std::int32_t*>(doubted->allocate("state", WEFT_I32, 0, nullptr)) =
      static_cast<std::int32_t>(state);
  *static_cast<double*>(doubted->allocate("confidence", WEFT_F64, 0, nullptr)) = confidence;
  const auto length = static_cast<std::int64_t>(reason.size());
  std::copy(reason.begin(), reason.end(),
            static_cast<char*>(doubted->allocate("x.weft.reason", WEFT_U8, 1, &length)));
  return doubted;
}

Result<TextureInput> texture_input(const Record& templ) {
  const auto sheet = arrays_of<Template>(templ);
  if (!sheet) return sheet.error();
  Image image;
  image.pixels = sheet->texture;
  image.stem = "template";
  Region region;
  region.mask = sheet->mask;
  return TextureInput{Record::copy_of(image), Record::copy_of(region)};
}

}  // namespace weft
