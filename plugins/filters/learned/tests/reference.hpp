// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

#include "../network.hpp"

namespace weft::learned::reference {

/// Fills a matrix with normal numbers of a standard deviation around a mean.
template <class Matrix>
void fill(Matrix& matrix, Rng& rng, double deviation, double mean = 0.0) {
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
      matrix(row, column) = static_cast<float>(mean + deviation * rng.normal());
    }
  }
}

inline Weights random_weights(std::uint64_t seed) {
  Rng rng(seed);
  Weights weights;
  fill(weights.input, rng, 0.5);
  fill(weights.input_bias, rng, 0.2);
  for (Block& block : weights.blocks) {
    fill(block.weight, rng, 0.15);
    fill(block.attention, rng, 0.1);
    fill(block.gain, rng, 0.1, 0.3);
    fill(block.shift, rng, 0.2);
    block.attention_bias = static_cast<float>(rng.normal());
  }
  for (auto& head : weights.heads) fill(head, rng, 0.1);
  for (auto& bias : weights.head_biases) fill(bias, rng, 0.3);
  for (auto& fit : weights.fits) fill(fit, rng, 0.2);
  for (auto& bias : weights.fit_biases) fill(bias, rng, 0.2);
  return weights;
}

using Table = std::vector<std::vector<double>>;  // [n][channels]

template <class Matrix>
std::vector<double> product(const Matrix& matrix, const std::vector<double>& x) {
  std::vector<double> y;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    double sum = 0.0;
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) {
      sum += static_cast<double>(matrix(row, k)) * x[to_index(k)];
    }
    y.push_back(sum);
  }
  return y;
}

inline double sigmoid(double logit) { return 1.0 / (1.0 + std::exp(-logit)); }

inline void apply(const Block& block, Table& h) {
  std::vector<double> share;
  double total = 0.0;
  for (const auto& row : h) {
    share.push_back(sigmoid(product(block.attention.transpose(), row)[0] +
                            static_cast<double>(block.attention_bias)) +
                    1e-6);
    total += share.back();
  }
  Table x;
  for (const auto& row : h) x.push_back(product(block.weight, row));
  for (std::size_t c = 0; c < kChannels; ++c) {
    double mean = 0.0, variance = 0.0;
    for (std::size_t i = 0; i < h.size(); ++i) mean += share[i] / total * x[i][c];
    for (std::size_t i = 0; i < h.size(); ++i) {
      variance += share[i] / total * (x[i][c] - mean) * (x[i][c] - mean);
    }
    const auto at = static_cast<Eigen::Index>(c);
    const double gain = static_cast<double>(block.gain(at));
    const double shift = static_cast<double>(block.shift(at));
    for (std::size_t i = 0; i < h.size(); ++i) {
      h[i][c] += std::max(0.0, (x[i][c] - mean) / std::sqrt(variance + 1e-3) * gain + shift);
    }
  }
}

inline void add_columns(const Eigen::MatrixXf& columns, std::size_t i, std::vector<double>& x) {
  for (Eigen::Index row = 0; row < columns.rows(); ++row) {
    x.push_back(static_cast<double>(columns(row, static_cast<Eigen::Index>(i))));
  }
}

/// The logits by loops in double precision. Inputs come from the functions of the filter.
inline std::vector<double> logits_of(const Weights& weights, const MatchSet& matches) {
  const Normalised places = normalised(matches);
  const auto n = to_index(matches.count());
  Table h(n);
  const Eigen::MatrixXf inputs = inputs_of(matches, places);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<double> x;
    add_columns(inputs, i, x);
    h[i] = product(weights.input, x);
    for (std::size_t c = 0; c < kChannels; ++c) {
      h[i][c] += static_cast<double>(weights.input_bias(static_cast<Eigen::Index>(c)));
    }
  }
  std::vector<double> logits(n);
  Eigen::VectorXd trust(matches.count());
  for (std::size_t k = 0; k < kBlocks; ++k) {
    apply(weights.blocks[k], h);
    if (k % 2 == 0) continue;
    const std::size_t stage = k / 2;
    for (std::size_t i = 0; i < n; ++i) {
      const std::vector<double> out = product(weights.heads[stage], h[i]);
      logits[i] = out[0] + static_cast<double>(weights.head_biases[stage](0));
      trust(static_cast<Eigen::Index>(i)) =
          sigmoid(out[1] + static_cast<double>(weights.head_biases[stage](1)));
    }
    if (stage == 2) break;
    const Eigen::MatrixXf fits = fit_inputs_of(places, trust);
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<double> x;
      add_columns(fits, i, x);
      const std::vector<double> added = product(weights.fits[stage], x);
      for (std::size_t c = 0; c < kChannels; ++c) {
        h[i][c] +=
            added[c] + static_cast<double>(weights.fit_biases[stage](static_cast<Eigen::Index>(c)));
      }
    }
  }
  return logits;
}

}  // namespace weft::learned::reference
