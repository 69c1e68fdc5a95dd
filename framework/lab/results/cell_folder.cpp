// SPDX-License-Identifier: Apache-2.0
#include "lab/results/cell_folder.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <weft/data/matrix.hpp>
#include <weft/geometry/face_locator.hpp>

#include "host/records/npz.hpp"

namespace weft::lab {
namespace {

namespace fs = std::filesystem;

struct CellShapes {
  Template sheet;
  std::map<std::uint64_t, FrameShapes> frames;
};

/// The number at the end of `text`, as in "000012" or "worst_000012".
std::optional<std::uint64_t> frame_number(const std::string& text) {
  const std::size_t start = text.find_last_not_of("0123456789") + 1;
  std::uint64_t frame = 0;
  const auto [end, failure] =
      std::from_chars(text.data() + start, text.data() + text.size(), frame);
  return failure == std::errc() ? std::optional(frame) : std::nullopt;
}

template <class RecordType>
Result<void> take(const host::Record& record, std::optional<RecordType>& place) {
  auto typed = host::view_as<RecordType>(record);
  if (!typed) return typed.error();
  place = *std::move(typed);
  return {};
}

/// Slots are `template`, `NNNNNN.shape` and `NNNNNN.ground_truth`.
Result<CellShapes> sort_records(const host::NamedRecords& records) {
  CellShapes cell;
  std::optional<Template> sheet;
  for (const auto& [slot, record] : records) {
    const std::size_t dot = slot.find('.');
    const auto frame = frame_number(slot.substr(0, dot));
    const std::string type = dot == std::string::npos ? slot : slot.substr(dot + 1);
    Result<void> taken;
    if (type == "template") taken = take(*record, sheet);
    if (frame && type == "shape") taken = take(*record, cell.frames[*frame].shape);
    if (frame && type == "ground_truth") taken = take(*record, cell.frames[*frame].truth);
    if (!taken) return taken.error();
  }
  if (!sheet) return Error{Errc::invalid_data, "there is no template in it"};
  cell.sheet = *std::move(sheet);
  return cell;
}

void append(std::vector<float>& values, const Eigen::Vector3d& point) {
  for (const double value : point) values.push_back(static_cast<float>(value));
}

/// True points, thinned evenly to `most_points`, with their places on the estimate.
void add_truth(const Template& sheet, const FaceLocator& locator, const FrameShapes& stored,
               std::size_t most_points, ViewFrame& frame) {
  const GroundTruth& truth = *stored.truth;
  const std::int64_t most = static_cast<std::int64_t>(most_points);
  const std::int64_t step = std::max<std::int64_t>(1, (truth.count() + most - 1) / most);
  const bool flat = sheet.m_per_px.present() && sheet.m_per_px.matrix<1>().minCoeff() > 0.0;
  const bool placeable = flat && !frame.vertices.empty();
  for (std::int64_t i = 0; i < truth.count(); i += step) {
    append(frame.truth, truth.points_m.matrix<3>().row(i));
    FaceLocation place;
    if (placeable) {
      const Eigen::Vector2d xy_m(truth.template_xy_m(i, 0), truth.template_xy_m(i, 1));
      place = locator.locate(xy_m.cwiseQuotient(Eigen::Vector2d(sheet.m_per_px.matrix<1>())));
    }
    if (place.face < 0) {
      append(frame.placed, Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
      continue;
    }
    append(frame.placed, interpolate(stored.shape->vertices_m.matrix<3>(), sheet.faces.matrix<3>(),
                                     place.face, place.weights));
  }
}

ViewFrame view_frame(const Template& sheet, const FaceLocator& locator, std::uint64_t index,
                     const FrameShapes& stored, std::size_t most_points) {
  ViewFrame frame{index, "none", {}, {}, {}};
  if (stored.shape) {
    const auto vertices_m = stored.shape->vertices_m.matrix<3>();
    const bool finite = vertices_m.allFinite();
    frame.state = finite ? to_string(stored.shape->shape_state()) : "invalid";
    for (Eigen::Index v = 0; finite && v < vertices_m.rows(); ++v) {
      append(frame.vertices, vertices_m.row(v));
    }
  }
  if (stored.truth) add_truth(sheet, locator, stored, most_points, frame);
  return frame;
}

std::string media_type(const fs::path& file) {
  if (file.extension() == ".png") return "image/png";
  return file.extension() == ".jpg" ? "image/jpeg" : "";
}

}  // namespace

Result<CellView> view_of(const Template& sheet, const std::map<std::uint64_t, FrameShapes>& frames,
                         const ViewLimits& limits) {
  const auto faces = sheet.faces.matrix<3>();
  const auto locator = FaceLocator::create(sheet.flat_px.matrix<2>(), faces);
  if (!locator) return locator.error();
  CellView view;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) view.faces.push_back(static_cast<std::uint32_t>(faces(f, k)));
  }
  const std::size_t step =
      std::max<std::size_t>(1, (frames.size() + limits.frames - 1) / limits.frames);
  std::size_t position = 0;
  for (const auto& [index, stored] : frames) {
    if (position++ % step != 0) continue;
    if (stored.shape && stored.shape->vertices_m.rows() != sheet.vertices_m.rows()) {
      return Error{Errc::invalid_data, "a shape does not match the template's mesh"};
    }
    view.frames.push_back(view_frame(sheet, *locator, index, stored, limits.truth_points));
  }
  return view;
}

Result<CellView> read_cell_view(const std::string& folder, const ViewLimits& limits) {
  const std::string file = folder + "/shapes.npz";
  std::error_code code;
  if (!fs::exists(file, code)) return CellView{};
  const auto records = host::read_npz(file, host::NpzCheck::none);
  if (!records) return records.error();
  const auto cell = sort_records(*records);
  if (!cell) return Error{cell.error().code, cell.error().message, file};
  auto view = view_of(cell->sheet, cell->frames, limits);
  if (!view) return Error{view.error().code, view.error().message, file};
  return view;
}

std::vector<Thumbnail> read_thumbnails(const std::string& folder) {
  std::vector<Thumbnail> thumbnails;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    const std::string type = media_type(entry.path());
    const auto frame = frame_number(entry.path().stem().string());
    if (type.empty() || !frame) continue;
    std::ifstream stream(entry.path(), std::ios::binary);
    thumbnails.push_back({*frame, type, std::string(std::istreambuf_iterator<char>(stream), {})});
  }
  std::sort(thumbnails.begin(), thumbnails.end(),
            [](const Thumbnail& a, const Thumbnail& b) { return a.frame < b.frame; });
  return thumbnails;
}

}  // namespace weft::lab
