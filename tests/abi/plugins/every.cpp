// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <sstream>
#include <weft/core/mistakes.hpp>
#include <weft/sdk/detector.hpp>
#include <weft/sdk/device.hpp>

namespace kept {

/// Descriptors that only this library reads in place.
class Remote {
 public:
  explicit Remote(std::vector<float> numbers) : numbers_(std::move(numbers)) {}

  weft::Result<void> download(std::span<std::byte> to,
                              const std::function<bool()>& cancelled) const {
    if (cancelled()) return weft::Error{weft::Errc::cancelled, "cancelled", {}};
    std::memcpy(to.data(), numbers_.data(), to.size());
    return {};
  }

 private:
  std::vector<float> numbers_;
};

enum class Word { first, second };

/// The answer of the nested detector. It reports all parameters in an array, and the frame selects
/// the status.
struct Every final : weft::Detector {
  static constexpr weft::About kAbout{.reads = "region",
                                      .device_memory = &weft::kDeviceMemory<Remote>};
  static constexpr weft::Sweep kSweep{"number", {0.25, 0.5, 1.0}};
  double number = 0.5;
  std::int64_t integer = -3;
  bool flag = true;
  Word word = Word::first;
  std::string text = "a text", input = "auto", output = "every.txt";
  weft::DetectorComponent nested{"detectors/kept.small"};
  std::vector<std::pair<std::string, std::string>> labels;
  std::vector<double> numbers{0.5, 0.25};
  std::vector<std::int64_t> integers{1, -2};
  std::vector<std::string> texts{"one", "two"};

  explicit Every(weft::Params& p) {
    p.read("number", number, "px", {0, 8}, "a number");
    p.read("integer", integer, "", {-9007199254740992.0, 9007199254740992.0}, "an integer");
    p.read("flag", flag, "a truth value");
    p.choice("word", word, {{"first", Word::first}, {"second", Word::second}}, "one of two words");
    p.text("text", text, "a text");
    p.input_path("input", input, "an input", weft::Need::optional, {"auto"});
    p.output_path("output", output, "an output");
    p.component("nested", nested, "the nested detector");
    p.labels("labels", labels, "texts by name");
    p.read("numbers", numbers, "px", {-8, 8}, "numbers");
    p.read("integers", integers, "", {-8, 8}, "integers");
    p.formerly("words").read("texts", texts, "texts");
  }

  static std::vector<std::string> devices() { return {"a device", "another device"}; }

  void check(weft::Mistakes& mistakes) const {
    if (number > 4.0) mistakes.add("number", "exceeds 4");
    if (!flag) mistakes.doubt("flag", "is false");
  }

  weft::Result<weft::Keypoints> detect(const weft::DetectorInput& in) override {
    if (in.call.frame() == 2) return weft::no_result("no result in frame 2");
    if (in.call.frame() == 3) return weft::Error{weft::Errc::unsupported, "error in frame 3", {}};
    if (in.call.frame() == 4) return weft::Error{weft::Errc::cancelled, "cancelled", {}};
    auto found = nested.detect(in);
    if (!found) return found.error();
    const weft::Array<float>& there = found->descriptors;
    found->descriptors = weft::on_device<float>(std::make_shared<const Remote>(std::vector<float>(
                                                    there.data(), there.data() + there.size())),
                                                {there.dim(0), there.dim(1)});
    const std::string values = described();
    weft::Array<std::uint8_t> bytes({static_cast<std::int64_t>(values.size())});
    std::memcpy(bytes.data(), values.data(), values.size());
    found->others.set("x.kept.values", std::move(bytes));
    found->others.set("x.kept.any", weft::Array<std::uint64_t>({2, 0, 1}, 0));
    if (in.call.frame() == 1) return weft::degenerate(*std::move(found), "degenerate in frame 1");
    return found;
  }

 private:
  std::string described() const {
    const auto file_name = [](const std::string& path) { return path.substr(path.rfind('/') + 1); };
    std::ostringstream out;
    out << number << ' ' << integer << ' ' << flag << ' ' << (word == Word::first ? 1 : 2) << " '"
        << text << "' " << file_name(input) << ' ' << file_name(output);
    for (const auto& [key, label] : labels) out << ' ' << key << '=' << label;
    for (const double each : numbers) out << ' ' << each;
    for (const std::int64_t each : integers) out << ' ' << each;
    for (const std::string& each : texts) out << " '" << each << "'";
    return out.str();
  }
};

}  // namespace kept

WEFT_PLUGIN(kept::Every, "detectors/kept.every", "1.0.0", "Has every parameter and extension.")
