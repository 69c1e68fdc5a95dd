// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <boost/asio/ip/udp.hpp>
#include <future>
#include <limits>

#include "sheet_points.hpp"
#include "stream_fixture.hpp"

namespace weft::stream {
namespace {

using asio::ip::udp;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST_F(StreamSink, WritesEachFrameIntoAFileWhoseFolderItMakes) {
  PluginUnderTest sink("sinks/stream", "{path: '" + path("deep/er/points.jsonl") + "'}");
  ASSERT_EQ(open(sink).status, WEFT_OK);
  ASSERT_EQ(write(sink, 0).status, WEFT_OK);
  const std::string first = read_file(path("deep/er/points.jsonl"));
  ASSERT_EQ(write(sink, 7).status, WEFT_OK);
  ASSERT_EQ(sink.process(kFinish, {}).status, WEFT_OK);
  EXPECT_THAT(first, StartsWith("{\"frame\":0,\"time_s\":0,\"state\":\"estimated\""));
  EXPECT_THAT(first, EndsWith("}\n"));
  const std::string both = read_file(path("deep/er/points.jsonl"));
  EXPECT_EQ(both.substr(0, first.size()), first);
  EXPECT_THAT(both.substr(first.size()), StartsWith("{\"frame\":7,\"time_s\":1.75,"));
}

TEST_F(StreamSink, LeavesTheCovarianceOutWhenAsked) {
  shape_.covariance_m2 = Array<double>({4, 3, 3}, 0.0);
  for (const auto& [more, bytes] :
       {std::pair{"", 56 + 4 * 96}, {", covariance: false", 56 + 4 * 24}}) {
    PluginUnderTest sink("sinks/stream",
                         "{path: '" + path("points") + "', format: packed" + more + "}");
    ASSERT_EQ(open(sink).status, WEFT_OK);
    ASSERT_EQ(write(sink, 0).status, WEFT_OK);
    EXPECT_EQ(read_file(path("points")).size(), static_cast<std::size_t>(bytes));
  }
}

TEST_F(StreamSink, NamesWhatIsWrongWithItsDestination) {
  expect_refused("{}", "has neither 'to' nor 'path'");
  expect_refused("{to: 'tcp://127.0.0.1:5005', path: points}", "has both 'to' and 'path'");
  expect_refused("{to: stdout}", "and 'path' for a file, a named pipe or /dev/stdout");
  std::ofstream(path("file")) << "a file where a folder is needed";
  expect_refused("{path: '" + path("file/points") + "'}", "choose another 'path'");
  // From a block that is reserved for documentation: no machine has it.
  expect_refused("{to: 'tcp://192.0.2.1:5005'}", "choose one that it has");
}

TEST_F(StreamSink, RefusesAShapeThatIsNoShapeOfThisTemplate) {
  PluginUnderTest sink("sinks/stream", "{path: '" + path("points") + "'}");
  ASSERT_EQ(open(sink).status, WEFT_OK);
  const Shape good = shape_;
  shape_ = two_vertices();
  EXPECT_THAT(write(sink, 0).message, HasSubstr("2 vertices, the template 4"));
  shape_ = good;
  shape_.vertices_m = Array<double>({4, 3}, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(write(sink, 1).message, HasSubstr("not finite"));
  shape_ = good;
  shape_.covariance_m2 = Array<double>({4, 3, 3}, std::numeric_limits<double>::infinity());
  EXPECT_THAT(write(sink, 2).message, HasSubstr("not finite"));
  EXPECT_EQ(read_file(path("points")), "");
}

TEST_F(StreamSink, WritesAllFramesToAPipeAndReportsABrokenPipe) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  const std::string params = "{path: '" + path("pipe") + "'}";
  expect_refused(params, "start its reader first");
  const int reader = ::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  PluginUnderTest sink("sinks/stream", params);
  ASSERT_EQ(open(sink).status, WEFT_OK);
  ASSERT_EQ(write(sink, 0).status, WEFT_OK);
  std::string got(4096, ' ');
  const ssize_t bytes = read(reader, got.data(), got.size());
  ASSERT_GT(bytes, 0);
  EXPECT_EQ(got[static_cast<std::size_t>(bytes) - 1], '\n');
  close(reader);
  // The signal that a write into it makes would end this test.
  const PluginAnswer alone = write(sink, 1);
  EXPECT_EQ(alone.status, WEFT_ERROR);
  EXPECT_THAT(alone.message, HasSubstr("no process reads " + path("pipe") + " any more"));
  // A reader that comes back would begin in the middle of a message.
  const int late = ::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK);
  EXPECT_EQ(write(sink, 2).status, WEFT_ERROR);
  close(late);
}

TEST_F(StreamSink, WaitsForThePipeUntilItIsCancelled) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  const int reader = ::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  PluginUnderTest sink("sinks/stream", "{path: '" + path("pipe") + "'}");
  ASSERT_EQ(open(sink).status, WEFT_OK);
  auto filling = std::async(std::launch::async, [&] {
    weft_status status = WEFT_OK;
    for (std::uint64_t frame = 0; status == WEFT_OK; ++frame) status = write(sink, frame).status;
    return status;
  });
  EXPECT_EQ(filling.wait_for(std::chrono::milliseconds(300)), std::future_status::timeout);
  sink.cancel() = true;
  ASSERT_EQ(filling.wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(filling.get(), WEFT_CANCELLED);
  close(reader);
}

TEST_F(StreamSink, SendsOneDatagramForEachFrame) {
  asio::io_context context;
  udp::socket reader(context, {asio::ip::address_v4::loopback(), 0});
  const std::string port = std::to_string(reader.local_endpoint().port());
  PluginUnderTest sink("sinks/stream", "{to: 'udp://127.0.0.1:" + port + "'}");
  ASSERT_EQ(open(sink).status, WEFT_OK);
  for (std::uint64_t frame = 0; frame < 3; ++frame) {
    ASSERT_EQ(write(sink, frame).status, WEFT_OK);
  }
  for (int frame = 0; frame < 3; ++frame) {
    std::string datagram(65536, ' ');
    datagram.resize(reader.receive(asio::buffer(datagram)));
    EXPECT_THAT(datagram, StartsWith("{\"frame\":" + std::to_string(frame) + ","));
    EXPECT_THAT(datagram, EndsWith("}\n"));
  }
  reader.close();
  for (std::uint64_t frame = 3; frame < 6; ++frame) {
    EXPECT_EQ(write(sink, frame).status, WEFT_OK) << "nobody listens, and nobody minds";
  }
}

TEST_F(StreamSink, SaysWhatToChangeWhenAFrameDoesNotFitADatagram) {
  use({60, 50, 0.2, 0.15, 40, 30});
  PluginUnderTest sink("sinks/stream",
                       "{to: 'udp://127.0.0.1:" + free_port() + "', format: packed}");
  ASSERT_EQ(open(sink).status, WEFT_OK);
  const PluginAnswer refused = write(sink, 0);
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_THAT(refused.message, HasSubstr("a frame of 72056 bytes does not fit a datagram"));
  EXPECT_THAT(refused.message, HasSubstr("covariance: false"));
}

}  // namespace
}  // namespace weft::stream
