// SPDX-License-Identifier: Apache-2.0
#include "ray_scene.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <weft/core/stop_check.hpp>

namespace weft::self_occlusion {
namespace {

constexpr float kNearest = 1e-4F;      // share of the way to the point
constexpr std::size_t kTogether = 64;  // rays in a call; neighbours in a mesh take similar ways

RTCRay ray_to(const Points3View& points_m, Eigen::Index point, double slack_m) {
  const Eigen::Vector3d target_m = points_m.row(point);
  RTCRay ray{};
  ray.dir_x = static_cast<float>(target_m.x());
  ray.dir_y = static_cast<float>(target_m.y());
  ray.dir_z = static_cast<float>(target_m.z());
  ray.tnear = kNearest;
  ray.tfar = static_cast<float>(1.0 - slack_m / std::max(target_m.norm(), slack_m));
  ray.mask = ~0U;
  return ray;
}

}  // namespace

struct RayScene::Handles {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  Handles() = default;
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;
  ~Handles() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

RayScene::RayScene(std::unique_ptr<Handles> handles) : handles_(std::move(handles)) {}
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;

Result<RayScene> RayScene::create() {
  auto handles = std::make_unique<Handles>();
  handles->device = rtcNewDevice("threads=1");
  if (handles->device == nullptr) {
    return Error{Errc::unsupported,
                 "Embree cannot be started on this machine (error " +
                     std::to_string(rtcGetDeviceError(nullptr)) + ")",
                 {}};
  }
  return RayScene(std::move(handles));
}

void RayScene::set_mesh(const Points3View& vertices_m, const FacesView& faces) {
  RTCGeometry geometry = rtcNewGeometry(handles_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* xyz = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              3 * sizeof(float), static_cast<std::size_t>(vertices_m.rows())));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(unsigned), static_cast<std::size_t>(faces.rows())));
  for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
    for (int k = 0; k < 3; ++k) *xyz++ = static_cast<float>(vertices_m(v, k));
  }
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) *indices++ = static_cast<unsigned>(faces(f, k));
  }
  // The mesh lives for one frame: a tree that is built fast pays better than one that is fast.
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_LOW);
  rtcCommitGeometry(geometry);
  if (handles_->scene != nullptr) rtcReleaseScene(handles_->scene);
  handles_->scene = rtcNewScene(handles_->device);
  rtcSetSceneFlags(handles_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(handles_->scene, RTC_BUILD_QUALITY_LOW);
  rtcAttachGeometryByID(handles_->scene, geometry, 0);
  rtcReleaseGeometry(geometry);  // the scene keeps it
  rtcCommitScene(handles_->scene);
}

std::vector<std::uint8_t> RayScene::are_hidden(const Points3View& points_m, double slack_m) const {
  const auto count = static_cast<std::size_t>(points_m.rows());
  std::vector<std::uint8_t> hidden(count);
  std::array<RTCRay, kTogether> rays;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (std::size_t first = 0; first < count; first += kTogether) {
    const std::size_t some = std::min(kTogether, count - first);
    worked(40 * static_cast<std::int64_t>(some));
    for (std::size_t k = 0; k < some; ++k) {
      rays[k] = ray_to(points_m, static_cast<Eigen::Index>(first + k), slack_m);
    }
    rtcOccluded1M(handles_->scene, &context, rays.data(), static_cast<unsigned>(some),
                  sizeof(RTCRay));
    for (std::size_t k = 0; k < some; ++k) hidden[first + k] = rays[k].tfar < 0.0F ? 1 : 0;
  }
  return hidden;
}

}  // namespace weft::self_occlusion
