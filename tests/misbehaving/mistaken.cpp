// SPDX-License-Identifier: Apache-2.0
// Components that do not compile; compile_test.cpp reads why.
#include <weft/sdk/filter.hpp>
#include <weft/sdk/solver.hpp>

namespace {

struct Keeper : weft::Filter {
  explicit Keeper(weft::Params&) {}
  weft::Result<weft::InlierMask> filter(const weft::FilterInput&) override {
    return weft::no_result("nothing");
  }
};

class PrivateAbout final : public Keeper {
  static constexpr weft::About kAbout{.needs = "template"};

 public:
  using Keeper::Keeper;
};

struct MisspeltAbout final : Keeper {
  static constexpr weft::About kAbuot{.needs = "template"};
  using Keeper::Keeper;
};

struct OtherAbout final : Keeper {
  static constexpr const char* kAbout = "template";
  using Keeper::Keeper;
};

struct Unfinished final : weft::Solver {
  explicit Unfinished(weft::Params&) {}
};

struct Unmade final : weft::Filter {
  weft::Result<weft::InlierMask> filter(const weft::FilterInput&) override {
    return weft::no_result("nothing");
  }
};

constexpr weft_component kPrivateAbout =
    WEFT_COMPONENT(PrivateAbout, "filters/private_about", "1.0.0", "Nobody may read its needs.");
constexpr weft_component kMisspeltAbout =
    WEFT_COMPONENT(MisspeltAbout, "filters/misspelt_about", "1.0.0", "Nobody finds its needs.");
constexpr weft_component kOtherAbout =
    WEFT_COMPONENT(OtherAbout, "filters/other_about", "1.0.0", "Its needs are of another type.");
constexpr weft_component kOtherRole =
    WEFT_COMPONENT(Keeper, "solvers/keeper", "1.0.0", "Bears the role of another class.");
constexpr weft_component kIllegalId =
    WEFT_COMPONENT(Keeper, "filters/Keeper", "1.0.0", "Has a capital letter in its id.");
constexpr weft_component kUnfinished =
    WEFT_COMPONENT(Unfinished, "solvers/unfinished", "1.0.0", "Solves nothing.");
constexpr weft_component kUnmade =
    WEFT_COMPONENT(Unmade, "filters/unmade", "1.0.0", "Cannot be made.");

}  // namespace
