// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <stdlib.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::stream {

namespace asio = boost::asio;
namespace fs = std::filesystem;
using testing::input;
using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr int kOpen = 0, kWrite = 1, kFinish = 2;
constexpr std::chrono::seconds kPatience(120);

inline std::string read_file(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline std::string free_port() {
  asio::io_context context;
  const asio::ip::tcp::acceptor taken(context, {asio::ip::address_v4::loopback(), 0});
  return std::to_string(taken.local_endpoint().port());
}

/// The sink with a template of four vertices, and a folder for its files.
class StreamSink : public ::testing::Test {
 protected:
  StreamSink() {
    std::string pattern = (fs::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
    use({2, 2, 0.2, 0.15, 40, 30});
  }
  ~StreamSink() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  void use(const testing::SheetSpec& sheet) {
    templ_ = testing::make_template(sheet);
    const std::int64_t vertices = templ_.vertices_m.rows();
    shape_.vertices_m = Array<double>({vertices, 3}, 0.5);
    shape_.source = Array<std::uint8_t>({vertices}, 1);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  PluginAnswer open(PluginUnderTest& sink) const {
    EXPECT_TRUE(sink.prepare(templ_, testing::make_camera()));
    return sink.process(kOpen, {});
  }

  PluginAnswer write(PluginUnderTest& sink, std::uint64_t frame) const {
    const PluginAnswer answer = sink.process(
        kWrite, {input("shape", shape_), input("time", Time{0.25 * static_cast<double>(frame)})},
        frame);
    sink.forget();
    return answer;
  }

  void expect_refused(const std::string& params, const std::string& why) const {
    PluginUnderTest sink("sinks/stream", params);
    const PluginAnswer refused = open(sink);
    EXPECT_EQ(refused.status, WEFT_ERROR) << params;
    EXPECT_THAT(refused.message, ::testing::HasSubstr(why)) << params;
  }

  fs::path folder_;
  Template templ_;
  Shape shape_;
};

}  // namespace weft::stream
