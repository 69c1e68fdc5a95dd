// SPDX-License-Identifier: Apache-2.0
#include "pipeline_text.hpp"

#include <gmock/gmock.h>

namespace weft::video {
namespace {

using ::testing::HasSubstr;

TEST(PipelineText, TakesPipelinesThatGiveFramesToAppsinkAlone) {
  for (const char* pipeline : {
           "videotestsrc ! appsink",
           "v4l2src device=/dev/video0 ! video/x-raw,width=640 ! videoconvert ! appsink name=sink0",
           "rtspsrc location=rtsp://10.0.0.1/filesink ! decodebin ! appsink sync=false",
           "compositor name=c sink_0::xpos=0 ! appsink videotestsrc ! c.sink_0",
           "uridecodebin uri=\"file:///a b sink\" ! appsink",
       }) {
    const auto legal = check_pipeline(pipeline);
    EXPECT_TRUE(legal) << pipeline << ": " << (legal ? "" : legal.error().message);
  }
}

TEST(PipelineText, RefusesByNameWhatWritesElsewhere) {
  for (const auto& [pipeline, word] : std::vector<std::pair<std::string, std::string>>{
           {"videotestsrc ! filesink location=/tmp/x", "filesink"},
           {"videotestsrc ! tee name=t t. ! queue ! filesink location=x t. ! appsink", "filesink"},
           {"videotestsrc ! \"filesink\" location=x videotestsrc ! appsink", "filesink"},
           {"videotestsrc ! file\\sink location=x videotestsrc ! appsink", "filesink"},
           {"videotestsrc !filesink location=x videotestsrc !appsink", "filesink"},
           {"( videotestsrc ! multifilesink location=%d ) videotestsrc ! appsink", "multifilesink"},
           {"videotestsrc ! x264enc ! hlssink2 videotestsrc ! appsink", "hlssink2"},
           {"playbin uri=file:///a video-sink=\"filesink location=x\" ! appsink", "video-sink"},
           {"videotestsrc ! splitmuxsink location=\"a\" videotestsrc ! appsink", "splitmuxsink"},
           {"videotestsrc name=a\tfilesink location=appsink ! appsink", "filesink"},
           {"videotestsrc ! x264enc multipass-cache-file=/tmp/x ! appsink", "multipass-cache-file"},
       }) {
    const auto legal = check_pipeline(pipeline);
    ASSERT_FALSE(legal) << pipeline;
    EXPECT_THAT(legal.error().message, HasSubstr("'" + word + "'")) << pipeline;
  }
}

TEST(PipelineText, AsksForAnAppsinkWhereThereIsNone) {
  const auto legal = check_pipeline("videotestsrc ! videoconvert");
  ASSERT_FALSE(legal);
  EXPECT_THAT(legal.error().message, HasSubstr("! appsink"));
}

}  // namespace
}  // namespace weft::video
