// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <weft/core/result.hpp>

namespace weft::known_points {

/// Lines of a named pipe, as they come.
class LinePipe {
 public:
  enum class Got { line, nothing, end, cancelled };

  /// Does not wait for a writer.
  static Result<LinePipe> open(const std::string& path);

  /// The next line without its end, waiting until `deadline` at most; `end` when the last writer
  /// has closed it and all lines have been returned. Calls `cancelled` every 5 ms. Fails when
  /// reading fails, or a line is longer than 64 KiB; nothing more comes then.
  Result<Got> next(std::string& line, std::chrono::steady_clock::time_point deadline,
                   const std::function<bool()>& cancelled);

 private:
  /// An open file, closed at the end.
  class Descriptor {
   public:
    explicit Descriptor(int number) : number_(number) {}
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
      std::swap(number_, other.number_);
      return *this;
    }
    ~Descriptor();
    int number() const { return number_; }

   private:
    int number_;
  };

  explicit LinePipe(int file) : file_(file) {}
  bool take_line(std::string& line);
  Result<void> receive();

  Descriptor file_;
  std::string buffer_;
  bool ended_ = false;
};

}  // namespace weft::known_points
