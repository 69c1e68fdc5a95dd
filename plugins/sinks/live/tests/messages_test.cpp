// SPDX-License-Identifier: Apache-2.0
#include "messages.hpp"

#include <weft/core/base64.hpp>

#include "live_fixture.hpp"

namespace weft::live {
namespace {

using ::testing::HasSubstr;

std::string from_base64(const std::string& text) {
  static const std::string kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t group = 0, bits = 0;
  for (const char digit : text.substr(0, text.find('='))) {
    group = (group << 6U) | static_cast<std::uint32_t>(kDigits.find(digit));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>((group >> bits) & 0xFFU);
  }
  return bytes;
}

template <class Number>
std::vector<Number> numbers_of(const std::string& bytes) {
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
  return numbers;
}

TEST(LiveMessages, WriteBase64AsItsStandardHasIt) {
  const std::pair<std::string, std::string> kExamples[] = {
      {"", ""}, {"M", "TQ=="}, {"Ma", "TWE="}, {"Man", "TWFu"}, {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : kExamples) {
    EXPECT_EQ(base64(bytes), text);
    EXPECT_EQ(from_base64(text), bytes);
  }
}

TEST(LiveMessages, GreetWithCameraTemplateAndSettings) {
  const Template templ = testing::make_template({2, 2, 0.2, 0.15, 40, 30});
  const Camera camera = testing::make_camera();
  const json hello = json::parse(
      hello_message(scene_members(templ, camera), R"({"stages":[]})", R"({"stages":[1]})"));
  EXPECT_EQ(hello["type"], "hello");
  EXPECT_EQ(hello["weft"], "0.1.0");
  EXPECT_EQ(hello["camera"]["fx"], camera.fx);
  EXPECT_EQ(hello["camera"]["cy"], camera.cy);
  EXPECT_EQ(hello["camera"]["width_px"], 640);
  EXPECT_EQ(hello["camera"]["height_px"], 480);
  EXPECT_EQ(hello["settings"]["stages"].size(), 0U);
  EXPECT_EQ(hello["started_with"]["stages"].size(), 1U);
  const auto vertices =
      numbers_of<float>(from_base64(hello["template"]["vertices_m"].get<std::string>()));
  ASSERT_EQ(vertices.size(), 12U);
  for (std::int64_t v = 0; v < 4; ++v) {
    for (std::int64_t i = 0; i < 3; ++i) {
      EXPECT_FLOAT_EQ(vertices[static_cast<std::size_t>(3 * v + i)],
                      static_cast<float>(templ.vertices_m(v, i)));
    }
  }
  const auto faces =
      numbers_of<std::int32_t>(from_base64(hello["template"]["faces"].get<std::string>()));
  ASSERT_EQ(faces.size(), 6U);
  EXPECT_EQ(faces[5], templ.faces(1, 2));
  // The surface ends where its texture ends.
  const auto places = numbers_of<float>(from_base64(hello["template"]["uv"].get<std::string>()));
  ASSERT_EQ(places.size(), 8U);
  EXPECT_FLOAT_EQ(*std::min_element(places.begin(), places.end()), 0.0F);
  EXPECT_FLOAT_EQ(*std::max_element(places.begin(), places.end()), 1.0F);
  const auto texture = hello["template"]["texture"].get<std::string>();
  const std::string start = "data:image/jpeg;base64,";
  ASSERT_EQ(texture.substr(0, start.size()), start);
  EXPECT_EQ(from_base64(texture.substr(start.size())).substr(0, 3), "\xFF\xD8\xFF");
}

TEST(LiveMessages, GreetWithoutSettingsWhereThereAreNone) {
  const json hello = json::parse(hello_message(R"("weft":"x")", "", ""));
  EXPECT_TRUE(hello["settings"].is_null());
  EXPECT_FALSE(hello.contains("started_with")) << "it is the same";
}

TEST(LiveMessages, HoldAFramesPartsAtMultiplesOfFour) {
  FrameCopy frame;
  frame.frame = 7;
  frame.time_s = 0.5;
  frame.taken_ns = 12'250'000'000;
  frame.vertices_m = {1.0F, 2.0F, 3.0F};
  frame.visible = {1};
  for (const std::string report : {R"({})", R"({"a":1})", R"({"ab":1})", R"({"abc":1})"}) {
    frame.report = report;
    const Decoded decoded = decode(frame_message(frame, "jpeg!"));
    EXPECT_EQ(decoded.head["frame"], 7);
    EXPECT_EQ(decoded.head["time_s"], 0.5);
    EXPECT_EQ(decoded.head["taken_s"], 12.25);
    EXPECT_EQ(decoded.head["report"], json::parse(report));
    EXPECT_EQ(decoded.parts.at("image"), "jpeg!");
    EXPECT_EQ(numbers_of<float>(decoded.parts.at("vertices_m")), frame.vertices_m);
    EXPECT_EQ(decoded.parts.at("visible"), std::string(1, '\x01'));
  }
}

TEST(LiveMessages, LeaveOutWhatAFrameDoesNotHave) {
  const Decoded decoded = decode(frame_message(FrameCopy{}, ""));
  EXPECT_TRUE(decoded.head["time_s"].is_null());
  EXPECT_TRUE(decoded.head["report"].is_null());
  EXPECT_TRUE(decoded.parts.empty());
}

TEST(LiveMessages, HoldMatchesAndTruthOfAFrame) {
  Correspondences matches;
  matches.template_px = Array<double>({2, 2});
  matches.image_px = Array<double>({2, 2});
  matches.kept = Array<std::uint8_t>({2}, 1);
  matches.score = Array<double>({2}, 0.25);
  for (std::int64_t i = 0; i < 4; ++i) {
    matches.template_px.data()[i] = static_cast<double>(i);
    matches.image_px.data()[i] = 10.0 * static_cast<double>(i);
  }
  matches.kept(1) = 0;
  GroundTruth truth;
  truth.points_m = Array<double>({1, 3}, 0.5);
  truth.cloud_m = Array<double>({2, 3}, 0.75);
  FrameCopy frame;
  frame.written = 5;
  frame.matches = copy_of(matches, 40.0, 20.0);
  frame.truth_m = points_of(truth);
  Shape other;
  other.vertices_m = Array<double>({4, 3}, 0.25);
  frame.other_m = vertices_of(other);
  const Decoded decoded = decode(frame_message(frame, ""));
  EXPECT_EQ(decoded.head["written"], 5);
  EXPECT_EQ(decoded.head["matches"], 2);
  EXPECT_EQ(numbers_of<float>(decoded.parts.at("match_px")),
            (std::vector<float>{0.0F, 10.0F, 20.0F, 30.0F}));
  EXPECT_EQ(numbers_of<float>(decoded.parts.at("match_uv")),
            (std::vector<float>{0.5F / 40, 1.5F / 20, 2.5F / 40, 3.5F / 20}));
  EXPECT_EQ(decoded.parts.at("match_kept"), std::string("\x01\x00", 2));
  EXPECT_EQ(numbers_of<float>(decoded.parts.at("match_score")), (std::vector<float>{0.25F, 0.25F}));
  EXPECT_EQ(numbers_of<float>(decoded.parts.at("truth_m")).size(), 9U);
  EXPECT_EQ(numbers_of<float>(decoded.parts.at("other_m")), std::vector<float>(12, 0.25F));
}

TEST(LiveMessages, HoldAnEvenSelectionOfVeryManyMatches) {
  Correspondences matches;
  matches.template_px = Array<double>({10'000, 2}, 1.0);
  matches.image_px = Array<double>({10'000, 2});
  matches.kept = Array<std::uint8_t>({10'000}, 1);
  matches.score = Array<double>({10'000}, 1.0);
  for (std::int64_t i = 0; i < 10'000; ++i) matches.image_px(i, 0) = static_cast<double>(i);
  const MatchCopy copy = copy_of(matches, 40.0, 20.0);
  EXPECT_EQ(copy.count, 10'000);
  ASSERT_EQ(copy.score.size(), 4'000U);
  EXPECT_EQ(copy.px[2 * 2'000], 5'000.0F);
  EXPECT_EQ(copy.px[2 * 3'999], 9'997.0F);
}

TEST(LiveMessages, AnswerWithWordsOfAnyKind) {
  const json answer = json::parse(answer_message(3, 12, "\"no\"\n\xFF"));
  EXPECT_EQ(answer["number"], 3);
  EXPECT_EQ(answer["frame"], 12);
  EXPECT_THAT(answer["refusal"].get<std::string>(), HasSubstr("\"no\"\n"));
}

TEST(LiveMessages, OfClientsAreReadOrRefusedWithTheReason) {
  EXPECT_FALSE(parse_said(R"({"type":"ready"})")->is_change_request);
  const auto request = parse_said(R"({"type":"change_request","number":5,"text":"set a.b=1"})");
  ASSERT_TRUE(request);
  EXPECT_TRUE(request->is_change_request);
  EXPECT_EQ(request->number, 5U);
  EXPECT_EQ(request->text, "set a.b=1");
  const std::pair<std::string, std::string> kWrong[] = {
      {"", "no JSON object"},
      {"[1]", "no JSON object"},
      {"{\"type\":\"ready\"", "no JSON object"},
      {std::string(60'000, '['), "no JSON object"},
      {"{}", "without a type"},
      {R"({"type":5})", "without a type"},
      {R"({"type":"stop"})", "of another type than ready and change_request"},
      {R"({"type":"change_request","text":"pause"})", "without a number"},
      {R"({"type":"change_request","number":-1,"text":"pause"})", "without a number"},
      {R"({"type":"change_request","number":1.5,"text":"pause"})", "without a number"},
      {R"({"type":"change_request","number":1})", "without a text"},
      {R"({"type":"change_request","number":1,"text":"a\u0000b"})", "control character"}};
  for (const auto& [text, why] : kWrong) {
    const auto said = parse_said(text);
    ASSERT_FALSE(said) << text;
    EXPECT_THAT(said.error().message, HasSubstr(why)) << text;
  }
}

TEST(LiveMessages, MakePicturesSmallerWhenAsked) {
  Array<std::uint8_t> wide({30, 40, 3}, 90);
  const auto size_of = [](const std::string& jpeg) {
    // The marker of the frame's start is followed by length, precision, height and width.
    for (std::size_t i = 0; i + 8 < jpeg.size(); ++i) {
      if (jpeg[i] != '\xFF' || jpeg[i + 1] != '\xC0') continue;
      const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(jpeg[at]); };
      return std::pair(byte(i + 7) * 256 + byte(i + 8), byte(i + 5) * 256 + byte(i + 6));
    }
    return std::pair(0, 0);
  };
  EXPECT_EQ(size_of(jpeg_of(wide, {80, 0})), std::pair(40, 30));
  EXPECT_EQ(size_of(jpeg_of(wide, {80, 20})), std::pair(20, 15));
  EXPECT_EQ(size_of(jpeg_of(wide, {80, 90})), std::pair(40, 30));
  EXPECT_EQ(jpeg_of({}, {}), "");
  EXPECT_EQ(jpeg_of(Array<std::uint8_t>({0, 0}), {}), "");
}

}  // namespace
}  // namespace weft::live
