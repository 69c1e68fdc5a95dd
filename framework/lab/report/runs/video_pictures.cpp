// SPDX-License-Identifier: Apache-2.0
#include "lab/report/runs/video_pictures.hpp"

#include <array>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>

namespace weft::lab {
namespace {

constexpr std::uint32_t kWordBytes = 4;
constexpr std::uint32_t kMostPictureBytes = 1U << 26U;

struct Chunk {
  std::string id;
  std::uint32_t bytes = 0;
};

std::optional<Chunk> next_chunk(std::ifstream& stream) {
  std::array<char, 8> head{};
  if (!stream.read(head.data(), head.size())) return std::nullopt;
  Chunk chunk{std::string(head.data(), 4), 0};
  std::memcpy(&chunk.bytes, head.data() + 4, sizeof(chunk.bytes));  // little-endian, as RIFF is
  return chunk;
}

std::string next_word(std::ifstream& stream) {
  std::string word(4, '\0');
  return stream.read(word.data(), 4) ? word : "";
}

/// Chunks are padded to an even number of bytes.
void skip(std::ifstream& stream, std::uint32_t bytes) {
  stream.seekg(static_cast<std::streamoff>(bytes) + bytes % 2, std::ios::cur);
}

bool is_picture(const std::string& id) { return id.ends_with("dc") || id.ends_with("db"); }

}  // namespace

VideoPictures video_pictures(const std::string& file, const std::set<std::uint64_t>& wanted) {
  constexpr std::string_view kJpegStart = "\xFF\xD8";
  VideoPictures pictures;
  std::ifstream stream(file, std::ios::binary);
  const auto riff = next_chunk(stream);
  if (!riff || riff->id != "RIFF" || next_word(stream) != "AVI ") return pictures;
  while (const auto chunk = next_chunk(stream)) {
    if (chunk->id == "LIST") {
      // The images are inside the list `movi`; other lists are skipped.
      if (next_word(stream) != "movi") skip(stream, chunk->bytes - kWordBytes);
      continue;
    }
    if (!is_picture(chunk->id) || wanted.count(pictures.count) == 0) {
      pictures.count += is_picture(chunk->id) ? 1 : 0;
      skip(stream, chunk->bytes);
      continue;
    }
    if (chunk->bytes > kMostPictureBytes) break;
    std::string bytes(chunk->bytes, '\0');
    if (!stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) break;
    if (bytes.starts_with(kJpegStart)) pictures.wanted.emplace(pictures.count, std::move(bytes));
    if (chunk->bytes % 2 != 0) stream.seekg(1, std::ios::cur);
    ++pictures.count;
  }
  return pictures;
}

}  // namespace weft::lab
