// SPDX-License-Identifier: Apache-2.0
#include "video_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <weft/core/whole_file.hpp>

#include "common/films/packets.hpp"

namespace weft::overlay {
namespace {

namespace fs = std::filesystem;

bool is_avi(const std::string& path) { return path.ends_with(".avi"); }

/// Makes an empty file, so that the system can report an error; FFmpeg does not.
Result<void> check_writable(const std::string& path) {
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC;
  const int file = ::open(path.c_str(), kFlags, 0666);
  if (file >= 0) {
    ::close(file);
    return {};
  }
  const std::error_code code = last_system_error();
  return Error{Errc::io, "the video " + path + " cannot be written (" + why_not_written(code) +
                             "): choose another 'path' or make its folder writable"};
}

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
  if (extension == ".avi" || extension == ".mkv") return {};
  return Error{Errc::unsupported,
               "the video " + path + " must end in .avi or .mkv, which stay readable when a " +
                   "run is killed: change 'path', and convert the file afterwards"};
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
  return is_avi(part_path_) ? avi_.open(part_path_, fps_, size_.width, size_.height) : open_mkv();
}

Result<void> VideoFile::open_mkv() {
  if (auto writable = check_writable(part_path_); !writable) return writable;
  try {
    writer_.open(part_path_, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), fps_,
                 size_);
  } catch (const cv::Exception&) {
    writer_.release();
  }
  if (writer_.isOpened()) return {};
  return Error{Errc::unsupported, "OpenCV cannot write the video " + part_path_ +
                                      ": it was built without FFmpeg; use .avi"};
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
  if (!avi_.is_open()) {
    writer_.write(picture);
    ++given_;
    return {};
  }
  std::vector<std::uint8_t> jpeg;
  constexpr int kQuality = 95;
  if (!cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality})) {
    return Error{Errc::unsupported, "OpenCV cannot write the frame as JPEG"};
  }
  if (auto added = avi_.add(jpeg); !added) return added;
  ++given_;
  return {};
}

Result<void> VideoFile::close_part() {
  if (!is_open()) return {};
  auto closed = avi_.close();
  writer_.release();
  if (!closed) return closed;
  const std::int64_t found = films::count_packets(part_path_);
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
