// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <thread>
#include <weft/sdk/filter.hpp>

#include "gate.hpp"
#include "script.hpp"

namespace scripted {

/// Records the previous shape that a component was given, as evidence.
inline void tell_previous(const std::optional<weft::Shape>& previous, weft::Diagnostics& diag) {
  diag.set("previous_state", previous ? previous->state : 0);
  diag.set("previous_age", previous ? static_cast<double>(previous->age_frames) : -1.0);
}

/// Rejects every n-th match.
class EveryFilter final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{.reads = "previous.shape"};
  static constexpr weft::Sweep kSweep{"every", {2, 3, 5}};

  explicit EveryFilter(weft::Params& p) : script_(p), gate_(p) {
    p.read("every", every_, "", {0, 1000}, "rejects matches whose index it divides, 0 for none");
    p.read("sleep_ms", sleep_ms_, "ms", {0, 10'000}, "time that each call takes");
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    if (auto cancelled = gate_.pass(in.call)) return *cancelled;
    if (auto failure = script_.failure(in.call)) return *failure;
    std::this_thread::sleep_for(std::chrono::milliseconds(sleep_ms_));
    const std::int64_t count = in.correspondences.count();
    const std::int64_t length = script_.length(in.call, count);
    weft::InlierMask mask{
        weft::Array<std::uint8_t>({length}, 0), weft::Array<double>({length}, 0.0), {}};
    double kept_before = 0.0;
    for (std::int64_t i = 0; i < length; ++i) {
      mask.kept(i) = every_ == 0 || i % every_ != 0 ? 1 : 0;
      mask.score(i) = script_.number(in.call, static_cast<double>(i));
      if (i < count) kept_before += in.correspondences.kept(i);
    }
    mask.diag.set("kept_before", kept_before);
    tell_previous(in.previous_shape, mask.diag);
    return script_.answer(in.call, std::move(mask));
  }

 private:
  Script script_;
  Gate gate_;
  int every_ = 0;
  int sleep_ms_ = 0;
};

/// Keeps what the draw wants.
class RandomFilter final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{.random = true};

  explicit RandomFilter(weft::Params&) {}

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const std::int64_t count = in.correspondences.count();
    weft::InlierMask mask{
        weft::Array<std::uint8_t>({count}, 0), weft::Array<double>({count}, 0.0), {}};
    weft::Rng rng = in.call.rng();
    for (std::int64_t i = 0; i < count; ++i) mask.kept(i) = rng.uniform() < 0.7 ? 1 : 0;
    mask.diag.set("threads", in.call.threads());
    return mask;
  }
};

/// Keeps all if a nested warp can be fitted.
class WarpedFilter final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{.needs = "template"};

  explicit WarpedFilter(weft::Params& p) {
    p.component("warp", warp_, "fitted to the matches that are kept");
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const auto warp = warp_.fit(in.call, in.correspondences, *in.templ);
    if (!warp) return warp.error();
    const std::int64_t count = in.correspondences.count();
    weft::InlierMask mask{
        weft::Array<std::uint8_t>({count}, 0), weft::Array<double>({count}, 0.0), {}};
    std::fill_n(mask.kept.data(), count, std::uint8_t{1});
    mask.diag.set("count", weft::Array<std::int32_t>({}, static_cast<std::int32_t>(count)));
    mask.others.set("x.acme.kept", mask.kept);
    return mask;
  }

 private:
  weft::WarpComponent warp_{"warps/test.scripted"};
};

/// Reads the truth; it declares that input only with `kSaysSo`.
template <bool kSaysSo>
class TruthFilter final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{.needs = "ground_truth", .uses_truth = kSaysSo};

  explicit TruthFilter(weft::Params&) {}

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const std::int64_t count = in.correspondences.count();
    weft::InlierMask mask{
        weft::Array<std::uint8_t>({count}, 0), weft::Array<double>({count}, 0.0), {}};
    mask.diag.set("truths", static_cast<double>(in.ground_truth->count()));
    return mask;
  }
};

}  // namespace scripted
