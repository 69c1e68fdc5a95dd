// SPDX-License-Identifier: Apache-2.0
// The contract of the role with its geometry, and inputs and memory that are legal and unusual.
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <weft/data/matrix.hpp>

#include "kit/conformance/check_list.hpp"
#include "kit/conformance/groups.hpp"
#include "kit/conformance/probes/passages.hpp"
#include "kit/conformance/probes/utf8_text.hpp"
#include "kit/testing/contract_stages.hpp"
#include "kit/testing/geometry/check_geometry.hpp"

namespace weft::conformance {
namespace {

/// The checks of the library for tests, each under its name in a group.
class RoleChecks {
 public:
  RoleChecks(const char* group, Notebook& notebook) : group_(group), notebook_(notebook) {
    options_.watch = [this](const std::string& what) {
      close();
      what_ = what;
      notebook_.begin(group_ + "/" + as_name(what));
    };
  }

  void make(const std::function<void(testing::Checks&)>& checks_of) {
    testing::Checks checks(options_);
    checks_ = &checks;
    checks_of(checks);
    close();
  }

 private:
  void close() {
    if (what_.empty()) return;
    const testing::ContractReport& report = checks_->report();
    const std::size_t begin = what_.size() + std::string(": ").size();
    Page page;
    for (; failed_ < report.failures.size(); ++failed_) {
      page.fail(report.failures[failed_].substr(begin));
    }
    for (; reported_ < report.inapplicable.size(); ++reported_) {
      page.skip(report.inapplicable[reported_].substr(begin));
    }
    notebook_.end(page);
  }

  std::string group_;
  Notebook& notebook_;
  testing::ContractOptions options_;
  testing::Checks* checks_ = nullptr;
  std::string what_;
  std::size_t failed_ = 0, reported_ = 0;
};

constexpr int kMostRefusals = 12;  ///< allocations whose refusal is tested

void check_passage(Play& play, Usual& usual, testing::Passage& passage, const char* fix,
                   Page& page) {
  const std::string how = lack(play.subject(), play.whole({.passage = &passage}), usual.answers());
  if (!how.empty()) page.fail(how + "; " + fix);
}

/// Refuses each of its allocations once.
void check_no_memory(Play& play, Page& page) {
  int refused = 0;
  for (int which = 0; which < kMostRefusals; ++which) {
    StingyHost host(which);
    const auto answers = play.whole({.passage = &host});
    if (!host.has_refused()) break;
    ++refused;
    const bool is_reported = host.answer() == WEFT_ERROR &&
                             std::any_of(answers.begin(), answers.end(), [](const Answer& answer) {
                               return answer.status == WEFT_ERROR && !answer.message.empty();
                             });
    page.expect(is_reported,
                fmt::format("alloc number {} gives null, and it answers {}: answer WEFT_ERROR with "
                            "WEFT_CODE_NO_MEMORY",
                            which + 1,
                            host.answer() != WEFT_ERROR ? fmt::format("status {}", host.answer())
                                                        : to_text(answers.back())));
  }
  if (refused == 0) page.skip("it allocates no memory");
}

/// Notes the texts of all errors, as the component wrote them.
class Listener final : public testing::Passage {
 public:
  std::int32_t process(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override {
    const std::int32_t status = Passage::process(component, self, call, inputs, error);
    const auto ends = [](const auto& text) {
      return std::find(std::begin(text), std::end(text), '\0') != std::end(text);
    };
    if (!ends(error->message) || !ends(error->where) || !ends(error->subject)) {
      mistake_ = "a text of its error does not end: write a NUL behind it";
    } else if (!is_utf8(error->message) || !is_utf8(error->where)) {
      mistake_ = "a text of its error is no UTF-8: cut it between characters";
    } else if (status != WEFT_OK && error->message[0] == '\0') {
      mistake_ = fmt::format("it answers with status {} without a reason: fill weft_error.message",
                             status);
    }
    return status;
  }
  const std::string& mistake() const { return mistake_; }

 private:
  std::string mistake_;
};

/// Called with a method that does not exist, and with the usual and degenerate cases of its role.
void check_error_text(Play& play, Page& page) {
  Listener listener;
  Performer performer(play.subject(), {.passage = &listener});
  if (!play.begin(performer).is_usable()) return;
  const RoleRules& rules = play.subject().rules();
  if (rules.part == PipelinePart::source) performer.call(kReadFrame, {}, 1ULL << 40U);
  if (rules.part == PipelinePart::stage || rules.part == PipelinePart::sink) {
    for (const testing::Case& given : testing::cases_of(play.subject())) {
      performer.call(rules.frame_method, given.inputs, 0);
    }
  }
  if (!listener.mistake().empty()) page.fail(listener.mistake());
}

/// The truth may be marked as unknown, in part and all of it.
void check_nan(Play& play, Page& page) {
  if (!play.subject().takes("ground_truth")) {
    return page.skip("none of its inputs may hold NaN");
  }
  testing::Case& given = play.given(0);
  Scene& scene = given.scene;
  scene.ground_truth.match_xy_px =
      make_array<double>(scene.ground_truth.match_xy_px.matrix<2>().eval());
  auto truth = scene.ground_truth.match_xy_px.matrix<2>();
  for (const Eigen::Index step : {3, 1}) {
    for (Eigen::Index i = 0; i < truth.rows(); i += step) {
      for (int k = 0; k < 2; ++k) {
        scene.ground_truth.match_xy_px(i, k) = std::numeric_limits<double>::quiet_NaN();
      }
    }
    given.inputs = testing::inputs_of(play.subject(), scene);
    Performer performer(play.subject());
    if (!play.begin(performer).is_usable()) return;
    const std::string mistake = play.mistake_in(play.frame(performer, 0), 0);
    if (!mistake.empty()) page.fail("where the truth is NaN: " + mistake);
  }
}

}  // namespace

void check_contract(const Setting& setting, Notebook& notebook) {
  const CheckInfo* only = find_check(notebook.choice().only);
  const bool is_of_role = only == nullptr || only->brief;
  if (is_of_role) {
    RoleChecks("contract", notebook).make([&](testing::Checks& checks) {
      testing::check_component(
          [&](const std::string& folder) { return setting.candidate.find(folder); }, checks);
    });
  }
  const auto made = Play::of(setting);
  if (!made) return;  // reported by the check of its parameters
  Play& play = **made;
  Usual usual(play);
  const bool has_inputs = !play.subject().rules().main_method().inputs.empty();
  const auto check = [&](const char* name, testing::Passage& passage, const char* fix) {
    notebook.check(std::string("contract/") + name, [&](Page& page) {
      if (!has_inputs) return page.skip("it has no inputs");
      check_passage(play, usual, passage, fix, page);
    });
  };
  LaidOut padded(Lie::padded), backwards(Lie::backwards), aligned(Lie::aligned);
  check("padded_inputs", padded, "step from row to row by stride[0]");
  check("backward_inputs", backwards, "step from row to row by stride[0], which may be negative");
  check("aligned_inputs", aligned, "assume no more of inputs than that their elements are aligned");
  Unknown arrays(Unknown::What::arrays), slots(Unknown::What::slots);
  check("unknown_arrays", arrays, "look for arrays by their names, and ignore others");
  check("undeclared_slots", slots, "look for inputs by their slots, and ignore others");
  notebook.check("contract/dirty_memory", [&](Page& page) {
    DirtyHost ones(0xFF), pattern(0x55);
    const char* fix = "write all of what alloc gave";
    check_passage(play, usual, ones, fix, page);
    check_passage(play, usual, pattern, fix, page);
  });
  notebook.check("contract/output_bounds", [&](Page& page) {
    WalledHost walls;
    check_passage(play, usual, walls, "take for the answer what alloc gave", page);
    page.expect(walls.breached().empty(), "it writes behind the end of " + walls.breached() +
                                              ": request all of it from alloc");
  });
  notebook.check("contract/no_memory", [&](Page& page) { check_no_memory(play, page); });
  notebook.check("contract/error_text", [&](Page& page) { check_error_text(play, page); });
  notebook.check("contract/nan_inputs", [&](Page& page) { check_nan(play, page); });
}

void check_geometry(const Setting& setting, Notebook& notebook) {
  RoleChecks("geometry", notebook).make([&](testing::Checks& checks) {
    const testing::ScratchFolder folder;
    const auto subject = setting.candidate.find(folder.path().string());
    if (subject) testing::check_geometry(*subject, checks);
  });
}

}  // namespace weft::conformance
