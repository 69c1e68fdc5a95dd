// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <weft/geometry/face_locator.hpp>
#include <weft/pipeline/compose.hpp>

namespace weft {

using host::Record;
using host::RecordPtr;
using host::view_as;

namespace {

/// A copy of a record that shares all arrays but those named.
std::shared_ptr<Record> share_except(const Record& record,
                                     std::initializer_list<std::string_view> names) {
  auto copy = std::make_shared<Record>(record.type());
  const weft_record view = record.view("");
  for (std::uint64_t i = 0; i < view.count; ++i) {
    const std::string_view name = view.arrays[i].name;
    if (std::find(names.begin(), names.end(), name) == names.end()) copy->share(record, name);
  }
  copy->set_producer(view.producer);
  return copy;
}

}  // namespace

Result<RecordPtr> with_mask(const Record& correspondences, const Record& mask) {
  const auto matches = view_as<Correspondences>(correspondences);
  const auto verdict = view_as<InlierMask>(mask);
  if (!matches) return matches.error();
  if (!verdict) return verdict.error();
  const std::int64_t count = matches->count();
  if (verdict->kept.rows() != count) {
    return Error{Errc::invalid_data,
                 "the mask has " + std::to_string(verdict->kept.rows()) + " entries for " +
                     std::to_string(count) + " matches",
                 {}};
  }
  auto composed = share_except(correspondences, {"kept", "score"});
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
  const auto points = view_as<Keypoints>(keypoints);
  const auto sheet = view_as<Template>(templ);
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

RecordPtr aged_shape(const Record& shape, std::int64_t age, int lost_after) {
  auto aged = share_except(shape, {"state", "age", "confidence", "covariance_m2"});
  auto* state = static_cast<std::int32_t*>(aged->allocate("state", WEFT_I32, 0, nullptr));
  auto* frames = static_cast<std::int64_t*>(aged->allocate("age", WEFT_I64, 0, nullptr));
  *state = static_cast<std::int32_t>(age > lost_after ? ShapeState::lost : ShapeState::predicted);
  *frames = age;
  *static_cast<double*>(aged->allocate("confidence", WEFT_F64, 0, nullptr)) = 0.0;
  return aged;
}

Result<TextureInput> texture_input(const Record& templ) {
  const auto sheet = view_as<Template>(templ);
  if (!sheet) return sheet.error();
  Image image;
  image.pixels = sheet->texture;
  image.stem = "template";
  Region region;
  region.mask = sheet->mask;
  return TextureInput{Record::copy_of(image), Record::copy_of(region)};
}

}  // namespace weft
