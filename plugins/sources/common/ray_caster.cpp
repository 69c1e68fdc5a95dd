// SPDX-License-Identifier: Apache-2.0
#include "common/ray_caster.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <weft/core/stop_check.hpp>

namespace weft::sources {
namespace {

constexpr float kNearest = 0.01F;
constexpr std::size_t kTogether = 64;  // rays in a call: a tile of pixels

RTCRay ray_along(const Eigen::Vector3f& direction, float end) {
  RTCRay ray{};
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tnear = kNearest;
  ray.tfar = end;
  ray.mask = ~0U;
  return ray;
}

RTCIntersectContext coherent_context() {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

}  // namespace

struct RayCaster::Scene {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  Scene() = default;
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  ~Scene() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  void attach(const TriangleMesh& mesh, unsigned id) const {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    const auto vertices = static_cast<std::size_t>(mesh.vertices_m.rows());
    const auto faces = static_cast<std::size_t>(mesh.faces.rows());
    auto* xyz = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), faces));
    std::transform(mesh.vertices_m.data(), mesh.vertices_m.data() + mesh.vertices_m.size(), xyz,
                   [](double value) { return static_cast<float>(value); });
    std::transform(mesh.faces.data(), mesh.faces.data() + mesh.faces.size(), indices,
                   [](std::int32_t value) { return static_cast<unsigned>(value); });
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);  // the scene keeps it
  }
};

RayCaster::RayCaster(std::unique_ptr<Scene> scene) : scene_(std::move(scene)) {}
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;
RayCaster::~RayCaster() = default;

Result<RayCaster> RayCaster::create() {
  auto scene = std::make_unique<Scene>();
  scene->device = rtcNewDevice("threads=1");
  if (scene->device == nullptr) {
    return Error{Errc::unsupported,
                 "Embree cannot be started on this machine (error " +
                     std::to_string(rtcGetDeviceError(nullptr)) + ")",
                 {}};
  }
  return RayCaster(std::move(scene));
}

void RayCaster::set_meshes(std::span<const TriangleMesh* const> meshes) {
  if (scene_->scene != nullptr) rtcReleaseScene(scene_->scene);
  scene_->scene = rtcNewScene(scene_->device);
  rtcSetSceneFlags(scene_->scene, RTC_SCENE_FLAG_ROBUST);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    scene_->attach(*meshes[i], static_cast<unsigned>(i));
  }
  rtcCommitScene(scene_->scene);
}

std::vector<RayHit> RayCaster::trace(std::span<const Eigen::Vector3f> directions) const {
  std::vector<RayHit> hits(directions.size());
  std::array<RTCRayHit, kTogether> rays;
  RTCIntersectContext context = coherent_context();
  for (std::size_t first = 0; first < directions.size(); first += kTogether) {
    const std::size_t count = std::min(kTogether, directions.size() - first);
    for (std::size_t k = 0; k < count; ++k) {
      rays[k].ray = ray_along(directions[first + k], std::numeric_limits<float>::infinity());
      rays[k].hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rays[k].hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect1M(scene_->scene, &context, rays.data(), static_cast<unsigned>(count),
                   sizeof(RTCRayHit));
    for (std::size_t k = 0; k < count; ++k) {
      const RTCHit& hit = rays[k].hit;
      if (hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
      hits[first + k] = {static_cast<std::int32_t>(hit.geomID),
                         static_cast<std::int32_t>(hit.primID)};
    }
  }
  return hits;
}

std::vector<std::uint8_t> RayCaster::are_hidden(const Points3View& points_m, double slack_m) const {
  std::vector<std::uint8_t> hidden(static_cast<std::size_t>(points_m.rows()));
  RTCIntersectContext context = coherent_context();
  for (Eigen::Index i = 0; i < points_m.rows(); ++i) {
    worked(50);
    const Eigen::Vector3d point = points_m.row(i).transpose();
    const double end = 1.0 - slack_m / std::max(point.norm(), slack_m);
    RTCRay ray = ray_along(point.cast<float>(), static_cast<float>(end));
    rtcOccluded1(scene_->scene, &context, &ray);
    hidden[static_cast<std::size_t>(i)] = ray.tfar < 0.0F ? 1 : 0;
  }
  return hidden;
}

}  // namespace weft::sources
