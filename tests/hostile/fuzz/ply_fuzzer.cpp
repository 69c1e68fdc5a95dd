// SPDX-License-Identifier: Apache-2.0
// Meshes and clouds in PLY: refused at a line or element, or legal. A mesh printed as OBJ is the
// same.
#include "common/clouds/cloud_file.hpp"
#include "mesh_checks.hpp"

namespace {

using namespace weft;
using fuzzing::require;

/// "path:LINE: ...", "path: ends in ELEMENT ..." or "path: ELEMENT 12: ..."
void require_reported(const Error& error, const std::string& path, std::string_view text) {
  require(error.code == Errc::invalid_data, "invalid data", error.message);
  require(error.message.starts_with(path + ":"), "the file", error.message);
  if (error.message.substr(path.size()).starts_with(": ")) return;
  fuzzing::require_place(error.message, path, text, false);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzzing::text_of(data, size);
  if (!text.starts_with("ply")) return -1;
  const fuzzing::InputFile input(text);
  if (const auto file = mesh::read_mesh_file(input.path()); file) {
    fuzzing::require_legal(*file);
    fuzzing::require_same_printed(*file);
  } else {
    require_reported(file.error(), input.path(), text);
  }
  const auto cloud = sources::read_ply_cloud(input.path(), 0.001);
  if (!cloud) {
    require_reported(cloud.error(), input.path(), text);
    return 0;
  }
  require(!cloud->points_m.empty(), "a point");
  for (const auto& point : cloud->points_m) {
    require(!sources::mistake_in_point(point), "points before the camera");
  }
  for (const auto& [a, b, c] : cloud->faces) {
    require(!sources::mistake_in_face({a, b, c}, cloud->points_m.size()), "triangles of points");
  }
  return 0;
}
