// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/play.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

#include "host/records/record.hpp"
#include "kit/testing/contract_outputs.hpp"

namespace weft::conformance {
namespace {

constexpr double kLoose = 1e-3;

Answer refusal(const Error& error) { return {WEFT_ERROR, error.code, error.message, {}}; }

template <class Number>
bool is_near(const weft_array& a, const weft_array& b, std::size_t count) {
  const auto* of_a = static_cast<const Number*>(a.data);
  const auto* of_b = static_cast<const Number*>(b.data);
  double largest = 0.0, worst = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    largest = std::max(largest, std::abs(static_cast<double>(of_a[i])));
    worst = std::max(worst, std::abs(static_cast<double>(of_a[i]) - of_b[i]));
  }
  return worst <= kLoose * largest;
}

/// Compares arrays of the same type and lengths.
bool is_near(const weft_array& a, const weft_array& b) {
  std::size_t count = 1;
  for (int i = 0; i < a.ndim; ++i) count *= to_index(a.shape[i]);
  if (a.dtype == WEFT_F64) return is_near<double>(a, b, count);
  return a.dtype != WEFT_F32 || is_near<float>(a, b, count);
}

std::string loose_difference(const Answer& a, const Answer& b) {
  if (a.status != b.status) return "it reports " + to_text(a) + ", not " + to_text(b);
  for (const auto& [slot, record] : a.outputs) {
    const testing::HostRecord other = b.find(slot);
    if (record == nullptr || other == nullptr) return "it makes other outputs";
    const weft_record of_a = testing::view_of(record), of_b = testing::view_of(other);
    for (std::uint64_t i = 0; i < of_a.count && i < of_b.count; ++i) {
      const weft_array &array = of_a.arrays[i], &same = of_b.arrays[i];
      const bool fits =
          array.ndim == same.ndim && std::equal(array.shape, array.shape + array.ndim, same.shape);
      if (fits && !is_near(array, same)) return slot + "/" + array.name + " differs";
    }
  }
  return "";
}

/// The array of this name, or null.
const weft_array* array_in(const weft_record& record, std::string_view name) {
  for (std::uint64_t i = 0; i < record.count; ++i) {
    if (record.arrays[i].name == name) return &record.arrays[i];
  }
  return nullptr;
}

bool is_same(const weft_array& a, const weft_array& b) {
  if (a.dtype != b.dtype || a.ndim != b.ndim || !std::equal(a.shape, a.shape + a.ndim, b.shape)) {
    return false;
  }
  const auto bytes = to_index(host::array_bytes(a.dtype, a.ndim, a.shape));
  return bytes == 0 || std::memcmp(a.data, b.data, bytes) == 0;
}

std::string lack(const Answer& given, const Answer& expected) {
  for (const auto& [slot, record] : expected.outputs) {
    const testing::HostRecord other = given.find(slot);
    if (record == nullptr || other == nullptr) return "it makes other outputs";
    const weft_record arrays = testing::view_of(record), others = testing::view_of(other);
    for (std::uint64_t i = 0; i < arrays.count; ++i) {
      const weft_array& array = arrays.arrays[i];
      const weft_array* const same = array_in(others, array.name);
      if (same == nullptr || !is_same(array, *same)) return slot + "/" + array.name + " differs";
    }
  }
  return "";
}

}  // namespace

Result<std::unique_ptr<Play>> Play::of(const Setting& setting, const yaml::Node* params) {
  auto folder = std::make_unique<testing::ScratchFolder>();
  auto subject = setting.candidate.find(folder->path().string(), params);
  if (!subject) return subject.error();
  return std::unique_ptr<Play>(new Play(std::move(folder), *std::move(subject), setting));
}

Play::Play(std::unique_ptr<testing::ScratchFolder> folder, testing::Subject subject,
           const Setting& setting)
    : folder_(std::move(folder)), subject_(std::move(subject)) {
  for (std::size_t i = 0; i < cases_.size(); ++i) {
    cases_[i] = {"", testing::Expect::any, setting.scenes[i],
                 testing::inputs_of(subject_, setting.scenes[i])};
  }
}

Answer Play::begin(Performer& performer) {
  if (auto ready = performer.begin(scene().templ, scene().camera); !ready) {
    return refusal(ready.error());
  }
  return open(performer);
}

Answer Play::open(Performer& performer) const {
  const PipelinePart part = subject_.rules().part;
  if (part == PipelinePart::source) return performer.call(kOpenSource, {});
  if (part != PipelinePart::sink) return {};
  std::error_code ignored;  // a sink may refuse to overwrite the files of an earlier one
  for (const auto& entry : std::filesystem::directory_iterator(folder_->path(), ignored)) {
    std::filesystem::remove_all(entry.path(), ignored);
  }
  return performer.call(kOpenSink, {});
}

Answer Play::frame(Performer& performer, std::uint64_t number) {
  const PipelinePart part = subject_.rules().part;
  const auto& inputs = given(number).inputs;
  if (part == PipelinePart::source) return performer.call(kReadFrame, {}, number);
  if (part == PipelinePart::templ) return performer.call(kBuildTemplate, {});
  if (part == PipelinePart::sink) return performer.call(kWriteFrame, inputs, number);
  return performer.call(kRunStage, inputs, number);
}

Answer Play::end(Performer& performer) const {
  if (subject_.rules().part == PipelinePart::sink) return performer.call(kFinishSink, {});
  return {};
}

std::vector<Answer> Play::whole(const Performance& how) {
  Performer performer(subject_, how);
  if (auto ready = performer.begin(scene().templ, scene().camera); !ready) {
    return {refusal(ready.error())};
  }
  return frames(performer);
}

std::vector<Answer> Play::frames(Performer& performer) {
  std::vector<Answer> answers = {open(performer)};
  if (!answers.front().is_usable()) return answers;
  for (const std::uint64_t number : {0, 1}) answers.push_back(frame(performer, number));
  if (subject_.rules().samples) {
    if (const auto warp = answers.back().find("warp")) {
      const auto points = scene().templ.flat_px.matrix<2>().topRows(9);
      answers.push_back(performer.evaluate(warp, {make_array<double>(Points2(points)), 2}));
    }
  }
  answers.push_back(end(performer));
  return answers;
}

std::string Play::mistake_in(const Answer& answer, std::uint64_t frame) const {
  const testing::ContractOptions options;
  testing::Checks checks(options);
  checks.begin("answer");
  testing::check_answer(answer, checks);
  const bool is_stage = subject_.rules().part == PipelinePart::stage;
  if (answer.is_usable() && is_stage) {
    testing::check_outputs(subject_, cases_[frame % 2], answer, checks);
  }
  const auto& failures = checks.report().failures;
  return failures.empty() ? "" : failures.front().substr(std::string("answer: ").size());
}

std::string difference(const testing::Subject& subject, const Answer& a, const Answer& b) {
  return subject.is_exact() ? testing::difference(a, b) : loose_difference(a, b);
}

std::string difference(const testing::Subject& subject, const std::vector<Answer>& a,
                       const std::vector<Answer>& b) {
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    std::string how = difference(subject, a[i], b[i]);
    if (!how.empty()) return how;
  }
  return a.size() == b.size() ? "" : "it ends early: " + to_text(a.back());
}

std::string lack(const testing::Subject& subject, const std::vector<Answer>& given,
                 const std::vector<Answer>& expected) {
  if (!subject.is_exact()) return difference(subject, given, expected);
  if (given.size() != expected.size()) return "it ends early: " + to_text(given.back());
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (given[i].status != expected[i].status) {
      return "it reports " + to_text(given[i]) + ", not " + to_text(expected[i]);
    }
    std::string how = lack(given[i], expected[i]);
    if (!how.empty()) return how;
  }
  return "";
}

}  // namespace weft::conformance
