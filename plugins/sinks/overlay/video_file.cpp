// SPDX-License-Identifier: Apache-2.0
#include "video_file.hpp"

#include <filesystem>
#include <weft/core/whole_file.hpp>

#include "common/images/jpeg_encoder.hpp"

namespace weft::overlay {
namespace {

namespace fs = std::filesystem;

bool is_avi(const std::string& path) { return path.ends_with(".avi"); }

}  // namespace

Result<void> VideoFile::open(const std::string& path, double fps, cv::Size size) {
  path_ = path;
  fps_ = fps;
  size_ = size;
  part_ = 1;
  first_failure_ = {};
  std::error_code status;
  fs::create_directories(fs::path(path).parent_path(), status);  // opening reports why it cannot
  return open_part();
}

Result<void> VideoFile::check_format(const std::string& path) {
  const std::string extension = fs::path(path).extension().string();
  if (extension == ".avi" || extension == ".mkv" || extension == ".mp4") return {};
  return Error{Errc::unsupported,
               "the video " + path + " must end in .avi, .mkv or .mp4, which stay readable when " +
                   "a run is killed: change 'path', and convert the file afterwards"};
}

Result<void> VideoFile::open_part() {
  if (auto legal = check_format(path_); !legal) return legal;
  fs::path path(path_);
  const std::string extension = path.extension().string();
  std::error_code status;
  while (part_ > 1) {
    path.replace_filename(fs::path(path_).stem().string() + "_" + std::to_string(part_) +
                          extension);
    if (!fs::exists(fs::symlink_status(path, status))) break;
    ++part_;
  }
  part_path_ = path.string();
  given_ = 0;
  return is_avi(part_path_) ? avi_.open(part_path_, fps_, size_.width, size_.height)
                            : media_.open(part_path_, fps_, size_);
}

Result<void> VideoFile::write(const cv::Mat& picture) {
  auto written = add(picture);
  if (!written && first_failure_) first_failure_ = written;
  return written;
}

Result<void> VideoFile::add(const cv::Mat& picture) {
  if (avi_.is_open() && avi_.size() >= most_bytes_of_avi_) {
    if (auto closed = close_part(); !closed) return closed;
    ++part_;
    if (auto opened = open_part(); !opened) return opened;
  }
  if (!is_open()) return Error{Errc::io, "the video " + part_path_ + " is not open"};
  auto added = add_encoded(picture);
  if (added) ++given_;
  return added;
}

Result<void> VideoFile::add_encoded(const cv::Mat& picture) {
  if (media_.is_open() && !media_.takes_jpeg()) return media_.add(picture);
  constexpr int kQuality = 95;
  const std::vector<std::uint8_t> jpeg = image_files::encode_jpeg(picture, kQuality);
  if (jpeg.empty()) return Error{Errc::unsupported, "the frame cannot be written as JPEG"};
  return avi_.is_open() ? avi_.add(jpeg) : media_.add(jpeg);
}

Result<void> VideoFile::close_part() {
  if (!is_open()) return {};
  if (auto closed = avi_.is_open() ? avi_.close() : media_.close(); !closed) return closed;
  const std::int64_t found = MediaFile::count_images(part_path_);
  if (found != given_) {
    return Error{Errc::io, "the video " + part_path_ + " has " + std::to_string(found) + " of " +
                               std::to_string(given_) + " frames: is the disk full?"};
  }
  if (const std::error_code code = sync_path(part_path_)) {
    return Error{Errc::io, "the video " + part_path_ + " cannot be written to disk (" +
                               why_not_written(code) + "): is the disk full?"};
  }
  return {};
}

Result<void> VideoFile::close() {
  auto closed = close_part();
  return first_failure_ ? closed : first_failure_;
}

}  // namespace weft::overlay
