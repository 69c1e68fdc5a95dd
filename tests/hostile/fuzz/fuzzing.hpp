// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

/// Shared code of the reader fuzzers: an input as a file, and the conditions that an answer must
/// meet.
namespace weft::fuzzing {

/// Ends the program, which libFuzzer takes for a finding, unless `truth` holds.
inline void require(bool truth, std::string_view what, std::string_view shown = {}) {
  if (truth) return;
  std::cerr << "required: " << what << (shown.empty() ? "" : ": ") << shown << "\n";
  std::abort();
}

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// A regular file in memory, as long as this lives.
class InputFile {
 public:
  explicit InputFile(std::string_view bytes) : descriptor_(::memfd_create("input", MFD_CLOEXEC)) {
    require(descriptor_ >= 0, "a file in memory");
    for (std::string_view left = bytes; !left.empty();) {
      const ::ssize_t written = ::write(descriptor_, left.data(), left.size());
      require(written > 0, "room for a file in memory");
      left.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  ~InputFile() { ::close(descriptor_); }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

/// The lines of a text and how many characters each has, a broken one of UTF-8 counted by its
/// bytes.
class Lines {
 public:
  explicit Lines(std::string_view text) : characters_(1) {
    for (const char byte : text) {
      if (byte == '\n') {
        characters_.push_back(0);
      } else if ((static_cast<unsigned char>(byte) & 0xC0U) != 0x80U) {
        ++characters_.back();
      }
    }
  }

  /// The line, from 1, must be one of the text, or the empty one behind its last line break; the
  /// column one of its characters or right behind the last.
  void require_inside(std::int64_t line, std::int64_t column) const {
    const auto lines = static_cast<std::int64_t>(characters_.size());
    require(line >= 1 && line <= lines, "a line of the text", std::to_string(line));
    require(column >= 1 && column <= characters_[static_cast<std::size_t>(line - 1)] + 1,
            "a column of its line", std::to_string(line) + ":" + std::to_string(column));
  }

 private:
  std::vector<std::int64_t> characters_;
};

/// A number at the start of `text`, which is taken off; -1 where there is none.
inline std::int64_t take_number(std::string_view& text) {
  std::int64_t number = -1;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  text.remove_prefix(static_cast<std::size_t>(read.ptr - text.data()));
  return number;
}

/// `where` must begin with "file:LINE:COLUMN", or "file:LINE" where `with_column` is not set, and
/// that place must be in the text. Gives what stands behind it.
inline std::string_view require_place(std::string_view where, std::string_view file,
                                      std::string_view text, bool with_column = true) {
  require(where.starts_with(file) && where.substr(file.size()).starts_with(":"),
          "the file and a place", where);
  std::string_view rest = where.substr(file.size() + 1);
  const std::int64_t line = take_number(rest);
  std::int64_t column = 1;
  if (with_column) {
    require(rest.starts_with(":"), "a column", where);
    rest.remove_prefix(1);
    column = take_number(rest);
  }
  Lines(text).require_inside(line, column);
  return rest;
}

}  // namespace weft::fuzzing
