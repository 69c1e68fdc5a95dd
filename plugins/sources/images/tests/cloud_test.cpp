// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cstring>
#include <weft/data/ground_truth.hpp>

#include "common/tests/npz_archive.hpp"
#include "images_source.hpp"

namespace weft::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A triangle in front of the camera and a fourth point, which every format can express.
constexpr double kCloudPoints[4][3] = {
    {0.01, 0.02, 0.5}, {0.25, -0.125, 0.625}, {-0.5, 0.75, 1.5}, {0.0, 0.0, 0.375}};

const std::string kPlyStart =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty "
    "double z\nproperty uchar red\n";
const std::string kPlyPoints =
    "0.01 0.02 0.5 7\n0.25 -0.125 0.625 7\n-0.5 0.75 1.5 7\n0 0 0.375 7\n";

std::string ply_mesh() {
  return kPlyStart + "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
         kPlyPoints + "3 0 1 2\n";
}

/// The same points as binary floats of PLY, without faces.
std::string binary_ply() {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float "
      "y\nproperty float z\nend_header\n";
  for (const auto& point : kCloudPoints) {
    for (const double value : point) {
      const auto rounded = static_cast<float>(value);
      char bytes[sizeof rounded];
      std::memcpy(bytes, &rounded, sizeof rounded);
      text.append(bytes, sizeof rounded);
    }
  }
  return text;
}

template <class T>
Array<T> points_as(double factor = 1.0) {
  Array<T> points({4, 3});
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 3; ++k) points(i, k) = static_cast<T>(factor * kCloudPoints[i][k]);
  }
  return points;
}

template <class T>
Array<T> face_of(T a, T b, T c) {
  Array<T> face({1, 3});
  face(0, 0) = a, face(0, 1) = b, face(0, 2) = c;
  return face;
}

/// Two frames; files of truth belong to the second, `b`.
class CloudFolder : public FrameFolder {
 public:
  CloudFolder() {
    write_camera();
    for (const char* name : {"frames/a.png", "frames/b.png"}) write_frame(name);
    write("gt/.keep", "");
  }

  PluginUnderTest source(const std::string& more = "") const {
    return images_source(*this, "frames/*.png", "truth: '" + path("gt/*") + "'" + more);
  }

  PluginAnswer read(const std::string& more = "") const {
    auto images = source(more);
    const PluginAnswer opened = images.process(kOpen, {});
    if (opened.status != WEFT_OK) return opened;
    EXPECT_EQ(images.process(kRead, {}, 0).status, WEFT_OK);
    return images.process(kRead, {}, 1);
  }

  std::string refusal(const std::string& name, const std::string& bytes) const {
    write(name, bytes);
    const PluginAnswer answer = read();
    EXPECT_EQ(answer.status, WEFT_ERROR);
    return answer.message;
  }
};

void expect_cloud(const PluginAnswer& answer, bool faces, double tolerance = 1e-15) {
  ASSERT_EQ(answer.status, WEFT_OK) << answer.message;
  const auto truth = answer.get<GroundTruth>();
  ASSERT_TRUE(truth.has_value());
  EXPECT_EQ(truth->count(), 0);
  ASSERT_TRUE(truth->cloud_m.present());
  ASSERT_EQ(truth->cloud_m.rows(), 4);
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(truth->cloud_m(i, k), kCloudPoints[i][k], tolerance);
  }
  ASSERT_EQ(truth->cloud_faces.present(), faces);
  if (!faces) return;
  ASSERT_EQ(truth->cloud_faces.rows(), 1);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(truth->cloud_faces(0, k), k);
}

TEST(Clouds, AreReadFromPlyWithTheirFaces) {
  const CloudFolder folder;
  folder.write("gt/b_scan.ply", ply_mesh());
  const PluginAnswer read = folder.read();
  expect_cloud(read, true);
  EXPECT_EQ(read.get<GroundTruth>()->kind, "scan");
}

TEST(Clouds, AreReadFromBinaryPlyWithoutFaces) {
  const CloudFolder folder;
  folder.write("gt/b.ply", binary_ply());
  const PluginAnswer read = folder.read();
  expect_cloud(read, false, 1e-7);
  EXPECT_EQ(read.get<GroundTruth>()->kind, "cloud");
}

TEST(Clouds, AreReadFromCsvInMetresAndInMillimetres) {
  const CloudFolder folder;
  folder.write("gt/b.csv",
               "Z_m, X_m,Y_m\r\n0.5,0.01,0.02\r\n.625,.25,-.125\n1.5,-0.5,0.75\n\n"
               "0.375,0,0\n");
  expect_cloud(folder.read(), false);
  folder.write("gt/b.csv", "X_mm,Y_mm,Z_mm\n10,20,500\n250,-125,625\n-500,750,1500\n0,0,375\n");
  expect_cloud(folder.read(), false);
}

TEST(Clouds, AreReadFromNumpysArrays) {
  const CloudFolder folder;
  write_archive(folder.path("gt/b.npz"), {{"points.npy", npy(points_as<double>())},
                                          {"faces.npy", npy(face_of<std::int64_t>(0, 1, 2))},
                                          {"colours.npy", npy(points_as<float>())}});
  expect_cloud(folder.read(), true);
  write_archive(folder.path("gt/b.npz"), {{"points.npy", npy(points_as<float>())},
                                          {"faces.npy", npy(face_of<std::int32_t>(0, 1, 2))}});
  expect_cloud(folder.read(), true, 1e-7);
}

TEST(Clouds, HaveTheUnitThatIsGiven) {
  const CloudFolder folder;
  write_archive(folder.path("gt/b.npz"), {{"points.npy", npy(points_as<double>(1000.0))}});
  expect_cloud(folder.read(", truth_unit_m: 0.001"), false);
}

TEST(Clouds, RefuseWhatIsNoPointBeforeTheCamera) {
  const CloudFolder ply, csv, npz, behind;
  EXPECT_THAT(
      ply.refusal("gt/b.ply", kPlyStart + "end_header\n0 0 1 7\n0 nan 1 7\n0 0 1 7\n0 0 1 7\n"),
      AllOf(HasSubstr("b.ply:10: "), HasSubstr("three finite numbers"), HasSubstr("remove")));
  EXPECT_THAT(csv.refusal("gt/b.csv", "X_m,Y_m,Z_m\n0,0,1\n0,nan,1\n"),
              HasSubstr("b.csv:3: 'Y_m' must be a finite number, not 'nan'"));
  auto points = points_as<double>();
  points(2, 1) = std::numeric_limits<double>::quiet_NaN();
  write_archive(npz.path("gt/b.npz"), {{"points.npy", npy(points)}});
  EXPECT_THAT(npz.read().message,
              AllOf(HasSubstr("b.npz: points.npy, row 2: "), HasSubstr("three finite numbers")));
  EXPECT_THAT(behind.refusal("gt/b.csv", "X_m,Y_m,Z_m\n0,0,0\n"),
              AllOf(HasSubstr("b.csv:2: z must be positive"), HasSubstr("camera's frame")));
}

TEST(Clouds, RefuseFilesWithoutPoints) {
  const CloudFolder ply, csv, npz;
  EXPECT_THAT(ply.refusal("gt/b.ply",
                          "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\n"
                          "property float y\nproperty float z\nend_header\n"),
              HasSubstr("b.ply: holds no points"));
  EXPECT_THAT(csv.refusal("gt/b.csv", "X_m,Y_m,Z_m\n"), HasSubstr("b.csv: holds no points"));
  write_archive(npz.path("gt/b.npz"), {{"points.npy", npy(Array<double>({0, 3}))}});
  EXPECT_THAT(npz.read().message, HasSubstr("b.npz: holds no points"));
}

TEST(Clouds, RefuseFacesOutOfRange) {
  const CloudFolder ply, npz;
  std::string text = ply_mesh();
  text.replace(text.rfind("0 1 2"), 5, "0 1 4");
  EXPECT_THAT(ply.refusal("gt/b.ply", text),
              HasSubstr("b.ply:15: the face uses point 4, but the file has 4, counted from 0"));
  write_archive(npz.path("gt/b.npz"), {{"points.npy", npy(points_as<double>())},
                                       {"faces.npy", npy(face_of<std::int64_t>(0, -1, 2))}});
  EXPECT_THAT(npz.read().message, HasSubstr("b.npz: faces.npy, row 0: the face uses point -1"));
}

TEST(Clouds, RefuseOtherArraysAndColumns) {
  const CloudFolder flat, integers, csv, other, no_ply;
  write_archive(flat.path("gt/b.npz"), {{"points.npy", npy(Array<double>({12}, 1.0))}});
  EXPECT_THAT(flat.read().message, HasSubstr("points.npy must have the shape [N, 3]"));
  write_archive(integers.path("gt/b.npz"), {{"points.npy", npy(face_of<std::int32_t>(1, 1, 1))}});
  EXPECT_THAT(integers.read().message, HasSubstr("points.npy has elements of type"));
  EXPECT_THAT(csv.refusal("gt/b.csv", "X_m,Y_m,Z_mm\n1,1,1\n"), HasSubstr("'X_mm' is missing"));
  write_archive(other.path("gt/b.npz"), {{"vertices.npy", npy(points_as<double>())}});
  EXPECT_THAT(other.read().message,
              AllOf(HasSubstr("no record 'ground_truth'"), HasSubstr("no array 'points'")));
  EXPECT_THAT(no_ply.refusal("gt/b.ply", "solid\n"), HasSubstr("b.ply: is no PLY file"));
}

TEST(Clouds, RefuseExtensionsThatAreUnknownBeforeAnythingRuns) {
  const CloudFolder folder;
  folder.write("gt/b.obj", "v 0 0 1\n");
  const PluginAnswer opened = folder.source().process(kOpen, {});
  EXPECT_EQ(opened.status, WEFT_ERROR);
  EXPECT_THAT(opened.message, AllOf(HasSubstr("b.obj: the extension '.obj' is unknown"),
                                    HasSubstr(".csv, .npz and .ply")));
}

}  // namespace
}  // namespace weft::testing
