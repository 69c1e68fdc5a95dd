// SPDX-License-Identifier: Apache-2.0
#include "network.hpp"

#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::learned {
namespace {

constexpr float kLeastVariance = 1e-3F;
constexpr float kLeastAttention = 1e-6F;  // no set is without weight

template <class Number>
Number sigmoid(Number logit) {
  return Number{1} / (Number{1} + std::exp(-logit));
}

}  // namespace

void Block::apply(Hidden& h) const {
  const Eigen::Index n = h.cols();
  Eigen::VectorXf share = h.transpose() * attention;
  for (float& each : share) each = sigmoid(each + attention_bias) + kLeastAttention;
  share /= share.sum();
  Hidden x(kChannels, n);
  x.noalias() = weight * h;
  const Channels mean = x * share;
  Channels variance = Channels::Zero();
  for (Eigen::Index i = 0; i < n; ++i) {
    x.col(i) -= mean;
    variance += share(i) * x.col(i).cwiseAbs2();
  }
  const Channels scale = gain.array() * (variance.array() + kLeastVariance).rsqrt();
  for (Eigen::Index i = 0; i < n; ++i) {
    h.col(i) += (x.col(i).cwiseProduct(scale) + shift).cwiseMax(0.0F);
  }
}

Eigen::VectorXf logits_of(const Weights& weights, const MatchSet& matches) {
  const Normalised places = normalised(matches);
  Hidden h = weights.input * inputs_of(matches, places);
  h.colwise() += weights.input_bias;
  Eigen::Matrix<float, 2, Eigen::Dynamic> logits;
  for (std::size_t stage = 0; stage < kStages; ++stage) {
    constexpr std::size_t kPerStage = kBlocks / kStages;
    for (std::size_t k = stage * kPerStage; k < (stage + 1) * kPerStage; ++k) {
      ask_to_go_on();
      weights.blocks[k].apply(h);
    }
    logits = (weights.heads[stage] * h).colwise() + weights.head_biases[stage];
    if (stage + 1 == kStages) break;
    Eigen::VectorXd trust = logits.row(1).transpose().cast<double>();
    for (double& each : trust) each = sigmoid(each);
    h.noalias() += weights.fits[stage] * fit_inputs_of(places, trust);
    h.colwise() += weights.fit_biases[stage];
  }
  return logits.row(0).transpose();
}

}  // namespace weft::learned
