// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/template_faults.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const Camera kCamera = make_camera();
constexpr SheetSpec kSheet{
    .columns = 15, .rows = 10, .width_m = 0.15, .height_m = 0.1, .width_px = 600, .height_px = 400};

/// A label that bulges towards its viewer: an arc of a cylinder of this radius.
Template label(double radius_m = 0.07) {
  Template templ = make_template(kSheet);
  for (std::int64_t v = 0; v < templ.vertices_m.rows(); ++v) {
    const double turn = (templ.vertices_m(v, 0) - 0.5 * kSheet.width_m) / radius_m;
    templ.vertices_m(v, 0) = radius_m * std::sin(turn);
    templ.vertices_m(v, 2) = -radius_m * std::cos(turn);
  }
  return templ;
}

/// All vertices before the camera, leaning to the right and a little back.
RigidAlignment usual_pose() {
  RigidAlignment pose;
  pose.rotation = (Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.translation << -0.01, 0.0, 0.4;
  return pose;
}

/// `count` places sampled on the mesh, as the camera sees them with noise of `noise_px`.
Correspondences seen(const Template& templ, const RigidAlignment& pose, double noise_px,
                     std::uint64_t seed, std::int64_t count = 200) {
  Rng rng(seed);
  const auto locator = FaceLocator::create(templ.flat_px.matrix<2>(), templ.faces.matrix<3>());
  Correspondences matches;
  matches.template_px = Array<double>({count, 2});
  matches.image_px = Array<double>({count, 2});
  matches.kept = Array<std::uint8_t>({count}, 1);
  for (std::int64_t i = 0; i < count; ++i) {
    const Eigen::Vector2d at(rng.uniform(5.0, 594.0), rng.uniform(5.0, 394.0));
    const FaceLocation on = locator->locate(at);
    Eigen::RowVector3d place = Eigen::RowVector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      place += on.weights(k) * templ.vertices_m.matrix<3>().row(templ.faces(on.face, k));
    }
    const Eigen::Vector2d pixel =
        project({kCamera.fx, kCamera.fy, kCamera.cx, kCamera.cy}, pose(place.transpose()));
    for (int k = 0; k < 2; ++k) {
      matches.template_px(i, k) = at(k);
      matches.image_px(i, k) = pixel(k) + noise_px * rng.normal();
    }
  }
  return matches;
}

FirstLook look(const Template& templ, const Correspondences& matches) {
  return {matches.count(), 0, 250.0, fit_flipped(templ, kCamera, matches)};
}

/// The object with texture coordinates that were turned left to right or upside down on their way.
Template turned(const Template& templ, bool u, bool v) {
  Template result = templ;
  result.flat_px = Array<double>({templ.flat_px.rows(), 2});
  for (std::int64_t i = 0; i < templ.flat_px.rows(); ++i) {
    result.flat_px(i, 0) = u ? 599.0 - templ.flat_px(i, 0) : templ.flat_px(i, 0);
    result.flat_px(i, 1) = v ? 399.0 - templ.flat_px(i, 1) : templ.flat_px(i, 1);
  }
  return result;
}

TEST(RestPose, FindsThePoseOfCurvedAndFlatObjectsThatLean) {
  for (const Template& templ : {label(), make_template(kSheet)}) {
    for (const double lean_rad : {-0.7, -0.2, 0.3, 0.7}) {
      RigidAlignment pose;
      pose.rotation = (Eigen::AngleAxisd(lean_rad, Eigen::Vector3d::UnitY()) *
                       Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ()))
                          .toRotationMatrix();
      const Points3 points_m = templ.vertices_m.matrix<3>();
      const Eigen::Vector3d middle = points_m.colwise().mean();
      pose.translation = Eigen::Vector3d(0.01, -0.02, 0.5) - pose.rotation * middle;
      const Pinhole camera{kCamera.fx, kCamera.fy, kCamera.cx, kCamera.cy};
      const auto found =
          rest_pose(camera, points_m, project_points(camera, transform_points(pose, points_m)));
      ASSERT_TRUE(found) << found.error().message;
      EXPECT_LT(found->median_px, 1e-6) << lean_rad;
      EXPECT_LT((found->camera_from_template.rotation - pose.rotation).norm(), 1e-6) << lean_rad;
    }
  }
}

TEST(RestPose, IsNotMisledByAFewWrongMatches) {
  const Template templ = label();
  const Points3 points_m = templ.vertices_m.matrix<3>();
  const Pinhole camera{kCamera.fx, kCamera.fy, kCamera.cx, kCamera.cy};
  Points2 pixels = project_points(camera, transform_points(usual_pose(), points_m));
  for (Eigen::Index i = 0; i < pixels.rows(); i += 10) pixels(i, 0) += 80.0;
  EXPECT_LT(rest_pose(camera, points_m, pixels)->median_px, 0.1);
}

TEST(RestPose, NeedsSixMatches) {
  const auto refused = rest_pose({}, Points3::Random(5, 3), Points2::Random(5, 2));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::no_result);
}

TEST(TemplateFaults, FindNothingInACleanImport) {
  const Template templ = label();
  EXPECT_THAT(faults_of(look(templ, seen(templ, usual_pose(), 0.5, 3))), IsEmpty());
}

TEST(TemplateFaults, TellAMeshMirroredInSpaceFromTurnedCoordinates) {
  Template cone = label();  // wider below: no turn of the coordinates gives it again
  for (std::int64_t v = 0; v < cone.vertices_m.rows(); ++v) {
    const double wider = 1.0 + 4.0 * cone.vertices_m(v, 1);
    cone.vertices_m(v, 0) *= wider;
    cone.vertices_m(v, 2) *= wider;
  }
  for (std::int64_t v = 0; v < cone.vertices_m.rows(); ++v) {
    cone.vertices_m(v, 0) += 3.0 * cone.vertices_m(v, 1) * cone.flat_px(v, 0) * 1e-4;
  }
  const Correspondences matches = seen(cone, usual_pose(), 0.5, 7);
  EXPECT_THAT(faults_of(look(cone, matches)), IsEmpty());
  Template imported = cone;
  imported.vertices_m = Array<double>({cone.vertices_m.rows(), 3});
  for (std::int64_t v = 0; v < cone.vertices_m.rows(); ++v) {
    for (int k = 0; k < 3; ++k) imported.vertices_m(v, k) = cone.vertices_m(v, k);
    imported.vertices_m(v, 1) *= -1.0;
  }
  EXPECT_THAT(faults_of(look(imported, matches)), ElementsAre(HasSubstr("flip: space; set that")));
  EXPECT_THAT(faults_of(look(turned(cone, true, false), matches)),
              ElementsAre(HasSubstr("flip: u; set that")));
}

TEST(TemplateFaults, NameTheTurnOfTextureCoordinatesOfACurvedObject) {
  const Template templ = label();
  const Correspondences matches = seen(templ, usual_pose(), 0.5, 4);
  // A label turned upside down and left to right is itself, turned by half a turn.
  for (const bool in_u : {true, false}) {
    EXPECT_THAT(faults_of(look(turned(templ, in_u, !in_u), matches)),
                ElementsAre(AllOf(HasSubstr("the mesh is mirrored against its image"),
                                  HasSubstr("px with flip: u or v or space, which fit alike"))));
  }
  EXPECT_THAT(faults_of(look(turned(templ, true, true), matches)), IsEmpty());
}

TEST(TemplateFaults, DoNotMindWhichSideOfAFlatSheetIsUp) {
  const Template sheet = make_template(kSheet);
  const Correspondences matches = seen(sheet, usual_pose(), 0.5, 5);
  EXPECT_THAT(faults_of(look(turned(sheet, true, false), matches)), IsEmpty());
}

TEST(TemplateFaults, SayThatCoordinatesDisagreeWhereNoTurnMendsThem) {
  const Template templ = label();
  const Correspondences matches = seen(templ, usual_pose(), 0.5, 6);
  Template wrong = templ;
  wrong.flat_px = Array<double>({templ.flat_px.rows(), 2});
  for (std::int64_t v = 0; v < templ.flat_px.rows(); ++v) {
    const double share = templ.flat_px(v, 0) / 599.0;
    wrong.flat_px(v, 0) = 599.0 * share * share;  // compressed on the left
    wrong.flat_px(v, 1) = templ.flat_px(v, 1);
  }
  EXPECT_THAT(faults_of(look(wrong, matches)),
              ElementsAre(HasSubstr("the texture coordinates disagree with the mesh")));
}

TEST(TemplateFaults, NameAMirroredPictureByItsMatches) {
  FirstLook mirrored_picture{7, 160, 250.0, {}};
  EXPECT_THAT(faults_of(mirrored_picture),
              ElementsAre(HasSubstr("7 of its matches are kept, and 160 once it is mirrored")));
  FirstLook unknown{7, 12, 250.0, {}};
  EXPECT_THAT(faults_of(unknown), ElementsAre(HasSubstr("only 7 matches are kept")));
  FirstLook beside{70, 12, 250.0, {}};
  EXPECT_THAT(faults_of(beside), ElementsAre(HasSubstr("lie beside the mesh")));
}

TEST(Mirrored, IsTheSameObjectWhenDoneTwiceAndALegalOneBetween) {
  Template templ = label();
  templ.texture.row(3)[7] = 200;
  const Template once = mirrored(templ), twice = mirrored(once);
  EXPECT_EQ(once.texture.row(3)[600 - 1 - 7], 200);
  EXPECT_TRUE(std::equal(templ.texture.data(), templ.texture.data() + templ.texture.size(),
                         twice.texture.data()));
  EXPECT_LT((twice.flat_px.matrix<2>() - templ.flat_px.matrix<2>()).norm(), 1e-9);
  EXPECT_EQ(twice.faces.matrix<3>(), templ.faces.matrix<3>());
  EXPECT_TRUE(validate_flat_mesh(once.flat_px.matrix<2>(), once.faces.matrix<3>()));
}

}  // namespace
}  // namespace weft::testing
