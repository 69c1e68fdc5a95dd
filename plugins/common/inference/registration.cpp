// SPDX-License-Identifier: Apache-2.0
#include "common/inference/registration.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

namespace weft::inference {
namespace {

// Smallest stretch as a share of that of a surface face on: the depth of a network is not exact.
constexpr double kLeastOfFrontal = 0.5;
// Fewer seen cells are those of a network that sees things.
constexpr double kLeastSeen = 0.01;
// Logarithms of errors and depths are cut here, so that no exponential overflows.
constexpr double kMostLogarithm = 20.0;

std::string tenths_of_percent(double share) {
  const long tenths = std::lround(1000.0 * share);
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " %";
}

bool is_same_camera(const Camera& a, const Camera& b) {
  return a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy && a.width_px == b.width_px &&
         a.height_px == b.height_px;
}

cv::Size size_of(const Array<std::uint8_t>& pixels) {
  return {static_cast<int>(pixels.dim(1)), static_cast<int>(pixels.dim(0))};
}

bool has_known_channels(const Array<std::uint8_t>& pixels) {
  return pixels.ndim() == 2 || (pixels.ndim() == 3 && (pixels.dim(2) == 1 || pixels.dim(2) == 3));
}

/// Positions of the seen cells in their list, -1 where a cell is not seen.
class CellIndex {
 public:
  CellIndex(const CellGrid& grid, const std::vector<SeenCell>& cells)
      : grid_(grid), index_(to_index(grid.columns * grid.rows), -1) {
    for (std::size_t n = 0; n < cells.size(); ++n) {
      index_[to_index(cells[n].row * grid.columns + cells[n].column)] = static_cast<int>(n);
    }
  }
  int at(int row, int column) const {
    const bool inside = row >= 0 && column >= 0 && row < grid_.rows && column < grid_.columns;
    return inside ? index_[to_index(row * grid_.columns + column)] : -1;
  }

 private:
  CellGrid grid_;
  std::vector<int> index_;
};

/// Squared template distance [m^2] over one cell along an axis of the image; nothing without a
/// neighbour.
std::optional<double> squared_step(const CellIndex& index, const std::vector<SeenCell>& cells,
                                   const SeenCell& cell, bool along_x,
                                   const Eigen::Array2d& size_m) {
  const int before = index.at(cell.row - (along_x ? 0 : 1), cell.column - (along_x ? 1 : 0));
  const int after = index.at(cell.row + (along_x ? 0 : 1), cell.column + (along_x ? 1 : 0));
  if (before < 0 && after < 0) return std::nullopt;
  const Eigen::Array2d from = before >= 0 ? cells[to_index(before)].uv : cell.uv;
  const Eigen::Array2d to = after >= 0 ? cells[to_index(after)].uv : cell.uv;
  const double steps = before >= 0 && after >= 0 ? 2.0 : 1.0;
  return ((to - from) * size_m / steps).matrix().squaredNorm();
}

}  // namespace

void set_stretch(const CellGrid& grid, const Eigen::Array2d& size_m, const Eigen::Array2d& cell_px,
                 double focal_px, std::vector<SeenCell>& cells) {
  const CellIndex index(grid, cells);
  std::vector<double> known;
  std::vector<std::size_t> unknown;
  for (std::size_t n = 0; n < cells.size(); ++n) {
    double sum = 0.0;
    int axes = 0;
    for (const int axis : {0, 1}) {
      const auto step2 = squared_step(index, cells, cells[n], axis == 0, size_m);
      if (!step2) continue;
      sum += *step2 / (cell_px(axis) * cell_px(axis));
      ++axes;
    }
    if (axes == 0) {
      unknown.push_back(n);
      continue;
    }
    cells[n].stretch_m_per_px = std::sqrt(sum / axes);
    known.push_back(cells[n].stretch_m_per_px);
  }
  const double usual = known.empty() ? 0.0 : median(known);
  for (const std::size_t n : unknown) cells[n].stretch_m_per_px = usual;
  for (SeenCell& cell : cells) {
    const double least = kLeastOfFrontal * cell.depth_m / focal_px;
    cell.stretch_m_per_px = std::max(cell.stretch_m_per_px, least);
  }
}

double sigma_px(const SeenCell& cell, double least_px, double most_px) {
  const double sigma = cell.error_m / cell.stretch_m_per_px;
  return sigma < most_px ? std::max(sigma, least_px) : most_px;  // also for NaN
}

Result<void> Registration::prepare(const NetworkChoice& choice, const Template& templ,
                                   const Camera& camera) {
  if (!network_ || path_ != choice.path) {
    auto opened = Network::open(choice.path, choice.runtime);
    if (!opened) return about("network", opened.error());
    network_.emplace(*std::move(opened));
    path_ = choice.path;
    map_.reset();
    checked_revision_ = 0;
  }
  if (templ.revision == 0 || templ.revision != checked_revision_) {
    checked_revision_ = 0;
    if (auto taken = take_template(templ); !taken) return taken;
    checked_revision_ = templ.revision;
  }
  if (map_ && is_same_camera(camera, camera_)) return {};
  map_.reset();
  auto map = map_of(camera);
  if (!map) return about("camera", map.error());
  map_ = *std::move(map);
  camera_ = camera;
  camera_.others = {};
  return {};
}

Result<void> Registration::take_template(const Template& templ) {
  const auto sheet = flat_sheet(templ);
  if (!sheet) return about("template", sheet.error());
  const int side_px = file().texture_px;
  if (!file().is_for_any_texture()) {
    if (auto same = check_same_template(file(), templ, *sheet); !same) {
      return about("network", same.error());
    }
    unit_m_ = file().templ.width_m;
  } else {
    const Array<std::uint8_t>& texture = templ.texture;
    if (!has_known_channels(texture)) {
      return about(
          "template",
          Error{Errc::invalid_data,
                "the texture must have one or three channels for the network " + file().path});
    }
    to_texture_ = InputMap::fit(size_of(texture), {side_px, side_px});
    texture_ =
        cv::Mat(side_px, static_cast<int>(file().camera.width_px), CV_32FC3, cv::Scalar::all(0.0));
    to_texture_.image(texture).copyTo(texture_.colRange(0, side_px));
    unit_m_ = side_px / to_texture_.scale()[0] * sheet->size_m.x() / sheet->size_px.x();
  }
  sheet_ = *sheet;
  return {};
}

Result<InputMap> Registration::map_of(const Camera& camera) const {
  const Camera& trained = file().camera;
  // Only the depth depends on the focal length there, and seen_cells() scales it.
  const bool has_size = camera.width_px > 0 && camera.height_px > 0 && camera.fx > 0.0;
  if (!file().is_for_any_texture() || !has_size) return InputMap::create(camera, trained);
  return InputMap::fit({static_cast<int>(camera.width_px), static_cast<int>(camera.height_px)},
                       {static_cast<int>(trained.width_px), static_cast<int>(trained.height_px)});
}

Eigen::Array2d Registration::uv_of(double first, double second) const {
  if (!file().is_for_any_texture()) return {first, second};
  const int side_px = file().texture_px;
  const auto texel = to_texture_.to_frame(side_px * first - 0.5, side_px * second - 0.5);
  return (Eigen::Array2d(texel[0], texel[1]) - sheet_.corner_px) / sheet_.size_px;
}

Result<NetworkMaps> Registration::run(const Image& image, int threads) {
  const Array<std::uint8_t>& pixels = image.pixels;
  const bool has_size =
      pixels.rows() > 0 && pixels.dim(0) == camera_.height_px && pixels.dim(1) == camera_.width_px;
  if (!has_size || !has_known_channels(pixels)) {
    return about("image", Error{Errc::invalid_data, "the image must have the size of the camera, " +
                                                        std::to_string(camera_.width_px) + " x " +
                                                        std::to_string(camera_.height_px) +
                                                        " px, and one or three channels"});
  }
  cv::Mat rgb = map_->image(pixels);
  if (file().is_for_any_texture()) cv::vconcat(rgb, texture_, rgb);
  return network_->run(rgb, threads);
}

Eigen::Array2d Registration::cell_px() const {
  const auto scale = map_->scale();
  const double step_px = file().cells.step_px;
  return {step_px / scale[0], step_px / scale[1]};
}

Result<void> Registration::check_share(const std::vector<SeenCell>& cells) const {
  if (share_of(cells) >= kLeastSeen) return {};
  return no_result("the network sees the object in " + tenths_of_percent(share_of(cells)) +
                   " of the image, " + tenths_of_percent(kLeastSeen) + " are needed");
}

double Registration::confidence(const std::vector<SeenCell>& cells, double excess) const {
  constexpr double kHalf = 0.0095, kSteepness = 5.0;
  if (cells.empty()) return 0.0;
  std::vector<double> errors_m, depths_m;
  for (const SeenCell& cell : cells) {
    errors_m.push_back(cell.error_m);
    depths_m.push_back(cell.depth_m);
  }
  // An error of a point by a share of the width is one of the apparent size by about that share.
  // The slope that this implies grows with the distance in widths.
  const double width_m = sheet_.size_m.x();
  const double share = median_in_place(errors_m) / width_m * median_in_place(depths_m) / width_m;
  return 1.0 / (1.0 + std::pow(excess * share / kHalf, kSteepness));
}

bool Registration::is_beyond(const SeenCell& cell) const {
  const Eigen::Array2d inside = cell.uv.max(0.0).min(1.0);
  const double off_m = ((cell.uv - inside) * sheet_.size_m).matrix().norm();
  return !(off_m <= cell.error_m);
}

std::vector<SeenCell> Registration::seen_cells(const NetworkMaps& maps,
                                               double least_probability) const {
  const CellGrid& grid = file().cells;
  const double centre_px = 0.5 * (grid.step_px - 1);
  const double depth_unit_m = file().is_for_any_texture()
                                  ? unit_m_ * map_->scale()[0] * camera_.fx / file().camera.fx
                                  : 1.0;
  std::vector<SeenCell> cells;
  for (int i = 0; i < grid.rows; ++i) {
    for (int j = 0; j < grid.columns; ++j) {
      const auto channel = [&](int c) {
        return static_cast<double>(maps.cells.at<float>(c, i * grid.columns + j));
      };
      const double probability = 1.0 / (1.0 + std::exp(-channel(0)));
      if (!(probability >= least_probability)) continue;
      const auto place = map_->to_frame(grid.step_px * j + centre_px, grid.step_px * i + centre_px);
      if (!camera_.shows(place[0], place[1])) continue;
      SeenCell cell{i, j, {place[0], place[1]}, uv_of(channel(1), channel(2)), probability};
      const auto exponential = [&](int c) {
        return std::exp(std::clamp(channel(c), -kMostLogarithm, kMostLogarithm));
      };
      cell.error_m = file().uv_error_factor * exponential(3) * unit_m_;
      cell.depth_m = exponential(4) * depth_unit_m;
      cell.depth_error_m = cell.depth_m * exponential(5);
      cells.push_back(cell);
    }
  }
  set_stretch(grid, sheet_.size_m, cell_px(), std::sqrt(camera_.fx * camera_.fy), cells);
  return cells;
}

}  // namespace weft::inference
