// SPDX-License-Identifier: Apache-2.0
#include "description.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numbers>
#include <weft/core/index.hpp>

#include "gradients.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sift_fast/description.cpp"
#include <hwy/foreach_target.h>
// Highway requires its headers in this order.
#include <hwy/highway.h>

#ifndef WEFT_SIFT_FAST_DESCRIPTION
#define WEFT_SIFT_FAST_DESCRIPTION
namespace weft::sift_fast {

constexpr std::size_t kCells = 4, kDirections = 8;
/// Nodes of the grid along a cell, and along the grid, which reaches half a cell beyond the cells.
constexpr std::size_t kPerCell = 4, kSide = kPerCell * (kCells + 1);
constexpr std::size_t kNodes = kSide * kSide;
/// Elements of one column of nodes: eight directions.
constexpr std::size_t kColumn = kDirections;

/// Weights of rows and columns of nodes, the same for all keypoints: each row lies between two rows
/// of cells. The window, a Gaussian, is a product too.
struct NodeWeights {
  std::int16_t upper[kSide], lower[kSide];  ///< for the cells above and below, 2^14 is 1
  float left[kSide], right[kSide];          ///< for the cells on either side
};

/// Where a grid lies in its layer: its middle, and how far one cell reaches.
struct RotatedFrame {
  float x, y;
  float cosine, sine;  ///< px
};

}  // namespace weft::sift_fast
#endif

HWY_BEFORE_NAMESPACE();
namespace weft::sift_fast::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Which elements of a plane are the nodes: their places from its first element on. `across` and
/// `down` are those of the grid that is not turned.
void Places(const float* across, const float* down, const RotatedFrame& frame,
            std::ptrdiff_t stride, std::int32_t* places) {
  const hn::CappedTag<float, 16> d;
  const hn::Rebind<std::int32_t, decltype(d)> whole;
  const auto width = hn::Set(whole, static_cast<std::int32_t>(stride));
  const auto x0 = hn::Set(d, frame.x), y0 = hn::Set(d, frame.y);
  const auto cosine = hn::Set(d, frame.cosine), sine = hn::Set(d, frame.sine);
  for (std::size_t i = 0; i < kNodes; i += hn::Lanes(d)) {
    const auto u = hn::LoadU(d, across + i), v = hn::LoadU(d, down + i);
    const auto x = hn::Add(x0, hn::Sub(hn::Mul(cosine, u), hn::Mul(sine, v)));
    const auto y = hn::Add(y0, hn::Add(hn::Mul(sine, u), hn::Mul(cosine, v)));
    hn::StoreU(hn::Add(hn::Mul(hn::NearestInt(y), width), hn::NearestInt(x)), whole, places + i);
  }
}

/// Sums of gradients for each row of cells, column of nodes and direction, [kCells, kSide, 8]. A
/// gradient is shared by the two nearest directions, which differ by an eighth of a turn: angles
/// differ as 16-bit numbers do.
#if HWY_TARGET == HWY_SCALAR
void AddRowsOfNodes(const std::int16_t* lengths, const std::uint16_t* angles,
                    const NodeWeights& weights, std::int16_t* sums) {
  const auto times = [](int a, int b) { return (a * b + (1 << 14)) >> 15; };
  std::fill_n(sums, kCells * kSide * kColumn, std::int16_t{0});
  for (std::size_t i = 0; i < kNodes * kDirections; ++i) {
    const std::size_t node = i / kDirections, row = node / kSide, column = node % kSide;
    const std::size_t direction = i % kDirections, below = row / kPerCell;
    const auto difference = static_cast<std::int16_t>(angles[node] - 8192 * direction);
    const int near = std::max(8192 - std::abs(int{difference}), 0);
    const int part = times(2 * near, lengths[node]);
    std::int16_t* to = sums + column * kColumn + direction;
    if (below > 0) {
      std::int16_t& sum = to[(below - 1) * kSide * kColumn];
      sum = static_cast<std::int16_t>(sum + times(part, weights.upper[row]));
    }
    if (below < kCells) {
      std::int16_t& sum = to[below * kSide * kColumn];
      sum = static_cast<std::int16_t>(sum + times(part, weights.lower[row]));
    }
  }
}
#else
void AddRowsOfNodes(const std::int16_t* lengths, const std::uint16_t* angles,
                    const NodeWeights& weights, std::int16_t* sums) {
  const hn::CappedTag<std::int16_t, kPerCell * kColumn> d;
  const hn::RebindToUnsigned<decltype(d)> u;
  const hn::Repartition<std::uint8_t, decltype(d)> bytes;
  constexpr std::size_t kMost = kPerCell;  // vectors for four columns, of one block each
  const std::size_t lanes = hn::Lanes(d), vectors = kPerCell * kColumn / lanes;

  alignas(64) std::uint8_t spread[kPerCell * kColumn * 2];
  alignas(64) std::uint16_t directions[kPerCell * kColumn];
  for (std::size_t i = 0; i < kPerCell * kColumn; ++i) {
    spread[2 * i] = static_cast<std::uint8_t>(2 * (i / kColumn));
    spread[2 * i + 1] = static_cast<std::uint8_t>(2 * (i / kColumn) + 1);
    directions[i] = static_cast<std::uint16_t>(8192 * (i % kColumn));
  }
  const auto eighth = hn::Set(u, 8192);
  const auto direction = hn::LoadU(u, directions);  // the same in each block

  for (std::size_t column = 0; column < kSide; column += kPerCell) {
    hn::Vec<decltype(d)> upper[kMost], lower[kMost];
    for (std::size_t v = 0; v < vectors; ++v) upper[v] = lower[v] = hn::Zero(d);
    for (std::size_t row = 0; row < kSide; ++row) {
      const auto four_lengths = hn::LoadDup128(d, lengths + row * kSide + column);
      const auto four_angles = hn::LoadDup128(u, angles + row * kSide + column);
      const auto to_upper = hn::Set(d, weights.upper[row]);
      const auto to_lower = hn::Set(d, weights.lower[row]);
      for (std::size_t v = 0; v < vectors; ++v) {
        const auto which = hn::LoadU(bytes, spread + v * 2 * lanes);
        const auto length = hn::TableLookupBytes(four_lengths, hn::BitCast(d, which));
        const auto angle = hn::TableLookupBytes(four_angles, hn::BitCast(u, which));
        const auto difference = hn::Abs(hn::BitCast(d, hn::Sub(angle, direction)));
        const auto near = hn::SaturatedSub(eighth, hn::BitCast(u, difference));
        const auto part = hn::MulFixedPoint15(hn::BitCast(d, hn::Add(near, near)), length);
        upper[v] = hn::Add(upper[v], hn::MulFixedPoint15(part, to_upper));
        lower[v] = hn::Add(lower[v], hn::MulFixedPoint15(part, to_lower));
      }
      if (row % kPerCell != kPerCell - 1) continue;
      // The rows between two rows of cells are done: the upper of these is complete.
      const std::size_t below = row / kPerCell;
      for (std::size_t v = 0; v < vectors; ++v) {
        if (below > 0) {
          hn::StoreU(upper[v], d, sums + ((below - 1) * kSide + column) * kColumn + v * lanes);
        }
        upper[v] = lower[v];
        lower[v] = hn::Zero(d);
      }
    }
  }
}
#endif

/// Sums of columns for each cell, [kCells, kCells, 8].
void AddColumnsOfNodes(const std::int16_t* sums, const NodeWeights& weights, float* cells) {
  const hn::CappedTag<float, kColumn> d;
  const hn::Rebind<std::int16_t, decltype(d)> narrow;
  const hn::Rebind<std::int32_t, decltype(d)> whole;
  for (std::size_t row = 0; row < kCells; ++row) {
    for (std::size_t part = 0; part < kColumn; part += hn::Lanes(d)) {
      const std::int16_t* at = sums + row * kSide * kColumn + part;
      auto before = hn::Zero(d);
      for (std::size_t cell = 0; cell <= kCells; ++cell) {
        auto left = before, right = hn::Zero(d);
        for (std::size_t i = cell * kPerCell; i < (cell + 1) * kPerCell; ++i) {
          const auto sum =
              hn::ConvertTo(d, hn::PromoteTo(whole, hn::LoadU(narrow, at + i * kColumn)));
          left = hn::Add(left, hn::Mul(sum, hn::Set(d, weights.left[i])));
          right = hn::Add(right, hn::Mul(sum, hn::Set(d, weights.right[i])));
        }
        if (cell > 0) {
          hn::StoreU(left, d, cells + (row * kCells + cell - 1) * kDirections + part);
        }
        before = right;
      }
    }
  }
}

/// In four sums, so that all vectors give the same.
float SumOfSquares(const float* values, float largest) {
  const hn::CappedTag<float, 4> d;
  alignas(16) float sums[4] = {};
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t part = 0; part < 4; part += lanes) {
    auto sum = hn::Zero(d);
    for (std::size_t i = part; i < kDescriptorLength; i += 4) {
      const auto value = hn::Min(hn::LoadU(d, values + i), hn::Set(d, largest));
      sum = hn::Add(sum, hn::Mul(value, value));
    }
    hn::StoreU(sum, d, sums + part);
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

void ToBytes(const float* values, float largest, float scale, float* descriptor) {
  const hn::CappedTag<float, 16> d;
  for (std::size_t i = 0; i < kDescriptorLength; i += hn::Lanes(d)) {
    const auto value = hn::Min(hn::LoadU(d, values + i), hn::Set(d, largest));
    const auto scaled = hn::Min(hn::Mul(value, hn::Set(d, scale)), hn::Set(d, 255.0F));
    hn::StoreU(hn::Round(scaled), d, descriptor + i);
  }
}

/// Lengths as parts of the largest one, which becomes `one`; false if all are 0.
bool ToParts(const float* lengths, std::size_t count, float one, std::int16_t* parts) {
  const hn::ScalableTag<float> d;
  const hn::Rebind<std::int16_t, decltype(d)> narrow;
  auto largest = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    largest = hn::Max(largest, hn::LoadU(d, lengths + i));
  }
  const float most = hn::GetLane(hn::MaxOfLanes(d, largest));
  if (!(most > 0.0F)) return false;
  const auto scale = hn::Set(d, one / most);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto part = hn::NearestInt(hn::Mul(hn::LoadU(d, lengths + i), scale));
    hn::StoreU(hn::DemoteTo(narrow, part), narrow, parts + i);
  }
  return true;
}

}  // namespace weft::sift_fast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace weft::sift_fast {
namespace {

HWY_EXPORT(Places);
HWY_EXPORT(AddRowsOfNodes);
HWY_EXPORT(AddColumnsOfNodes);
HWY_EXPORT(SumOfSquares);
HWY_EXPORT(ToBytes);
HWY_EXPORT(ToParts);

constexpr float kCellSigmas = 3.0F;
constexpr float kLargestPart = 0.2F;
constexpr float kLength = 512.0F;
/// Largest length of a gradient among those of a keypoint.
constexpr float kLargestLength = 32767.0F;
/// Bytes that are read behind the last node.
constexpr std::size_t kPadding = 64;

/// Place of a row or column of nodes, cells from the middle of the grid.
double place_of(std::size_t node) {
  return (static_cast<double>(node) + 0.5) / kPerCell - 0.5 * (kCells + 1);
}

NodeWeights make_weights() {
  NodeWeights weights{};
  for (std::size_t i = 0; i < kSide; ++i) {
    const double place = place_of(i);
    const double window = std::exp(-place * place / (0.5 * kCells * kCells));
    const double behind = std::fmod(static_cast<double>(i) + 0.5, kPerCell) / kPerCell;
    weights.upper[i] = static_cast<std::int16_t>(std::lrint(16384.0 * window * (1.0 - behind)));
    weights.lower[i] = static_cast<std::int16_t>(std::lrint(16384.0 * window * behind));
    weights.left[i] = static_cast<float>(window * (1.0 - behind));
    weights.right[i] = static_cast<float>(window * behind);
  }
  return weights;
}

}  // namespace

/// The grid of one keypoint.
struct Description::Grid {
  NodeWeights weights = make_weights();
  float across[kNodes], down[kNodes];  ///< places of nodes, cells from the middle
  std::int32_t places[kNodes];
  std::int16_t right[kNodes + kPadding] = {}, below[kNodes + kPadding] = {};
  float lengths[kNodes + kPadding] = {};
  std::uint16_t angles[kNodes + kPadding] = {};
  std::int16_t parts[kNodes + kPadding] = {};
  std::int16_t sums[kCells * kSide * kColumn];
  float cells[kDescriptorLength];

  Grid() {
    for (std::size_t i = 0; i < kNodes; ++i) {
      across[i] = static_cast<float>(place_of(i % kSide));
      down[i] = static_cast<float>(place_of(i / kSide));
    }
  }

  void load_gradient(std::size_t node, const std::int16_t* at, std::ptrdiff_t stride) {
    right[node] = static_cast<std::int16_t>(at[1] - at[-1]);
    below[node] = static_cast<std::int16_t>(at[stride] - at[-stride]);
  }

  void load_gradients(const Plane& layer, const RotatedFrame& frame) {
    HWY_DYNAMIC_DISPATCH(Places)(across, down, frame, layer.stride, places);
    for (std::size_t i = 0; i < kNodes; ++i) load_gradient(i, layer.data + places[i], layer.stride);
  }

  /// The same near the border: nodes on it and outside have no gradient.
  void load_gradients_inside(const Plane& layer, const RotatedFrame& frame) {
    for (std::size_t i = 0; i < kNodes; ++i) {
      const float u = across[i], v = down[i];
      const float x = std::nearbyint(frame.x + (frame.cosine * u - frame.sine * v));
      const float y = std::nearbyint(frame.y + (frame.sine * u + frame.cosine * v));
      right[i] = below[i] = 0;
      if (x >= 1.0F && y >= 1.0F && x <= static_cast<float>(layer.width - 2) &&
          y <= static_cast<float>(layer.height - 2)) {
        load_gradient(i, layer.row(static_cast<int>(y)) + static_cast<int>(x), layer.stride);
      }
    }
  }
};

RotatedFrame frame_of(const Spot& spot) {
  const auto angle = static_cast<double>(spot.angle);
  const double cell = static_cast<double>(kCellSigmas * spot.scale);
  return {spot.x, spot.y, static_cast<float>(cell * std::cos(angle)),
          static_cast<float>(cell * std::sin(angle))};
}

/// True if all nodes have neighbours on all sides.
bool is_inside(const Plane& layer, const RotatedFrame& frame) {
  const float reach = 0.5F * (kCells + 1) * (std::abs(frame.cosine) + std::abs(frame.sine)) + 2.0F;
  return frame.x > reach && frame.y > reach &&
         frame.x + reach < static_cast<float>(layer.width - 1) &&
         frame.y + reach < static_cast<float>(layer.height - 1);
}

Description::Description() : grid_(std::make_unique<Grid>()) {}
Description::~Description() = default;
Description::Description(Description&&) noexcept = default;
Description& Description::operator=(Description&&) noexcept = default;

void Description::describe(const Plane& layer, const Spot& spot, float* descriptor) {
  Grid& grid = *grid_;
  const RotatedFrame place = frame_of(spot);
  if (is_inside(layer, place)) {
    grid.load_gradients(layer, place);
  } else {
    grid.load_gradients_inside(layer, place);
  }
  to_polar(grid.right, grid.below, kNodes, grid.lengths, grid.angles);
  if (!HWY_DYNAMIC_DISPATCH(ToParts)(grid.lengths, kNodes, kLargestLength, grid.parts)) {
    std::fill_n(descriptor, kDescriptorLength, 0.0F);
    return;
  }
  const double frame = static_cast<double>(spot.angle) * (0.5 * kTurn / std::numbers::pi);
  const auto own = static_cast<std::uint16_t>(std::lrint(frame));
  for (std::size_t i = 0; i < kNodes; ++i) {
    grid.angles[i] = static_cast<std::uint16_t>(own - grid.angles[i]);
  }
  HWY_DYNAMIC_DISPATCH(AddRowsOfNodes)(grid.parts, grid.angles, grid.weights, grid.sums);
  HWY_DYNAMIC_DISPATCH(AddColumnsOfNodes)(grid.sums, grid.weights, grid.cells);
  constexpr float kNoLimit = 1e30F;
  const float length = std::sqrt(HWY_DYNAMIC_DISPATCH(SumOfSquares)(grid.cells, kNoLimit));
  const float largest = kLargestPart * length;
  const float cut = std::sqrt(HWY_DYNAMIC_DISPATCH(SumOfSquares)(grid.cells, largest));
  const float scale = cut > 0.0F ? kLength / cut : 0.0F;
  HWY_DYNAMIC_DISPATCH(ToBytes)(grid.cells, largest, scale, descriptor);
}

}  // namespace weft::sift_fast
#endif
