// SPDX-License-Identifier: Apache-2.0
#include <boost/asio/read_until.hpp>

#include "foxglove/channels.hpp"
#include "live_fixture.hpp"

namespace weft::live {
namespace {

using ::testing::HasSubstr;

struct Data {
  std::uint32_t subscription = 0;
  std::uint64_t time_ns = 0;
  json message;
};

class LiveFoxglove : public LiveServer {
 protected:
  static Data data_for(Viewer& viewer) {
    const Viewer::Message message = viewer.read();
    EXPECT_FALSE(viewer.error()) << viewer.error().message();
    EXPECT_FALSE(message.is_text) << message.bytes;
    Data got;
    if (message.bytes.size() < 13 || message.bytes[0] != 1) {
      ADD_FAILURE() << "no message data";
      return got;
    }
    got.subscription = u32_at(message.bytes, 1);
    std::memcpy(&got.time_ns, message.bytes.data() + 5, sizeof got.time_ns);
    got.message = json::parse(message.bytes.substr(13), nullptr, false);
    EXPECT_TRUE(got.message.is_object()) << message.bytes.substr(13);
    return got;
  }

  /// Subscribes to these channels, under ten times their number.
  static void subscribe(Viewer& viewer, const std::vector<int>& channels) {
    json list = json::array();
    for (const int channel : channels) {
      list.push_back(json{{"id", 10 * channel}, {"channelId", channel}});
    }
    viewer.say(json{{"op", "subscribe"}, {"subscriptions", list}}.dump());
  }

  /// Unknown operations are answered, so previous messages have been read.
  static void let_foxglove_read(Viewer& viewer) {
    viewer.say(R"({"op":"fetchAsset"})");
    EXPECT_EQ(viewer.text()["op"], "status");
  }
};

TEST_F(LiveFoxglove, IsServedUnderEachNameOfItsProtocol) {
  start();
  const std::string sdk(kFoxgloveSdkProtocol), older(kFoxgloveProtocol);
  for (const auto& [offered, chosen] : std::vector<std::pair<std::string, std::string>>{
           {sdk, sdk},
           {older, older},
           {sdk + ", " + older, sdk},
           {older + ", " + sdk, older},
           {"foxglove.sdk.v2," + sdk, sdk},
           {"chat\r\nSec-WebSocket-Protocol: " + sdk, sdk}}) {
    const std::string upgrade =
        "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\nSec-WebSocket-Protocol: ";
    asio::io_context context;
    tcp::socket socket(context);
    socket.connect({asio::ip::address_v4::loopback(), port_});
    asio::write(socket, asio::buffer(request_for("/", port_, upgrade + offered + "\r\n")));
    std::string answer;
    asio::read_until(socket, asio::dynamic_buffer(answer), "\r\n\r\n");
    EXPECT_EQ(status_of(answer), "101") << offered;
    EXPECT_THAT(answer, HasSubstr("Sec-WebSocket-Protocol: " + chosen + "\r\n")) << offered;
  }
  Viewer viewer(port_, kFoxgloveSdkProtocol, "/");
  EXPECT_EQ(viewer.text()["op"], "serverInfo");
  EXPECT_EQ(viewer.text()["op"], "advertise");
}

TEST_F(LiveFoxglove, ReceivesServerInfoAndChannelsWithTheirSchemas) {
  start();
  Viewer viewer(port_, kFoxgloveProtocol, "/");
  ASSERT_TRUE(viewer.is_open());
  EXPECT_EQ(viewer.response()[http::field::sec_websocket_protocol], "foxglove.websocket.v1");
  const json info = viewer.text();
  EXPECT_EQ(info["op"], "serverInfo");
  EXPECT_TRUE(info["capabilities"].is_array());
  const json advertised = viewer.text();
  EXPECT_EQ(advertised["op"], "advertise");
  std::vector<std::string> names;
  for (const json& channel : advertised["channels"]) {
    EXPECT_EQ(channel["id"], names.size() + 1);
    EXPECT_EQ(channel["encoding"], "json");
    EXPECT_EQ(channel["schemaEncoding"], "jsonschema");
    const json schema = json::parse(channel["schema"].get<std::string>());
    EXPECT_EQ(schema["type"], "object");
    EXPECT_EQ(schema["title"], channel["schemaName"]);
    EXPECT_TRUE(schema["properties"].is_object());
    names.push_back(channel["schemaName"].get<std::string>());
  }
  EXPECT_EQ(names, (std::vector<std::string>{"foxglove.CompressedImage", "foxglove.SceneUpdate",
                                             "foxglove.CameraCalibration",
                                             "foxglove.FrameTransforms", "weft.FrameReport"}));
}

TEST_F(LiveFoxglove, MessagesHaveTheMembersOfTheirSchemas) {
  start();
  ShownFrame shown(frame(3), {});
  const LiveSetup setup{
      AccessPolicy(asio::ip::address_v4::loopback(), "", ""), {}, camera_, {0, 1, 2}, "", {}};
  for (const auto& channel : foxglove::channels()) {
    const json schema = json::parse(foxglove::schema_of(channel.schema));
    const json message = json::parse(channel.message(shown, setup));
    for (const auto& [name, member] : message.items()) {
      EXPECT_TRUE(schema["properties"].contains(name)) << channel.schema << " " << name;
    }
  }
}

TEST_F(LiveFoxglove, GetsImageMeshCameraTransformsAndReport) {
  start();
  Viewer viewer(port_, kFoxgloveProtocol);
  viewer.text();
  viewer.text();
  subscribe(viewer, {1, 2, 3, 4, 5});
  let_foxglove_read(viewer);
  run_channel_.put_frame(frame(3));
  std::map<std::uint32_t, json> got;
  for (int i = 0; i < 5; ++i) {
    const Data each = data_for(viewer);
    EXPECT_EQ(each.time_ns, 2'500'000'003U);
    got[each.subscription] = each.message;
  }
  ASSERT_EQ(got.size(), 5U);
  EXPECT_EQ(got[10]["timestamp"]["sec"], 2);
  EXPECT_EQ(got[10]["timestamp"]["nsec"], 500'000'003);
  EXPECT_EQ(got[10]["format"], "jpeg");
  EXPECT_EQ(got[10]["data"].get<std::string>().substr(0, 4), "/9j/");
  const json mesh = got[20]["entities"][0];
  EXPECT_EQ(mesh["frame_id"], "camera");
  EXPECT_EQ(mesh["metadata"][0]["value"], "estimated");
  EXPECT_EQ(mesh["triangles"][0]["points"].size(), 4U);
  EXPECT_EQ(mesh["triangles"][0]["points"][3], json::parse(R"({"x":0.2,"y":0.15,"z":0.5})"));
  EXPECT_EQ(mesh["triangles"][0]["indices"].size(), 6U);
  EXPECT_EQ(got[30]["width"], 640);
  EXPECT_EQ(got[30]["K"][2], camera_.cx);
  EXPECT_EQ(got[30]["P"][6], camera_.cy);
  EXPECT_EQ(got[40]["transforms"][0]["child_frame_id"], "camera");
  EXPECT_EQ(got[50]["frame"], 3);
}

TEST_F(LiveFoxglove, SeesTheCameraOfTheSmallerImage) {
  ShownFrame shown(frame(0), {});
  const LiveSetup setup{
      AccessPolicy(asio::ip::address_v4::loopback(), "", ""), {80, 320}, camera_, {}, "", {}};
  const json camera = json::parse(foxglove::channels()[2].message(shown, setup));
  EXPECT_EQ(camera["width"], 320);
  EXPECT_EQ(camera["height"], 240);
  EXPECT_EQ(camera["K"][0], camera_.fx / 2);
  // The middle of the image stays its middle; pixel centres are at integers.
  EXPECT_DOUBLE_EQ(camera["K"][2].get<double>(), (camera_.cx + 0.5) / 2 - 0.5);
}

TEST_F(LiveFoxglove, ReceivesAWarningThatThereIsNoMesh) {
  start();
  Viewer viewer(port_, kFoxgloveProtocol);
  viewer.text();
  viewer.text();
  subscribe(viewer, {1, 2});
  let_foxglove_read(viewer);
  FrameCopy lost;
  lost.frame = 4;
  run_channel_.put_frame(lost);  // without an image there is no message of one
  const Data mesh = data_for(viewer);
  EXPECT_EQ(mesh.subscription, 20U);
  EXPECT_EQ(mesh.message["deletions"][0]["type"], 1);
  EXPECT_TRUE(mesh.message["entities"].empty());
}

TEST_F(LiveFoxglove, GetsNothingMoreOfWhatItLeaves) {
  start();
  Viewer viewer(port_, kFoxgloveProtocol);
  viewer.text();
  viewer.text();
  subscribe(viewer, {4, 5});
  viewer.say(R"({"op":"unsubscribe","subscriptionIds":[40]})");
  let_foxglove_read(viewer);
  for (std::uint64_t number = 0; number < 3; ++number) {
    run_channel_.put_frame(frame(number));
    const Data each = data_for(viewer);
    EXPECT_EQ(each.subscription, 50U);
    EXPECT_EQ(each.message["frame"], number);
  }
}

TEST_F(LiveFoxglove, ReceivesAWarningForWhatItCannotHave) {
  start();
  Viewer viewer(port_, kFoxgloveProtocol);
  viewer.text();
  viewer.text();
  subscribe(viewer, {5});
  for (const std::string message :
       {R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":6}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0}]})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":50,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[7]})",
        R"({"op":"unsubscribe","subscriptionIds":[3]})",
        R"({"op":"unsubscribe","subscriptionIds":["x"]})", R"({"op":"getParameters"})"}) {
    viewer.say(message);
    const json status = viewer.text();
    EXPECT_EQ(status["op"], "status") << message;
    EXPECT_EQ(status["level"], 1) << message;
  }
  viewer.say("\x01\x02\x03\x04\x05", false);
  EXPECT_THAT(viewer.text()["message"].get<std::string>(), HasSubstr("takes no data"));
  viewer.say("no JSON");
  viewer.read();
  EXPECT_EQ(viewer.close_code(), websocket::close_code::policy_error);
}

}  // namespace
}  // namespace weft::live
