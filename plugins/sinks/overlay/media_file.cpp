// SPDX-License-Identifier: Apache-2.0
#include "media_file.hpp"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/log.h>
#include <libavutil/opt.h>
}

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/core/whole_file.hpp>

namespace weft::overlay {
namespace {

/// Makes an empty file here, since FFmpeg would follow links.
int make_empty(const std::string& path) {
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC;
  const int file = ::open(path.c_str(), kFlags, 0666);
  if (file < 0) return AVERROR(errno);
  ::close(file);
  return 0;
}

}  // namespace

struct MediaFile::State {
  AVFormatContext* format = nullptr;
  AVCodecContext* encoder = nullptr;  // none for JPEG
  AVFrame* frame = av_frame_alloc();
  AVPacket* packet = av_packet_alloc();
  AVRational tick{1, 1};  ///< s between two images
  std::int64_t count = 0;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (format != nullptr) avio_closep(&format->pb);
    avformat_free_context(format);
    avcodec_free_context(&encoder);
    av_frame_free(&frame);
    av_packet_free(&packet);
  }
};

MediaFile::MediaFile() = default;
MediaFile::~MediaFile() = default;

bool MediaFile::takes_jpeg() const { return state_ && state_->encoder == nullptr; }

Error MediaFile::failure(int code) const {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  const std::string why =
      AVUNERROR(code) > 0 && code > -4096
          ? why_not_written(std::error_code(AVUNERROR(code), std::generic_category()))
          : av_make_error_string(text.data(), text.size(), code);
  return {Errc::io,
          "the video " + path_ + " cannot be written (" + why +
              "): choose another 'path', or make it writable and free space",
          {}};
}

Result<void> MediaFile::open(const std::string& path, double fps, cv::Size size) {
  path_ = path;
  failed_ = {};
  av_log_set_callback(nullptr);
  auto started = start(path, fps, size);
  if (!started) state_.reset();
  return started;
}

Result<void> MediaFile::start(const std::string& path, double fps, cv::Size size) {
  state_ = std::make_unique<State>();
  State& s = *state_;
  const bool is_mp4 = path.ends_with(".mp4");
  s.tick = av_inv_q(av_d2q(fps, 1'000'000));
  if (const int code = make_empty(path); code < 0) return failure(code);
  const std::string url = "file:" + path;
  int code =
      avformat_alloc_output_context2(&s.format, nullptr, is_mp4 ? "mp4" : "matroska", url.c_str());
  AVStream* stream = code < 0 ? nullptr : avformat_new_stream(s.format, nullptr);
  if (stream == nullptr) return failure(code < 0 ? code : AVERROR(ENOMEM));
  AVCodecParameters& parameters = *stream->codecpar;
  parameters.codec_type = AVMEDIA_TYPE_VIDEO;
  parameters.codec_id = AV_CODEC_ID_MJPEG;
  parameters.width = size.width;
  parameters.height = size.height;
  if (is_mp4) {
    const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
    if (codec == nullptr) codec = avcodec_find_encoder(AV_CODEC_ID_H264);
    if (codec == nullptr) {
      return Error{Errc::unsupported, "the video " + path +
                                          " cannot be written: this FFmpeg has no encoder for "
                                          "H.264; use .avi or .mkv"};
    }
    s.encoder = avcodec_alloc_context3(codec);
    s.encoder->width = size.width + size.width % 2;
    s.encoder->height = size.height + size.height % 2;
    s.encoder->pix_fmt = AV_PIX_FMT_YUV420P;
    s.encoder->color_range = AVCOL_RANGE_MPEG;
    s.encoder->colorspace = AVCOL_SPC_SMPTE170M;
    s.encoder->time_base = s.tick;
    s.encoder->framerate = av_inv_q(s.tick);
    s.encoder->gop_size = std::max(1, static_cast<int>(std::lround(fps)));  // seeking within 1 s
    s.encoder->max_b_frames = 0;
    s.encoder->thread_count = 1;
    s.encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    // Options of libx264, which other encoders do not have; each image is ready at once.
    av_opt_set(s.encoder->priv_data, "preset", "veryfast", 0);
    av_opt_set(s.encoder->priv_data, "tune", "zerolatency", 0);
    av_opt_set(s.encoder->priv_data, "crf", "18", 0);
    code = avcodec_open2(s.encoder, codec, nullptr);
    if (code >= 0) code = avcodec_parameters_from_context(&parameters, s.encoder);
    if (code < 0) return failure(code);
    s.frame->format = s.encoder->pix_fmt;
    s.frame->width = s.encoder->width;
    s.frame->height = s.encoder->height;
    code = av_frame_get_buffer(s.frame, 0);
    if (code < 0) return failure(code);
  }
  stream->time_base = s.tick;
  stream->avg_frame_rate = av_inv_q(s.tick);
  code = avio_open(&s.format->pb, url.c_str(), AVIO_FLAG_WRITE);
  AVDictionary* options = nullptr;
  // Each fragment has one image.
  if (is_mp4) av_dict_set(&options, "movflags", "empty_moov+default_base_moof+frag_custom", 0);
  if (code >= 0) code = avformat_write_header(s.format, &options);
  av_dict_free(&options);
  if (code >= 0) {
    avio_flush(s.format->pb);
    code = s.format->pb->error;
  }
  return code < 0 ? Result<void>(failure(code)) : Result<void>();
}

Result<void> MediaFile::add(const std::vector<std::uint8_t>& jpeg) {
  if (!failed_) return failed_;
  State& s = *state_;
  s.packet->data = const_cast<std::uint8_t*>(jpeg.data());
  s.packet->size = static_cast<int>(jpeg.size());
  s.packet->flags = AV_PKT_FLAG_KEY;
  s.packet->pts = s.packet->dts = s.count++;
  failed_ = write_packet();
  return failed_;
}

Result<void> MediaFile::add(const cv::Mat& picture) {
  if (!failed_) return failed_;
  State& s = *state_;
  cv::Mat even = picture, yuv;
  if (picture.cols % 2 != 0 || picture.rows % 2 != 0) {
    cv::copyMakeBorder(picture, even, 0, picture.rows % 2, 0, picture.cols % 2,
                       cv::BORDER_REPLICATE);
  }
  cv::cvtColor(even, yuv, cv::COLOR_BGR2YUV_I420);
  int code = av_frame_make_writable(s.frame);
  const std::uint8_t* from = yuv.ptr();
  for (int plane = 0; plane < 3 && code >= 0; ++plane) {
    const int width = plane == 0 ? even.cols : even.cols / 2;
    const int height = plane == 0 ? even.rows : even.rows / 2;
    cv::Mat to(height, width, CV_8U, s.frame->data[plane], to_index(s.frame->linesize[plane]));
    cv::Mat(height, width, CV_8U, const_cast<std::uint8_t*>(from)).copyTo(to);
    from += to_index(width) * to_index(height);
  }
  s.frame->pts = s.count++;
  if (code >= 0) code = avcodec_send_frame(s.encoder, s.frame);
  if (code < 0) return failed_ = failure(code);
  while (failed_ && avcodec_receive_packet(s.encoder, s.packet) >= 0) failed_ = write_packet();
  return failed_;
}

/// Writes the packet and all that FFmpeg has in memory.
Result<void> MediaFile::write_packet() {
  State& s = *state_;
  s.packet->duration = 1;
  av_packet_rescale_ts(s.packet, s.tick, s.format->streams[0]->time_base);
  int code = av_write_frame(s.format, s.packet);
  av_packet_unref(s.packet);
  if (code >= 0) code = av_write_frame(s.format, nullptr);
  avio_flush(s.format->pb);
  if (code >= 0) code = s.format->pb->error;
  return code < 0 ? Result<void>(failure(code)) : Result<void>();
}

Result<void> MediaFile::close() {
  if (!state_) return {};
  State& s = *state_;
  if (failed_ && s.encoder != nullptr) {
    avcodec_send_frame(s.encoder, nullptr);  // encoders other than libx264 may still have images
    while (failed_ && avcodec_receive_packet(s.encoder, s.packet) >= 0) failed_ = write_packet();
  }
  int code = failed_ ? av_write_trailer(s.format) : 0;
  if (const int closed = avio_closep(&s.format->pb); code >= 0) code = closed;
  state_.reset();
  return !failed_ || code >= 0 ? failed_ : Result<void>(failure(code));
}

std::int64_t MediaFile::count_images(const std::string& path) {
  av_log_set_callback(nullptr);
  AVFormatContext* format = nullptr;  // none where opening fails
  AVPacket* packet = av_packet_alloc();
  std::int64_t count = 0;
  if (avformat_open_input(&format, ("file:" + path).c_str(), nullptr, nullptr) >= 0) {
    for (; av_read_frame(format, packet) >= 0; ++count) {
      av_packet_unref(packet);
      worked(1000);
    }
  }
  av_packet_free(&packet);
  avformat_close_input(&format);
  return count;
}

}  // namespace weft::overlay
