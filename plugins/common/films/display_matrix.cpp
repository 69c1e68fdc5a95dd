// SPDX-License-Identifier: Apache-2.0
#include "common/films/display_matrix.hpp"

#include <cstdint>
#include <fstream>
#include <functional>
#include <string_view>
#include <weft/images/orientation.hpp>

namespace weft::films {
namespace {

using detail::Bytes;

/// The part of a display matrix that turns: x' = a x + c y, y' = b x + d y.
struct Matrix {
  int a = 1, b = 0, c = 0, d = 1;
};

constexpr std::uint64_t kHead = 8;  ///< [bytes] size and name of a box

/// Calls `visit` with the name and the content of each box.
void for_each_box(std::string_view boxes,
                  const std::function<void(std::string_view, std::string_view)>& visit) {
  const Bytes bytes(boxes);
  for (std::uint64_t at = 0; bytes.has(at + kHead);) {
    const std::uint64_t size = bytes.big32(at);
    if (size < kHead || !bytes.has(at + size)) return;
    visit(bytes.part(at + 4, 4), bytes.part(at + kHead, size - kHead));
    at += size;
  }
}

/// The box `moov` of a file, read without those before it; empty where there is none.
std::string movie_box(const std::string& path) {
  constexpr std::uint64_t kMostBytes = 1U << 28U;
  std::ifstream file(path, std::ios::binary);
  for (std::uint64_t at = 0;;) {
    std::string head(16, '\0');
    file.seekg(static_cast<std::streamoff>(at));
    if (!file.read(head.data(), static_cast<std::streamsize>(kHead))) return {};
    file.read(head.data() + kHead, static_cast<std::streamsize>(kHead));
    file.clear();
    const Bytes bytes(head);
    const std::uint64_t start = bytes.big32(0) == 1 ? 2 * kHead : kHead;
    const std::uint64_t size = bytes.big32(0) != 1
                                   ? bytes.big32(0)
                                   : std::uint64_t{bytes.big32(8)} << 32U | bytes.big32(12);
    if (size < start) return {};
    if (head.substr(4, 4) == "moov") {
      if (size > kMostBytes) return {};
      std::string content(size - start, '\0');
      file.seekg(static_cast<std::streamoff>(at + start));
      file.read(content.data(), static_cast<std::streamsize>(content.size()));
      return content;
    }
    at += size;
    if (at > std::uint64_t{1} << 62U) return {};
  }
}

int unit_of(std::uint32_t fixed) {
  if (fixed == 0x10000U) return 1;
  if (fixed == 0xFFFF0000U) return -1;
  return fixed == 0U ? 0 : 2;
}

/// The matrix in a header; versions above 0 have three longer fields before it.
Matrix matrix_at(std::string_view header, std::uint64_t at) {
  const Bytes bytes(header);
  const std::uint64_t from = at + (bytes.at(0) == 0 ? 0 : 12);
  return {unit_of(bytes.big32(from)), unit_of(bytes.big32(from + 4)),
          unit_of(bytes.big32(from + 12)), unit_of(bytes.big32(from + 16))};
}

/// First the track's, then the movie's.
Matrix product(const Matrix& track, const Matrix& movie) {
  return {movie.a * track.a + movie.c * track.b, movie.b * track.a + movie.d * track.b,
          movie.a * track.c + movie.c * track.d, movie.b * track.c + movie.d * track.d};
}

int orientation_of(const Matrix& matrix) {
  for (int k = 1; k <= 8; ++k) {
    const Turns turned = turns(k);
    const int x = turned.columns ? -1 : 1, y = turned.rows ? -1 : 1;
    const Matrix own = turned.sideways ? Matrix{0, y, x, 0} : Matrix{x, 0, 0, y};
    if (own.a == matrix.a && own.b == matrix.b && own.c == matrix.c && own.d == matrix.d) return k;
  }
  return 0;
}

bool is_video(std::string_view track) {
  const std::size_t handler = track.find("hdlr");
  return handler != track.npos && track.substr(handler + 12, 4) == "vide";
}

}  // namespace

int orientation_of_film(const std::string& path) {
  Matrix movie, track;
  bool is_found = false;
  const std::string content = movie_box(path);
  for_each_box(content, [&](std::string_view name, std::string_view box) {
    if (name == "mvhd") movie = matrix_at(box, 36);
    if (name != "trak" || is_found || !is_video(box)) return;
    is_found = true;
    for_each_box(box, [&](std::string_view part, std::string_view header) {
      if (part == "tkhd") track = matrix_at(header, 40);
    });
  });
  return is_found ? orientation_of(product(track, movie)) : 1;
}

}  // namespace weft::films
