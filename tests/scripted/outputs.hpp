// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <weft/sdk/sink.hpp>

#include "script.hpp"

namespace scripted {

/// A line for each frame; the file bears its name once the run is over.
class LineSink final : public weft::Sink {
 public:
  static constexpr weft::About kAbout{.reads = "shape correspondences"};

  explicit LineSink(weft::Params& p) : script_(p) {
    p.output_path("path", path_, "of the file, none without it");
    p.read("refuse_open", refuse_open_, "fail in open");
    p.read("refuse_finish", refuse_finish_, "fail in finish");
  }

  weft::Result<void> open(const weft::Call&) override {
    if (!path_.empty()) stream_.open(path_ + ".part");
    if (!refuse_open_) return {};
    return weft::Error{weft::Errc::io, "cannot open as scripted", ""};
  }

  weft::Result<void> write(const weft::SinkInput& in) override {
    if (auto failure = script_.failure(in.call)) return *failure;
    stream_ << in.call.frame() << ' '
            << (in.shape ? weft::to_string(in.shape->shape_state()) : "no shape") << ' '
            << (in.correspondences ? in.correspondences->count() : -1) << std::endl;
    return {};
  }

  weft::Result<void> finish(const weft::Call&) override {
    stream_.close();
    if (!path_.empty()) std::filesystem::rename(path_ + ".part", path_);
    if (!refuse_finish_) return {};
    return weft::Error{weft::Errc::plugin_failure, "cannot finish as scripted", ""};
  }

 private:
  Script script_;
  std::string path_;
  bool refuse_open_ = false;
  bool refuse_finish_ = false;
  std::ofstream stream_;
};

/// Cannot do without visibility.
class VisibilitySink final : public weft::Sink {
 public:
  static constexpr weft::About kAbout{.needs = "visibility"};

  explicit VisibilitySink(weft::Params&) {}

  weft::Result<void> open(const weft::Call&) override { return {}; }
  weft::Result<void> write(const weft::SinkInput&) override { return {}; }
  weft::Result<void> finish(const weft::Call&) override { return {}; }
};

}  // namespace scripted
