// SPDX-License-Identifier: Apache-2.0
#include "weft/core/suggest.hpp"

#include <gtest/gtest.h>

namespace weft {
namespace {

TEST(Suggest, CountsInsertionsDeletionsReplacementsAndSwapsOfNeighbours) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("ratio", "ratio"), 0u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("ratio", "ratios"), 1u);
  EXPECT_EQ(edit_distance("ratio", "rato"), 1u);
  EXPECT_EQ(edit_distance("ratio", "ratjo"), 1u);
  EXPECT_EQ(edit_distance("ratio", "raito"), 1u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
}

TEST(Suggest, FindsTheNearestName) {
  const std::vector<std::string> names{"alpha_s", "iterations", "ratio", "width_m"};
  EXPECT_EQ(nearest("raito", names), "ratio");
  EXPECT_EQ(nearest("interations", names), "iterations");
  EXPECT_EQ(nearest("WIDTH_M", names), "width_m");
  EXPECT_EQ(nearest("ratio", names), "ratio");
}

TEST(Suggest, CountsContainmentAsNear) {
  EXPECT_EQ(nearest("alpha", {"beta", "alpha_s"}), "alpha_s");
  EXPECT_EQ(nearest("neighbor", {"filters/pizarro", "filters/myneighbor"}), "filters/myneighbor");
  EXPECT_EQ(nearest("al", {"alpha_start"}), "");
}

TEST(Suggest, PrefersFewerEditsToContainmentAndEarlierNamesToLaterOnes) {
  EXPECT_EQ(nearest("path", {"path_to_something_else", "paths"}), "paths");
  EXPECT_EQ(nearest("node", {"mode", "nodes"}), "mode");
}

TEST(Suggest, StaysSilentWhenNothingIsNear) {
  EXPECT_EQ(nearest("zebra", {"ratio", "width_m"}), "");
  EXPECT_EQ(nearest("x", {"y"}), "");
  EXPECT_EQ(nearest("", {"a", ""}), "");
  EXPECT_EQ(nearest("ratio", {}), "");
}

TEST(Suggest, AllowsAboutAThirdOfTheLength) {
  EXPECT_EQ(nearest("abcXXXghi", {"abcdefghi"}), "abcdefghi");
  EXPECT_EQ(nearest("abXXXXghi", {"abcdefghi"}), "");
}

TEST(Suggest, ComparesTheNamesOfPluginsOfOneRoleAlone) {
  const std::vector<std::string> ids{"filters/aem", "filters/gms", "filters/myneighbor",
                                     "solvers/aem_like"};
  EXPECT_EQ(nearest("filters/foo", ids), "");
  EXPECT_EQ(nearest("filters/ame", ids), "filters/aem");
  EXPECT_EQ(nearest("filters/neighbor", ids), "filters/myneighbor");
  EXPECT_EQ(nearest("filter/aem", ids), "filters/aem");
  EXPECT_EQ(nearest("filters/", ids), "");
}

TEST(Suggest, WantsShortWordsToDifferInOneEdit) {
  EXPECT_EQ(nearest("foo", {"lmo", "aem"}), "");
  EXPECT_EQ(nearest("rnu", {"run"}), "run");
  EXPECT_EQ(nearest("rank", {"tran"}), "");
}

TEST(DidYouMean, EndsASentenceWithWhatIsNearOrWithWhatElseThereIs) {
  EXPECT_EQ(did_you_mean("alpah", {"beta", "alpha"}), "; did you mean 'alpha'?");
  EXPECT_EQ(did_you_mean("zzz", {"beta", "alpha"}), "");
  EXPECT_EQ(did_you_mean("zzz", {"beta"}, "; there is: beta"), "; there is: beta");
}

}  // namespace
}  // namespace weft
