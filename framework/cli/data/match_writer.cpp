// SPDX-License-Identifier: Apache-2.0
#include "cli/data/match_writer.hpp"

#include <fmt/core.h>

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <functional>
#include <vector>
#include <weft/core/whole_file.hpp>

#include "cli/output/new_file.hpp"
#include "host/records/npz.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

/// The shortest text that reads back as the same number, whatever the locale; empty for NaN.
std::string number(double value) {
  if (std::isnan(value)) return {};
  std::array<char, 32> buffer{};
  const auto [end, code] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end};
}

/// Columns of a CSV file, in its order.
class Columns {
 public:
  template <class T>
  void add(const std::string& name, const Array<T>& values, std::int64_t axis = 0) {
    if (!values.present()) return;
    header_ += (header_.empty() ? "" : ",") + name;
    columns_.push_back([values, axis](std::int64_t row) {
      return number(static_cast<double>(values(row, axis)));
    });
  }

  std::string text(std::int64_t rows) const {
    std::string text = header_ + "\n";
    for (std::int64_t row = 0; row < rows; ++row) {
      for (std::size_t i = 0; i < columns_.size(); ++i) {
        text += (i == 0 ? "" : ",") + columns_[i](row);
      }
      text += '\n';
    }
    return text;
  }

 private:
  std::string header_;
  std::vector<std::function<std::string(std::int64_t)>> columns_;
};

std::string csv_of(const Correspondences& matches, const GroundTruth& own) {
  Columns columns;
  const bool in_metres = matches.template_xy_m.present();
  const Array<double>& places = in_metres ? matches.template_xy_m : matches.template_px;
  columns.add(in_metres ? "template_x_m" : "template_x_px", places, 0);
  columns.add(in_metres ? "template_y_m" : "template_y_px", places, 1);
  columns.add("image_x_px", matches.image_px, 0);
  columns.add("image_y_px", matches.image_px, 1);
  columns.add("label", own.match_label);
  columns.add("true_x_px", own.match_xy_px, 0);
  columns.add("true_y_px", own.match_xy_px, 1);
  columns.add("score", matches.score);
  columns.add("kept", matches.kept);
  columns.add("distance", matches.distance);
  columns.add("ratio", matches.ratio);
  columns.add("scale_ratio", matches.scale_ratio);
  columns.add("angle_difference_rad", matches.angle_difference_rad);
  return columns.text(matches.count());
}

Result<void> make_folder(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (!code) return {};
  return Error{Errc::io, "cannot be created: " + code.message(), folder.string()};
}

}  // namespace

std::string MatchWriter::file(const char* part, std::uint64_t frame,
                              const std::string& extension) const {
  return fmt::format("{}/{}/{:06}.{}", folder_, part, frame, extension);
}

Result<void> MatchWriter::begin(const weft::Camera& camera) {
  if (auto made = make_new_folder(folder_); !made) return made;
  begun_ = true;
  if (auto made = make_folder(folder_ + "/matches"); !made) return made;
  const std::string text = fmt::format(
      "# Pinhole without distortion; pixel centres at integers.\nfx: {}\nfy: {}\ncx: {}\ncy: {}\n"
      "width: {}\nheight: {}\ndistortion: null\n",
      number(camera.fx), number(camera.fy), number(camera.cx), number(camera.cy), camera.width_px,
      camera.height_px);
  return write_whole(text, folder_ + "/camera.yaml");
}

Result<void> MatchWriter::add(std::uint64_t frame, const Correspondences& matches,
                              const std::optional<GroundTruth>& truth) {
  GroundTruth own{Array<double>({0, 2}), Array<double>({0, 3}), truth ? truth->kind : "", ""};
  if (truth) own.match_label = truth->match_label;
  if (truth) own.match_xy_px = truth->match_xy_px;
  const std::string path = file("matches", frame, format_);
  host::NamedRecords records{{"correspondences", host::Record::copy_of(matches)}};
  if (truth) records.emplace_back("ground_truth", host::Record::copy_of(own));
  auto written = format_ == "csv" ? write_whole(csv_of(matches, own), path, Durability::unsynced)
                                  : host::write_npz(path, records, Durability::unsynced);
  if (!written) return written;
  ++frames_;
  matches_ += matches.count();
  if (!truth || truth->count() == 0) return {};
  if (auto made = make_folder(folder_ + "/gt"); !made) return made;
  ++frames_with_points_;
  GroundTruth points = *truth;
  points.match_label = {};
  points.match_xy_px = {};
  return host::write_npz(file("gt", frame, "npz"),
                         {{"ground_truth", host::Record::copy_of(points)}}, Durability::unsynced);
}

void MatchWriter::withdraw() const {
  if (!begun_) return;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder_, ignored)) {
    fs::remove_all(entry.path(), ignored);
  }
  fs::remove(folder_, ignored);
}

Result<void> MatchWriter::end(const std::string& templ, double fps) {
  std::string text =
      "# The beginning of a pipeline: `extends:` this file and add stages.\nweft: 1\nsource:\n"
      "  use: sources/matches\n  params:\n    path: matches/*." +
      format_ + "\n    camera: camera.yaml\n";
  if (frames_with_points_ > 0) text += "    truth: gt/*.npz\n";
  text += "    fps: " + number(fps) + "\n" + templ;
  if (const std::error_code code = sync_file_system(folder_)) {
    return Error{Errc::io, "cannot be written to disk (" + why_not_written(code) + ")", folder_};
  }
  return write_whole(text, folder_ + "/sequence.yaml");
}

}  // namespace weft::cli
