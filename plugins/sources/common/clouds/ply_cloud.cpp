// SPDX-License-Identifier: Apache-2.0
#include <weft/core/index.hpp>
#include <weft/core/text_file.hpp>

#include "common/clouds/cloud_file.hpp"
#include "common/ply/ply_reader.hpp"

namespace weft::sources {
namespace {

using ply::PlyElement;
using ply::PlyRow;

class PlyCloud {
 public:
  PlyCloud(const std::string& path, std::string_view text, double unit_m)
      : path_(path), unit_m_(unit_m), reader_(path, text) {}

  Result<Cloud> read() {
    if (auto header = reader_.read_header(ply::PlyUse::cloud); !header) return header.error();
    const auto read = reader_.for_each_row(
        [&](const PlyElement& element, std::int64_t i, const PlyRow& row) -> Result<void> {
          if (element.name == "vertex") return take_point(element, i, row);
          if (element.name == "face") return take_face(element, i, row);
          return {};
        });
    if (!read) return read.error();
    if (cloud_.points_m.empty()) return no_points(path_);
    return std::move(cloud_);
  }

 private:
  Result<void> take_point(const PlyElement& element, std::int64_t i, const PlyRow& row) {
    Eigen::Vector3d point;
    for (const auto& [k, name] : {std::pair{0, "x"}, std::pair{1, "y"}, std::pair{2, "z"}}) {
      point[k] = unit_m_ * ply::number_at(row, element.find({name}));
    }
    if (const auto wrong = mistake_in_point(point)) return reader_.mistake(element, i, *wrong);
    cloud_.points_m.push_back(point);
    return {};
  }

  /// Faces may precede their points, which the message of an error in them then states.
  Result<void> take_face(const PlyElement& element, std::int64_t i, const PlyRow& row) {
    const std::vector<double>& indices = row[to_index(element.corners())];
    if (indices.size() < 3) return reader_.mistake(element, i, "a face needs 3 corners: remove it");
    const auto corner = [&](std::size_t k) {
      const bool legal = indices[k] >= 0.0 && indices[k] < 2147483648.0;  // false for NaN
      return legal ? static_cast<std::int64_t>(indices[k]) : -1;
    };
    for (std::size_t k = 2; k < indices.size(); ++k) {
      const std::array corners{corner(0), corner(k - 1), corner(k)};
      if (const auto wrong = mistake_in_face(corners, cloud_.points_m.size())) {
        return reader_.mistake(element, i, *wrong);
      }
      cloud_.faces.push_back({static_cast<std::int32_t>(corners[0]),
                              static_cast<std::int32_t>(corners[1]),
                              static_cast<std::int32_t>(corners[2])});
    }
    return {};
  }

  std::string path_;
  double unit_m_;
  ply::PlyReader reader_;
  Cloud cloud_;
};

}  // namespace

Result<Cloud> read_ply_cloud(const std::string& path, double unit_m) {
  constexpr std::uint64_t kMostCloudBytes = 1U << 30U;
  const auto text = read_text_file(path, kMostCloudBytes);
  if (!text) {
    return Error{text.error().code, path + ": cannot be read: " + text.error().message};
  }
  if (!ply::is_ply(*text)) {
    return Error{Errc::invalid_data,
                 path + ": is no PLY file: its first line is not 'ply'; export it again"};
  }
  return PlyCloud(path, *text, unit_m).read();
}

}  // namespace weft::sources
