// SPDX-License-Identifier: Apache-2.0
#include "avi_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <numeric>
#include <weft/core/index.hpp>
#include <weft/core/whole_file.hpp>

namespace weft::overlay {
namespace {

constexpr std::uint32_t kMainHeadBytes = 56, kStreamHeadBytes = 56, kFormatBytes = 40;
constexpr std::uint32_t kStreamListBytes = 4 + 8 + kStreamHeadBytes + 8 + kFormatBytes;
constexpr std::uint32_t kHeadListBytes = 4 + 8 + kMainHeadBytes + 8 + kStreamListBytes;
constexpr std::uint32_t kMoviBegin = 12 + 8 + kHeadListBytes + 8;  ///< offset of the word "movi"

std::string u16(std::uint32_t value) {
  return {static_cast<char>(value & 0xFFU), static_cast<char>(value >> 8U & 0xFFU)};
}
std::string u32(std::uint64_t value) {
  return u16(static_cast<std::uint32_t>(value & 0xFFFFU)) +
         u16(static_cast<std::uint32_t>(value >> 16U & 0xFFFFU));
}
std::string zeros(std::size_t bytes) { return std::string(bytes, '\0'); }

}  // namespace

AviFile::~AviFile() {
  if (is_open()) ::close(file_);
}

Error AviFile::failure(int reason) const {
  return {Errc::io,
          "the video " + path_ + " cannot be written (" +
              why_not_written(std::error_code(reason, std::generic_category())) +
              "): choose another 'path', or make it writable and free space",
          {}};
}

Result<void> AviFile::open(const std::string& path, double fps, int width, int height) {
  if (is_open()) ::close(file_);
  path_ = path;
  fps_ = fps;
  width_ = width;
  height_ = height;
  end_ = largest_ = index_bytes_ = 0;
  sizes_.clear();
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC;
  file_ = ::open(path.c_str(), kFlags, 0666);
  if (!is_open()) return failure(errno);
  end_ = kMoviBegin + 4;
  return write_header();
}

Result<void> AviFile::write_header() {
  constexpr std::uint32_t kHasIndex = 0x10;
  std::uint64_t rate = std::llround(fps_ * 1e6), scale = 1'000'000;
  const std::uint64_t common = std::gcd(rate, scale);
  rate /= common;
  scale /= common;
  const auto width = static_cast<std::uint32_t>(width_),
             height = static_cast<std::uint32_t>(height_);
  std::string head = "RIFF" + u32(end_ + index_bytes_ - 8) + "AVI LIST" + u32(kHeadListBytes);
  head += "hdrlavih" + u32(kMainHeadBytes) + u32(1'000'000 * scale / rate) + zeros(8) +
          u32(index_bytes_ > 0 ? kHasIndex : 0) + u32(sizes_.size()) + u32(0) + u32(1) +
          u32(largest_) + u32(width) + u32(height) + zeros(16);
  head += "LIST" + u32(kStreamListBytes) + "strlstrh" + u32(kStreamHeadBytes) + "vidsMJPG" +
          zeros(12) + u32(scale) + u32(rate) + u32(0) + u32(sizes_.size()) + u32(largest_) +
          u32(0xFFFFFFFFU) + u32(0) + zeros(4) + u16(width) + u16(height);
  head += "strf" + u32(kFormatBytes) + u32(kFormatBytes) + u32(width) + u32(height) + u16(1) +
          u16(24) + "MJPG" + u32(std::uint64_t{3} * width * height) + zeros(16);
  head += "LIST" + u32(end_ - kMoviBegin) + "movi";
  return write_at(head, 0);
}

Result<void> AviFile::add(const std::vector<std::uint8_t>& jpeg) {
  const auto size = static_cast<std::uint32_t>(jpeg.size());
  std::string chunk = "00dc" + u32(size);
  chunk.append(reinterpret_cast<const char*>(jpeg.data()), jpeg.size());
  if (size % 2 != 0) chunk += '\0';
  if (auto written = append(chunk); !written) return written;
  end_ += chunk.size();
  sizes_.push_back(size);
  largest_ = std::max(largest_, size);
  return write_header();
}

Result<void> AviFile::close() {
  if (!is_open()) return {};
  std::string index = "idx1" + u32(16 * sizes_.size());
  std::uint64_t offset = 4;
  for (const std::uint32_t size : sizes_) {
    index += "00dc" + u32(0x10) + u32(offset) + u32(size);  // 0x10: can be decoded by itself
    offset += 8 + size + size % 2;
  }
  Result<void> written = append(index);
  if (written) {
    index_bytes_ = static_cast<std::uint32_t>(index.size());
    written = write_header();
  }
  if (::close(file_) != 0 && written) written = failure(errno);
  file_ = -1;
  return written;
}

/// Behind what is whole; what could be written only in part is cut off again.
Result<void> AviFile::append(const std::string& bytes) {
  auto written = write_at(bytes, end_);
  if (!written) static_cast<void>(!ftruncate(file_, static_cast<off_t>(end_)));
  return written;
}

Result<void> AviFile::write_at(const std::string& bytes, std::uint64_t offset) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count =
        pwrite(file_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return failure(count < 0 ? errno : ENOSPC);
    done += to_index(count);
  }
  return {};
}

}  // namespace weft::overlay
