// SPDX-License-Identifier: Apache-2.0
#include "common/scene/ray_caster.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::scene {
namespace {

constexpr float kNearestSeen = 0.01F;
constexpr float kNearestHiding = 1e-4F;  // share of the way to the point
constexpr std::size_t kTogether = 64;    // rays in a call: neighbours take similar ways

RTCRay ray_along(const Eigen::Vector3f& direction, float nearest, float end) {
  RTCRay ray{};
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tnear = nearest;
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

  void begin(RTCBuildQuality quality) {
    if (scene != nullptr) rtcReleaseScene(scene);
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, quality);
  }

  void attach(const Points3View& vertices_m, const FacesView& faces, unsigned id,
              RTCBuildQuality quality) const {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* xyz = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                            RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                            to_index(vertices_m.rows())));
    auto* indices = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), to_index(faces.rows())));
    for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
      for (int k = 0; k < 3; ++k) *xyz++ = static_cast<float>(vertices_m(v, k));
    }
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
      for (int k = 0; k < 3; ++k) *indices++ = static_cast<unsigned>(faces(f, k));
    }
    rtcSetGeometryBuildQuality(geometry, quality);
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
    return Error{Errc::unsupported, "Embree cannot be started on this machine (error " +
                                        std::to_string(rtcGetDeviceError(nullptr)) + ")"};
  }
  return RayCaster(std::move(scene));
}

void RayCaster::set_mesh(const Points3View& vertices_m, const FacesView& faces) {
  scene_->begin(RTC_BUILD_QUALITY_LOW);
  scene_->attach(vertices_m, faces, 0, RTC_BUILD_QUALITY_LOW);
  rtcCommitScene(scene_->scene);
}

void RayCaster::set_meshes(std::span<const TriangleMesh* const> meshes) {
  scene_->begin(RTC_BUILD_QUALITY_LOW);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    scene_->attach(meshes[i]->vertices_m, meshes[i]->faces, static_cast<unsigned>(i),
                   RTC_BUILD_QUALITY_LOW);
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
      rays[k].ray =
          ray_along(directions[first + k], kNearestSeen, std::numeric_limits<float>::infinity());
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
  const auto count = to_index(points_m.rows());
  std::vector<std::uint8_t> hidden(count);
  std::array<RTCRay, kTogether> rays;
  RTCIntersectContext context = coherent_context();
  for (std::size_t first = 0; first < count; first += kTogether) {
    const std::size_t some = std::min(kTogether, count - first);
    worked(40 * static_cast<std::int64_t>(some));
    for (std::size_t k = 0; k < some; ++k) {
      const Eigen::Vector3d point = points_m.row(static_cast<Eigen::Index>(first + k));
      const double end = 1.0 - slack_m / std::max(point.norm(), slack_m);
      rays[k] = ray_along(point.cast<float>(), kNearestHiding, static_cast<float>(end));
    }
    rtcOccluded1M(scene_->scene, &context, rays.data(), static_cast<unsigned>(some),
                  sizeof(RTCRay));
    for (std::size_t k = 0; k < some; ++k) hidden[first + k] = rays[k].tfar < 0.0F ? 1 : 0;
  }
  return hidden;
}

}  // namespace weft::scene
