// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace weft::matchers {

/// A descriptor as it is compared: the numbers d themselves or, with a root, sqrt(d * unit *
/// scale).
struct ComparedRow {
  const float* numbers = nullptr;
  int length = 0;
  bool root = false;
  float unit = 1.0F;   ///< a power of two that keeps the product from overflow
  float scale = 0.0F;  ///< 1 / |unit * d|_1
};

/// The row sqrt(d / |d|_1) (RootSIFT, Arandjelovic and Zisserman 2012), for d >= 0; zero stays
/// zero.
ComparedRow root_of(const float* numbers, int length);

struct RowSurvey {
  bool is_finite = true;
  float lowest = 0.0F;  ///< minimum of its numbers and 0
  double norm = 0.0;    ///< |numbers|; may be infinite only where it is beyond double
};
RowSurvey survey_row(const float* numbers, int length);

/// |numbers - lowest|.
double norm_above(float lowest, const float* numbers, int length);

/// How a row was rounded.
struct Rounded {
  float error = 0.0F;             ///< |scale (row - lowest) - bytes|, or infinity
  float fine_error = 0.0F;        ///< |scale (row - lowest) - fine / kFineUnit|, or infinity
  std::int32_t squared_norm = 0;  ///< squared norm of the bytes, at most kLargestNorm
};

/// Number of fine units in one unit of a byte.
inline constexpr int kFineUnit = 128;

/// Rounds scale (row - lowest) to bytes of at most kLargestByte, and more finely; both are written
/// up to a multiple of eight.
Rounded round_row(const ComparedRow& row, float lowest, float scale, std::uint8_t* bytes,
                  std::int16_t* fine);

/// |a - b|^2 of fine rows, padded with zeros to a length that is a multiple of kRowBytes; below
/// 2^31 for all that round_row() makes.
std::int32_t fine_squared_distance(const std::int16_t* a, const std::int16_t* b, int length);

/// |a - b|, summed in double in an unspecified order: exact for whole numbers.
double l2_distance(const ComparedRow& a, const ComparedRow& b);

}  // namespace weft::matchers
