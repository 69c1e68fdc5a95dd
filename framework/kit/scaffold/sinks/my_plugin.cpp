// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <filesystem>
#include <string>
#include <weft/core/whole_file.hpp>
#include <weft/sdk/sink.hpp>

namespace {

namespace fs = std::filesystem;

/// The shortest text that reads back as the same number, whatever the locale.
std::string text_of(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// One CSV file for each frame with a shape: its vertices.
class MyPluginSink final : public weft::Sink {
 public:
  static constexpr weft::About kAbout{.needs = "shape"};

  explicit MyPluginSink(weft::Params& p) {
    p.output_path("path", path_, "folder of the tables");
    p.read("measured_only", measured_only_,
           "omission of frames whose shape is carried over from an earlier frame");
  }

  weft::Result<void> open(const weft::Call& /*call*/) override {
    std::error_code code;
    fs::create_directories(path_, code);
    if (!code) return {};
    return weft::Error{weft::Errc::io, "the folder " + path_ + " cannot be made (" +
                                           code.message() + "): choose another 'path'"};
  }

  weft::Result<void> write(const weft::SinkInput& in) override {
    if (!in.shape) return weft::Error{weft::Errc::invalid_data, "needs 'shape'"};
    const weft::Shape& shape = *in.shape;
    const bool measured = shape.shape_state() == weft::ShapeState::estimated ||
                          shape.shape_state() == weft::ShapeState::weak;
    if (measured_only_ && !measured) return {};
    std::string table = "x_m,y_m,z_m,measured\n";
    for (std::int64_t v = 0; v < shape.vertices_m.rows(); ++v) {
      for (int k = 0; k < 3; ++k) table += text_of(shape.vertices_m(v, k)) + ',';
      table += shape.source(v) != 0 ? "1\n" : "0\n";
    }
    std::string number = std::to_string(in.call.frame());
    number.insert(0, number.size() < 6 ? 6 - number.size() : 0, '0');
    // Frames do not wait for the disk.
    return weft::write_whole(table, fs::path(path_) / (number + ".csv"),
                             weft::Durability::unsynced);
  }

  weft::Result<void> finish(const weft::Call& /*call*/) override { return {}; }

 private:
  std::string path_ = "vertices";
  bool measured_only_ = true;
};

}  // namespace

WEFT_PLUGIN(MyPluginSink, "sinks/my_plugin", "1.0.0", "Writes the vertices of each frame as CSV.")
