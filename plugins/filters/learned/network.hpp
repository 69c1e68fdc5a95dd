// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>
#include <weft/core/result.hpp>

#include "match_set.hpp"

namespace weft::learned {

constexpr int kChannels = 64;
constexpr int kBlocks = 6;
constexpr int kStages = 3;  ///< logits after each third of the blocks

using Channels = Eigen::Matrix<float, kChannels, 1>;
using Hidden = Eigen::Matrix<float, kChannels, Eigen::Dynamic>;

/// A linear map, context normalisation with attention and a ReLU, added to the input.
struct Block {
  Eigen::Matrix<float, kChannels, kChannels> weight;
  Channels attention, gain, shift;
  float attention_bias = 0.0F;

  void apply(Hidden& h) const;
};

struct Weights {
  Eigen::Matrix<float, kChannels, kInputs> input;
  Channels input_bias;
  std::array<Block, kBlocks> blocks;
  std::array<Eigen::Matrix<float, 2, kChannels>, kStages> heads;  ///< logit, logit of the fits
  std::array<Eigen::Vector2f, kStages> head_biases;
  std::array<Eigen::Matrix<float, kChannels, kFitInputs>, kStages - 1> fits;
  std::array<Channels, kStages - 1> fit_biases;
};

/// Parses an npz archive. An error has `name`, the member and what to do.
Result<Weights> parse_weights(std::string_view archive, const std::string& name);

/// Reads the file of weights at a path.
Result<Weights> read_weights(const std::string& path);

/// The weights that are part of this library.
Result<Weights> built_in_weights();

/// The logit of each match, of 4 or more.
Eigen::VectorXf logits_of(const Weights& weights, const MatchSet& matches);

}  // namespace weft::learned
