// SPDX-License-Identifier: Apache-2.0
#include "common/films/packets.hpp"

#include <dlfcn.h>

#include <cctype>
#include <cstdarg>
#include <opencv2/core/utils/logger.hpp>
#include <weft/core/stop_check.hpp>

#include "common/images/jpeg_decoder.hpp"

namespace weft::films {
namespace {

cv::VideoCapture open_packets(const std::string& path) {
  quiet_decoders();
  constexpr double kPackets = -1.0;
  cv::VideoCapture capture(path, cv::CAP_FFMPEG);
  if (!capture.isOpened() || !capture.set(cv::CAP_PROP_FORMAT, kPackets)) capture.release();
  return capture;
}

}  // namespace

void quiet_decoders() {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  // OpenCV sets FFmpeg's level whenever it opens a file, but not what receives the messages. The
  // function is libavutil's, which an OpenCV without FFmpeg does not load.
  using Receiver = void (*)(void*, int, const char*, va_list);
  if (void* const set_receiver = dlsym(RTLD_DEFAULT, "av_log_set_callback");
      set_receiver != nullptr) {
    reinterpret_cast<void (*)(Receiver)>(set_receiver)(nullptr);
  }
}

Packets Packets::of_motion_jpeg(const std::string& path, double fourcc) {
  Packets packets;
  std::string code;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    const auto letter = static_cast<int>(static_cast<std::uint32_t>(fourcc) >> shift & 0xFFU);
    code += static_cast<char>(std::tolower(letter));
  }
  if (code == "mjpg" || code == "mjpe" || code == "jpeg") packets.capture_ = open_packets(path);
  return packets;
}

std::string Packets::damage(std::int64_t number) {
  while (capture_.isOpened() && number_ < number) {
    if (!capture_.grab()) capture_.release();
    ++number_;
  }
  cv::Mat packet;
  if (!capture_.isOpened() || !capture_.retrieve(packet) || packet.empty()) return {};
  const std::string bytes(packet.ptr<char>(), packet.total() * packet.elemSize());
  if (bytes.starts_with("\xFF\xD8")) return image_files::jpeg_damage(bytes);
  return "it does not begin as a JPEG image";
}

std::int64_t count_packets(const std::string& path) {
  std::int64_t count = 0;
  cv::VideoCapture capture = open_packets(path);
  for (; capture.isOpened() && capture.grab(); ++count) worked(1000);
  return count;
}

}  // namespace weft::films
