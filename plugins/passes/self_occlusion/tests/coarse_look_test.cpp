// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/visibility.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace {

using weft::Visibility;
using weft::testing::input;
using weft::testing::PluginUnderTest;

constexpr std::uint64_t kFineSheetSeed = 20261125;

/// A fine mesh of a flat surface, whose right fifth may be folded behind the rest.
struct FineSheet {
  weft::Template templ;
  weft::Camera camera = weft::testing::make_camera();
  weft::Points3 flat_m, folded_m;

  FineSheet() {
    weft::testing::SheetSpec spec;
    spec.columns = 61;
    spec.rows = 37;
    templ = weft::testing::make_template(spec);
    flat_m = templ.vertices_m.matrix<3>();
    const double edge_m = 0.8 * flat_m.col(0).maxCoeff();
    flat_m.rowwise() += Eigen::RowVector3d(-0.15, -0.09, 0.6);
    folded_m = flat_m;
    for (Eigen::Index v = 0; v < flat_m.rows(); ++v) {
      const double beyond_m = flat_m(v, 0) - (edge_m - 0.15);
      if (beyond_m > 0.0) folded_m.row(v) += Eigen::RowVector3d(-2.0 * beyond_m, 0.0, 0.02);
    }
  }

  Visibility look(const weft::Points3& vertices_m, const std::string& params,
                  const weft::Correspondences* matches = nullptr) {
    weft::Shape shape;
    shape.vertices_m = weft::make_array<double>(vertices_m);
    shape.source = weft::Array<std::uint8_t>({vertices_m.rows()}, 1);
    std::vector<weft::testing::Input> inputs{input("template", templ), input("camera", camera),
                                             input("shape", shape)};
    if (matches != nullptr) inputs.push_back(input("correspondences", *matches));
    passes.push_back(std::make_unique<PluginUnderTest>("passes/self_occlusion", params));
    const auto answer = passes.back()->process(0, inputs);
    EXPECT_EQ(answer.status, WEFT_OK) << answer.message;
    return answer.get<Visibility>().value();
  }

  std::vector<std::unique_ptr<PluginUnderTest>> passes{};  ///< their results live as long
};

TEST(CoarseLook, ConfirmsAFineMeshThatHasFewerMatchesThanVertices) {
  FineSheet sheet;
  std::cout << "seed " << kFineSheetSeed << "\n";
  weft::Rng rng(kFineSheetSeed);
  const auto matches =
      weft::testing::draw_matches(sheet.templ, sheet.camera, sheet.flat_m, {300}, rng).matches;
  const Visibility fine = sheet.look(sheet.flat_m, "{}", &matches);
  const Visibility coarse = sheet.look(sheet.flat_m, "{vertices: 60}", &matches);
  const auto seen = [](const Visibility& visibility) {
    return std::count(visibility.visible.data(),
                      visibility.visible.data() + visibility.visible.rows(), 1);
  };
  EXPECT_LT(seen(fine), 61 * 37 / 2);
  EXPECT_EQ(seen(coarse), 61 * 37);
  EXPECT_NEAR(coarse.diag.value("coarse_vertices", 0.0), 60.0, 9.0);
}

TEST(CoarseLook, HidesWhatTheFineMeshHidesToWithinACell) {
  FineSheet sheet;
  const Visibility fine = sheet.look(sheet.folded_m, "{}");
  const Visibility coarse = sheet.look(sheet.folded_m, "{vertices: 150}");
  int differ = 0, hidden = 0;
  for (std::int64_t v = 0; v < fine.visible.rows(); ++v) {
    differ += fine.visible(v) != coarse.visible(v) ? 1 : 0;
    hidden += fine.visible(v) == 0 ? 1 : 0;
  }
  std::cout << hidden << " hidden, " << differ << " told otherwise by the coarse mesh\n";
  EXPECT_GT(hidden, 300);
  EXPECT_LT(differ, 61 * 37 / 12);
}

TEST(CoarseLook, LeavesAMeshThatIsNoFinerAsItIs) {
  FineSheet sheet;
  const Visibility fine = sheet.look(sheet.folded_m, "{}");
  const Visibility same = sheet.look(sheet.folded_m, "{vertices: 2257}");
  for (std::int64_t v = 0; v < fine.visible.rows(); ++v) {
    EXPECT_EQ(fine.visible(v), same.visible(v));
    EXPECT_EQ(fine.score(v), same.score(v));
  }
}

}  // namespace
