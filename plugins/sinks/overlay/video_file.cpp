// SPDX-License-Identifier: Apache-2.0
#include "video_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace weft::overlay {
namespace {

/// Makes an empty file, so that the system can say what is wrong; OpenCV does not.
Result<void> check_writable(const std::filesystem::path& path) {
  std::error_code status;
  std::filesystem::create_directories(path.parent_path(), status);
  errno = 0;
  if (std::ofstream(path, std::ios::binary)) return {};
  const char* reason = errno != 0 ? std::strerror(errno) : "unknown reason";
  return Error{Errc::io,
               "the video " + path.string() + " cannot be written (" + reason +
                   "): choose another 'path' or make its folder writable",
               {}};
}

}  // namespace

Result<void> VideoFile::open(const std::string& path, double fps, cv::Size size) {
  path_ = path;
  fps_ = fps;
  size_ = size;
  part_ = 1;
  return open_part();
}

Result<void> VideoFile::open_part() {
  std::filesystem::path path(path_);
  const std::string extension = path.extension().string();
  if (extension != ".avi" && extension != ".mkv") {
    return Error{Errc::unsupported,
                 "the video " + path_ + " must end in .avi or .mkv, which stay readable when a " +
                     "run is killed: change 'path', and convert the file afterwards",
                 {}};
  }
  if (part_ > 1) {
    path.replace_filename(path.stem().string() + "_" + std::to_string(part_) + extension);
  }
  part_path_ = path.string();
  if (auto writable = check_writable(path); !writable) return writable.error();
  const int writer = extension == ".avi" ? cv::CAP_OPENCV_MJPEG : cv::CAP_FFMPEG;
  try {
    writer_.open(part_path_, writer, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), fps_, size_);
  } catch (const cv::Exception&) {
    writer_.release();
  }
  if (writer_.isOpened()) return {};
  return Error{Errc::unsupported,
               "OpenCV cannot write the video " + part_path_ +
                   (extension == ".mkv" ? ": it was built without FFmpeg; use .avi"
                                        : " with its MJPEG writer; use .mkv"),
               {}};
}

Result<void> VideoFile::write(const cv::Mat& picture) {
  if (part_is_full()) {
    writer_.release();
    ++part_;
    if (auto opened = open_part(); !opened) return opened;
  }
  writer_.write(picture);
  return {};
}

bool VideoFile::part_is_full() const {
  std::error_code status;
  return part_path_.ends_with(".avi") &&
         std::filesystem::file_size(part_path_, status) >= most_bytes_of_avi_ && !status;
}

}  // namespace weft::overlay
