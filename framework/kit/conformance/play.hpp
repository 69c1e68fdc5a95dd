// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "kit/conformance/candidate.hpp"
#include "kit/testing/contract_cases.hpp"
#include "kit/testing/contract_stages.hpp"

namespace weft::conformance {

using testing::Answer;
using testing::Performance;
using testing::Performer;
using testing::Scene;

/// A component that is checked, and the frames that it is shown.
struct Setting {
  explicit Setting(const Candidate& which)
      : candidate(which),
        scenes{testing::make_scene(0, which.seed), testing::make_scene(1, which.seed)} {}

  const Candidate& candidate;
  std::array<Scene, 2> scenes;  ///< [2] one per frame
};

/// A component with its parameters, and usual calls of it, for any role. It writes into a temporary
/// directory, which is deleted with this object.
class Play {
 public:
  static Result<std::unique_ptr<Play>> of(const Setting& setting,
                                          const yaml::Node* params = nullptr);

  const testing::Subject& subject() const { return subject_; }
  const Scene& scene() const { return cases_[0].scene; }
  testing::Case& given(std::uint64_t frame) { return cases_[frame % 2]; }

  /// Creates it and makes all ready up to the first frame: prepares it, opens a source or a sink.
  Answer begin(Performer& performer);
  Answer open(Performer& performer) const;
  /// One frame; the template of a template.
  Answer frame(Performer& performer, std::uint64_t number);
  /// Ends what a sink writes.
  Answer end(Performer& performer) const;

  /// The whole life of an instance, from its creation to its end: two frames, in a new instance. A
  /// warp is evaluated too.
  std::vector<Answer> whole(const Performance& how = {});
  /// The same in an instance that there is, but for its creation.
  std::vector<Answer> frames(Performer& performer);

  /// The error of the answer to a frame, in words; empty if there is none.
  std::string mistake_in(const Answer& answer, std::uint64_t frame) const;

 private:
  Play(std::unique_ptr<testing::ScratchFolder> folder, testing::Subject subject,
       const Setting& setting);

  std::unique_ptr<testing::ScratchFolder> folder_;
  testing::Subject subject_;
  std::array<testing::Case, 2> cases_;
};

/// The answers of a component to usual calls, computed once and only on request.
class Usual {
 public:
  explicit Usual(Play& play) : play_(play) {}
  const std::vector<Answer>& answers() {
    if (answers_.empty()) answers_ = play_.whole();
    return answers_;
  }

 private:
  Play& play_;
  std::vector<Answer> answers_;
};

/// The difference between two lists of answers. If the component is exact, any byte counts.
/// Otherwise status, lengths, and differences above a thousandth of the largest number count. Empty
/// if there is none.
std::string difference(const testing::Subject& subject, const std::vector<Answer>& a,
                       const std::vector<Answer>& b);
std::string difference(const testing::Subject& subject, const Answer& a, const Answer& b);

/// The same, but that `given` may have more arrays: those of its inputs that a component hands on.
std::string lack(const testing::Subject& subject, const std::vector<Answer>& given,
                 const std::vector<Answer>& expected);

}  // namespace weft::conformance
