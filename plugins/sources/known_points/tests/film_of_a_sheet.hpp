// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <weft/data/camera.hpp>
#include <weft/data/known_points.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace weft::testing {

/// A folder that disappears with the object.
class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string path(const std::string& name) const { return (path_ / name).string(); }

  std::string with(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path(name);
  }
  std::string with_pipe(const std::string& name) const {
    if (mkfifo(path(name).c_str(), 0600) != 0) throw std::runtime_error("no pipe");
    return path(name);
  }

 private:
  std::filesystem::path path_;
};

/// The writing end of a pipe that is read already.
class Writer {
 public:
  explicit Writer(const std::string& path) : file_(::open(path.c_str(), O_WRONLY | O_NONBLOCK)) {
    if (file_ < 0) throw std::runtime_error("no component reads " + path);
  }
  ~Writer() { ::close(file_); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void say(const std::string& text) const {
    if (::write(file_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
      throw std::runtime_error("the pipe is full");
    }
  }

 private:
  int file_;
};

/// Ten tiny frames of a surface, at intervals of 0.1 s, with known points of a file or pipe.
class Film {
 public:
  static constexpr int kOpen = 0, kCount = 1, kRead = 2;

  explicit Film(const std::string& rows, const std::string& more = "",
                const std::string& frames = "frames: 10, fps: 10")
      : plugin_("sources/known_points",
                "{frames: {use: sources/synthetic, params: {texture: " WEFT_TEXTURES
                "sheet_texture.png, image_width_px: 64, image_height_px: 48, focal_px: 80, " +
                    frames + "}}, path: '" + rows + "'" + more + "}") {}

  PluginAnswer open() { return plugin_.process(kOpen, {}); }
  std::int64_t count() { return plugin_.process(kCount, {}).get<Count>()->frames; }
  PluginAnswer read(std::uint64_t frame) { return plugin_.process(kRead, {}, frame); }

 private:
  PluginUnderTest plugin_;
};

}  // namespace weft::testing
