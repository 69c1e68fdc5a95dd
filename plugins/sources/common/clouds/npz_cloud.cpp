// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/npy.hpp>

#include "common/clouds/cloud_file.hpp"
#include "common/npz_file.hpp"

namespace weft::sources {
namespace {

constexpr std::string_view kPointsMember = "points.npy", kFacesMember = "faces.npy";

bool is_of_cloud(std::string_view name) { return name == kPointsMember || name == kFacesMember; }

template <class T>
T element_at(const std::string& bytes, std::size_t offset, std::size_t i) {
  T value;
  std::memcpy(&value, bytes.data() + offset + i * sizeof(T), sizeof(T));
  return value;
}

/// [rows, 3] of numbers of one of two types, as the wider one.
template <class Wide, class Narrow>
Result<std::vector<std::array<Wide, 3>>> triples_of(const ArchiveMember& member,
                                                    const std::string& path) {
  const auto wrong = [&](const std::string& sentence) {
    return Error{Errc::invalid_data, path + ": " + member.name + " " + sentence, {}};
  };
  const auto header = parse_npy(member.bytes);
  if (!header) {
    return wrong(header.error().message +
                 " in C order: save it with np.savez(file, points=np.ascontiguousarray(points))");
  }
  const bool wide = header->dtype == dtype_of<Wide>();
  if (!wide && header->dtype != dtype_of<Narrow>()) {
    return wrong(std::string("has elements of type ") + dtype_name(header->dtype) + " where " +
                 dtype_name(dtype_of<Wide>()) + " or " + dtype_name(dtype_of<Narrow>()) +
                 " is expected: convert it");
  }
  if (header->shape.size() != 2 || header->shape[1] != 3) {
    return wrong("must have the shape [N, 3]: reshape it");
  }
  std::vector<std::array<Wide, 3>> rows(to_index(header->shape[0]));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    worked_in_loop(static_cast<std::int64_t>(i));
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = 3 * i + k;
      rows[i][k] = wide ? element_at<Wide>(member.bytes, header->data_offset, at)
                        : Wide{element_at<Narrow>(member.bytes, header->data_offset, at)};
    }
  }
  return rows;
}

}  // namespace

Result<std::optional<Cloud>> read_npz_cloud(const std::string& path, double unit_m) {
  const auto members = read_npz_file(path, &is_of_cloud);
  if (!members) return members.error();
  const auto find = [&](std::string_view name) {
    const ArchiveMember* found = nullptr;
    for (const ArchiveMember& member : *members) {
      if (member.name == name) found = &member;
    }
    return found;
  };
  const ArchiveMember* points = find(kPointsMember);
  if (points == nullptr) return std::optional<Cloud>();
  const auto wrong = [&](std::string_view array, std::size_t i, const std::string& sentence) {
    return Error{Errc::invalid_data,
                 path + ": " + std::string(array) + ", row " + std::to_string(i) + ": " + sentence,
                 {}};
  };
  const auto rows = triples_of<double, float>(*points, path);
  if (!rows) return rows.error();
  if (rows->empty()) return no_points(path);
  Cloud cloud;
  for (const auto& row : *rows) {
    cloud.points_m.emplace_back(unit_m * row[0], unit_m * row[1], unit_m * row[2]);
    const auto mistake = mistake_in_point(cloud.points_m.back());
    if (mistake) return wrong(kPointsMember, cloud.points_m.size() - 1, *mistake);
  }
  const ArchiveMember* faces = find(kFacesMember);
  if (faces == nullptr) return std::optional<Cloud>(std::move(cloud));
  const auto triangles = triples_of<std::int64_t, std::int32_t>(*faces, path);
  if (!triangles) return triangles.error();
  for (const auto& corners : *triangles) {
    const auto mistake = mistake_in_face(corners, cloud.points_m.size());
    if (mistake) return wrong(kFacesMember, cloud.faces.size(), *mistake);
    cloud.faces.push_back({static_cast<std::int32_t>(corners[0]),
                           static_cast<std::int32_t>(corners[1]),
                           static_cast<std::int32_t>(corners[2])});
  }
  return std::optional<Cloud>(std::move(cloud));
}

}  // namespace weft::sources
