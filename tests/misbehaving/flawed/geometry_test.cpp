// SPDX-License-Identifier: Apache-2.0
// The check must report each law of geometry for a component that breaks it, and for no other.
#include <gmock/gmock.h>

#include <iostream>
#include <stdexcept>
#include <string>
#include <weft/data/matrix.hpp>

#include "host/loading/registry.hpp"
#include "kit/testing/contract_stages.hpp"
#include "kit/testing/geometry/check_geometry.hpp"
#include "kit/testing/geometry/moves.hpp"

namespace weft::testing {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

ContractReport geometry_of(const std::string& id, const std::string& params) {
  const host::Registry registry = host::Registry::scan(host::search_path({WEFT_FLAWED_FOLDER}));
  const auto subject = Subject::find(registry, id, params, "/tmp");
  if (!subject) throw std::runtime_error(subject.error().message);
  const ContractOptions options;
  Checks checks(options);
  check_geometry(*subject, checks);
  if (subject->rules().samples) check_warp(*subject, checks);
  return checks.report();
}

struct Broken {
  const char *id, *flaw, *law;
};

class Laws : public ::testing::TestWithParam<Broken> {};

TEST_P(Laws, AreReportedForAComponentThatBreaksThem) {
  const auto [id, flaw, law] = GetParam();
  std::cout << "seed " << kContractSeed << '\n';
  const ContractReport report = geometry_of(id, "{flaw: " + std::string(flaw) + "}");
  EXPECT_THAT(report.failures, Contains(StartsWith(std::string(law) + ": ")));
}

INSTANTIATE_TEST_SUITE_P(
    OfGeometry, Laws,
    ::testing::Values(Broken{"filters/test_flawed", "order", "matches permuted"},
                      Broken{"filters/test_flawed", "twin", "matches given twice"},
                      Broken{"filters/test_flawed", "place", "image shifted"},
                      Broken{"filters/test_flawed", "pixels", "image scaled"},
                      Broken{"filters/test_flawed", "axis", "image rolled"},
                      Broken{"filters/test_flawed", "side", "image mirrored"},
                      Broken{"filters/test_flawed", "metres", "world scaled"},
                      Broken{"filters/test_flawed", "numbers", "vertices renumbered"},
                      Broken{"filters/test_flawed", "exact", "exact matches"},
                      Broken{"filters/test_flawed", "exact", "error grows with noise"},
                      Broken{"matchers/test_flawed", "order", "matches permuted"},
                      Broken{"matchers/test_flawed", "order", "exact matches"},
                      Broken{"matchers/test_flawed", "place", "image shifted"},
                      Broken{"warps/test_flawed", "aside", "identity warp"},
                      Broken{"warps/test_flawed", "aside", "image scaled"},
                      Broken{"warps/test_flawed", "aside", "image rolled"},
                      Broken{"warps/test_flawed", "aside", "exact matches"},
                      Broken{"warps/test_flawed", "noise", "error grows with noise"},
                      Broken{"warps/test_flawed", "jacobian", "derivatives of order 1"},
                      Broken{"warps/test_flawed", "hessian", "derivatives of order 2"},
                      Broken{"passes/test_flawed", "order", "matches permuted"},
                      Broken{"passes/test_flawed", "place", "image shifted"},
                      Broken{"passes/test_flawed", "pixels", "image scaled"},
                      Broken{"passes/test_flawed", "numbers", "vertices renumbered"},
                      Broken{"passes/test_flawed", "aside", "exact matches"},
                      Broken{"passes/test_flawed", "hidden", "exact matches"},
                      Broken{"passes/test_flawed", "nowhere", "exact matches"},
                      Broken{"solvers/test_flawed", "order", "matches permuted"},
                      Broken{"solvers/test_flawed", "count", "matches given twice"},
                      Broken{"solvers/test_flawed", "place", "image shifted"},
                      Broken{"solvers/test_flawed", "pixels", "image scaled"},
                      Broken{"solvers/test_flawed", "axis", "image rolled"},
                      Broken{"solvers/test_flawed", "axis", "image mirrored"},
                      Broken{"solvers/test_flawed", "metres", "world scaled"},
                      Broken{"solvers/test_flawed", "numbers", "vertices renumbered"},
                      Broken{"solvers/test_flawed", "depth", "exact matches"}));

class Sound : public ::testing::TestWithParam<const char*> {};

TEST_P(Sound, ComponentsBreakNone) {
  const ContractReport report = geometry_of(GetParam(), "{}");
  EXPECT_THAT(report.failures, IsEmpty());
  EXPECT_GE(report.checks, 10);
}

INSTANTIATE_TEST_SUITE_P(OfGeometry, Sound,
                         ::testing::Values("filters/test_flawed", "matchers/test_flawed",
                                           "warps/test_flawed", "passes/test_flawed",
                                           "solvers/test_flawed"));

TEST(ContractOfGeometry, ScalesParametersByTheirDeclaredUnit) {
  // Noise of 0.4 px becomes 0.8: a limit that stayed would reject most.
  EXPECT_THAT(geometry_of("filters/test_flawed", "{limit_px: 0.5}").failures,
              Not(Contains(StartsWith("image scaled"))));
}

TEST(ContractOfGeometry, SaysWhyACheckDoesNotApply) {
  EXPECT_THAT(geometry_of("filters/test_flawed", "{limit_px: 100}").inapplicable,
              ElementsAre(HasSubstr("image scaled: in these units")));
  EXPECT_THAT(geometry_of("passes/test_flawed", "{}").inapplicable,
              Contains(StartsWith("error grows with noise: ")));
}

TEST(ContractOfGeometry, DoesNotApplyToASceneThatTheComponentDoesNotSupport) {
  const ContractReport report = geometry_of("filters/test_flawed", "{flaw: one_size}");
  EXPECT_THAT(report.failures, IsEmpty());
  EXPECT_THAT(report.inapplicable,
              ElementsAre("world scaled: it refuses the moved scene: made for smaller templates"));
}

TEST(ContractOfGeometry, IsCheckedWhereItIsAskedFor) {
  ContractOptions options{.params = "{flaw: side}", .plugin_folders = {WEFT_FLAWED_FOLDER}};
  EXPECT_THAT(check_role_contract("filters/test_flawed", options).failures,
              Each(Not(StartsWith("image"))));
  options.geometry = true;
  EXPECT_THAT(check_role_contract("filters/test_flawed", options).failures,
              Contains(StartsWith("image mirrored: ")));
}

TEST(MovedScenes, ShowTheMovedSheetToTheMovedCamera) {
  const Scene scene = make_scene(0);
  for (const Move& move :
       {shift_image(), scale_image(), roll_image(scene), mirror_image(scene), scale_world(),
        renumber_vertices(scene), permute_matches(scene), repeat_matches(scene)}) {
    const Scene after = moved(scene, move);
    const Points2 seen_px =
        project_points(pinhole(after.camera), after.shape.vertices_m.matrix<3>());
    EXPECT_LT((seen_px - after.warp_samples.xy_px.matrix<2>()).cwiseAbs().maxCoeff(), 1e-9)
        << move.name;
    EXPECT_TRUE(all_in_image(after.camera, after.shape.vertices_m.matrix<3>())) << move.name;
  }
}

}  // namespace
}  // namespace weft::testing
