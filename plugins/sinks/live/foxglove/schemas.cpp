// SPDX-License-Identifier: Apache-2.0
// Field names and types of https://github.com/foxglove/foxglove-sdk, schemas/jsonschema.
#include <nlohmann/json.hpp>

#include "foxglove/channels.hpp"

namespace weft::live::foxglove {
namespace {

using nlohmann::ordered_json;

ordered_json of_type(const char* type) { return {{"type", type}}; }
ordered_json number() { return of_type("number"); }
ordered_json integer() { return of_type("integer"); }
ordered_json text() { return of_type("string"); }

ordered_json object(const char* title, ordered_json members) {
  return {{"type", "object"}, {"title", title}, {"properties", std::move(members)}};
}

ordered_json list(ordered_json items) { return {{"type", "array"}, {"items", std::move(items)}}; }

ordered_json time() { return object("time", {{"sec", integer()}, {"nsec", integer()}}); }
ordered_json duration() { return object("duration", {{"sec", integer()}, {"nsec", integer()}}); }

ordered_json triple(const char* title) {
  return object(title, {{"x", number()}, {"y", number()}, {"z", number()}});
}

ordered_json quaternion() {
  return object("foxglove.Quaternion",
                {{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}});
}

ordered_json image() {
  ordered_json bytes = text();
  bytes["contentEncoding"] = "base64";
  return object("foxglove.CompressedImage",
                {{"timestamp", time()}, {"frame_id", text()}, {"data", bytes}, {"format", text()}});
}

ordered_json scene() {
  const ordered_json deletion = object(
      "foxglove.SceneEntityDeletion", {{"timestamp", time()}, {"type", integer()}, {"id", text()}});
  const ordered_json pose = object(
      "foxglove.Pose", {{"position", triple("foxglove.Vector3")}, {"orientation", quaternion()}});
  const ordered_json color = object(
      "foxglove.Color", {{"r", number()}, {"g", number()}, {"b", number()}, {"a", number()}});
  const ordered_json triangles =
      object("foxglove.TriangleListPrimitive", {{"pose", pose},
                                                {"points", list(triple("foxglove.Point3"))},
                                                {"color", color},
                                                {"colors", list(color)},
                                                {"indices", list(integer())}});
  const ordered_json pair = object("foxglove.KeyValuePair", {{"key", text()}, {"value", text()}});
  const ordered_json entity = object("foxglove.SceneEntity", {{"timestamp", time()},
                                                              {"frame_id", text()},
                                                              {"id", text()},
                                                              {"lifetime", duration()},
                                                              {"frame_locked", of_type("boolean")},
                                                              {"metadata", list(pair)},
                                                              {"triangles", list(triangles)}});
  return object("foxglove.SceneUpdate",
                {{"deletions", list(deletion)}, {"entities", list(entity)}});
}

ordered_json camera() {
  return object("foxglove.CameraCalibration", {{"timestamp", time()},
                                               {"frame_id", text()},
                                               {"width", integer()},
                                               {"height", integer()},
                                               {"distortion_model", text()},
                                               {"D", list(number())},
                                               {"K", list(number())},
                                               {"R", list(number())},
                                               {"P", list(number())}});
}

ordered_json transforms() {
  const ordered_json transform =
      object("foxglove.FrameTransform", {{"timestamp", time()},
                                         {"parent_frame_id", text()},
                                         {"child_frame_id", text()},
                                         {"translation", triple("foxglove.Vector3")},
                                         {"rotation", quaternion()}});
  return object("foxglove.FrameTransforms", {{"transforms", list(transform)}});
}

ordered_json report() {
  const ordered_json stage = object("weft.Stage", {{"stage", text()},
                                                   {"status", text()},
                                                   {"reason", text()},
                                                   {"ms", number()},
                                                   {"processor_ms", number()}});
  return object("weft.FrameReport", {{"frame", integer()},
                                     {"state", text()},
                                     {"age", integer()},
                                     {"confidence", number()},
                                     {"std_median_mm", number()},
                                     {"std_worst_mm", number()},
                                     {"stages", list(stage)}});
}

}  // namespace

std::string schema_of(std::string_view name) {
  for (const auto& schema : {image(), scene(), camera(), transforms(), report()}) {
    if (schema["title"] == std::string(name)) return schema.dump();
  }
  return "{}";
}

}  // namespace weft::live::foxglove
