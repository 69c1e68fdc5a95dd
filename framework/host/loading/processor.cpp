// SPDX-License-Identifier: Apache-2.0
#include "host/loading/processor.hpp"

#ifdef __x86_64__
#include <cpuid.h>
#endif

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>

namespace weft::host {
namespace {

/// Answers of the instruction CPUID, as processors number them.
enum Leaf : std::uint8_t { kBasic, kExtended, kExtended1, kAmd, kLeaves };
enum Register : std::uint8_t { kEax, kEbx, kEcx, kEdx, kRegisters };

/// Register state that the system must save for each thread (register XCR0).
constexpr std::uint64_t kAvxState = 0x6, kAvx512State = 0xE6, kAmxState = 0x60000,
                        kApxState = 0x80000;

struct Feature {
  const char* name;
  /// Name in Linux's /proc/cpuinfo; empty if Linux 6.1, the oldest supported version, does not list
  /// the feature.
  std::string_view kernel_name;
  Leaf leaf;
  Register place;
  int bit;
  std::uint64_t state;
};

/// All that weft/sdk/isa.hpp names.
constexpr Feature kFeatures[] = {
    {"sse3", "pni", kBasic, kEcx, 0, 0},
    {"ssse3", "ssse3", kBasic, kEcx, 9, 0},
    {"sse4.1", "sse4_1", kBasic, kEcx, 19, 0},
    {"sse4.2", "sse4_2", kBasic, kEcx, 20, 0},
    {"sse4a", "sse4a", kAmd, kEcx, 6, 0},
    {"popcnt", "popcnt", kBasic, kEcx, 23, 0},
    {"lzcnt", "abm", kAmd, kEcx, 5, 0},
    {"bmi", "bmi1", kExtended, kEbx, 3, 0},
    {"bmi2", "bmi2", kExtended, kEbx, 8, 0},
    {"tbm", "tbm", kAmd, kEcx, 21, 0},
    {"movbe", "movbe", kBasic, kEcx, 22, 0},
    {"adx", "adx", kExtended, kEbx, 19, 0},
    {"cx16", "cx16", kBasic, kEcx, 13, 0},
    {"sahf", "lahf_lm", kAmd, kEcx, 0, 0},
    {"cmpccxadd", "", kExtended1, kEax, 7, 0},
    {"aes", "aes", kBasic, kEcx, 25, 0},
    {"pclmul", "pclmulqdq", kBasic, kEcx, 1, 0},
    {"sha", "sha_ni", kExtended, kEbx, 29, 0},
    {"gfni", "gfni", kExtended, kEcx, 8, 0},
    {"rdrnd", "rdrand", kBasic, kEcx, 30, 0},
    {"rdseed", "rdseed", kExtended, kEbx, 18, 0},
    {"avx", "avx", kBasic, kEcx, 28, kAvxState},
    {"avx2", "avx2", kExtended, kEbx, 5, kAvxState},
    {"fma", "fma", kBasic, kEcx, 12, kAvxState},
    {"fma4", "fma4", kAmd, kEcx, 16, kAvxState},
    {"xop", "xop", kAmd, kEcx, 11, kAvxState},
    {"f16c", "f16c", kBasic, kEcx, 29, kAvxState},
    {"vaes", "vaes", kExtended, kEcx, 9, kAvxState},
    {"vpclmulqdq", "vpclmulqdq", kExtended, kEcx, 10, kAvxState},
    {"avxvnni", "avx_vnni", kExtended1, kEax, 4, kAvxState},
    {"avxifma", "", kExtended1, kEax, 23, kAvxState},
    {"avxvnniint8", "", kExtended1, kEdx, 4, kAvxState},
    {"avxvnniint16", "", kExtended1, kEdx, 10, kAvxState},
    {"avxneconvert", "", kExtended1, kEdx, 5, kAvxState},
    {"sha512", "", kExtended1, kEax, 0, kAvxState},
    {"sm3", "", kExtended1, kEax, 1, kAvxState},
    {"sm4", "", kExtended1, kEax, 2, kAvxState},
    {"avx512f", "avx512f", kExtended, kEbx, 16, kAvx512State},
    {"avx512cd", "avx512cd", kExtended, kEbx, 28, kAvx512State},
    {"avx512vl", "avx512vl", kExtended, kEbx, 31, kAvx512State},
    {"avx512bw", "avx512bw", kExtended, kEbx, 30, kAvx512State},
    {"avx512dq", "avx512dq", kExtended, kEbx, 17, kAvx512State},
    {"avx512ifma", "avx512ifma", kExtended, kEbx, 21, kAvx512State},
    {"avx512vbmi", "avx512vbmi", kExtended, kEcx, 1, kAvx512State},
    {"avx512vbmi2", "avx512_vbmi2", kExtended, kEcx, 6, kAvx512State},
    {"avx512vnni", "avx512_vnni", kExtended, kEcx, 11, kAvx512State},
    {"avx512bitalg", "avx512_bitalg", kExtended, kEcx, 12, kAvx512State},
    {"avx512vpopcntdq", "avx512_vpopcntdq", kExtended, kEcx, 14, kAvx512State},
    {"avx512bf16", "avx512_bf16", kExtended1, kEax, 5, kAvx512State},
    {"avx512fp16", "avx512_fp16", kExtended, kEdx, 23, kAvx512State},
    {"avx512vp2intersect", "avx512_vp2intersect", kExtended, kEdx, 8, kAvx512State},
    {"avx512er", "avx512er", kExtended, kEbx, 27, kAvx512State},
    {"avx512pf", "avx512pf", kExtended, kEbx, 26, kAvx512State},
    {"amx-tile", "amx_tile", kExtended, kEdx, 24, kAmxState},
    {"amx-int8", "amx_int8", kExtended, kEdx, 25, kAmxState},
    {"amx-bf16", "amx_bf16", kExtended, kEdx, 22, kAmxState},
    {"amx-fp16", "", kExtended1, kEax, 21, kAmxState},
    {"amx-complex", "", kExtended1, kEdx, 8, kAmxState},
    {"apxf", "", kExtended1, kEdx, 21, kApxState},
};

using Answers = std::array<std::array<std::uint32_t, kRegisters>, kLeaves>;

#ifdef __x86_64__
Answers ask_processor() {
  Answers answers{};
  const auto ask = [&](Leaf leaf, std::uint32_t number, std::uint32_t part) {
    auto& [a, b, c, d] = answers[leaf];
    if (__get_cpuid_count(number, part, &a, &b, &c, &d) == 0) answers[leaf] = {};
  };
  ask(kBasic, 1, 0);
  ask(kExtended, 7, 0);
  // Beyond the last part, which register EAX reports, the processor returns arbitrary values.
  if (answers[kExtended][kEax] >= 1) ask(kExtended1, 7, 1);
  ask(kAmd, 0x80000001U, 0);
  return answers;
}

/// Register XCR0; 0 where the system does not save more than SSE needs.
std::uint64_t saved_state(const Answers& answers) {
  constexpr std::uint32_t kOsxsave = 1U << 27U;
  if ((answers[kBasic][kEcx] & kOsxsave) == 0) return 0;
  std::uint32_t low = 0, high = 0;
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return (std::uint64_t{high} << 32U) | low;
}
#else
Answers ask_processor() { return {}; }
std::uint64_t saved_state(const Answers&) { return 0; }
#endif

/// True if the kernel lists a feature, or if there is no list or no name to look for.
bool lists(std::string_view flags, std::string_view name) {
  if (flags.empty() || name.empty()) return true;
  const std::string words = " " + std::string(flags) + " ";
  return words.find(" " + std::string(name) + " ") != std::string::npos;
}

}  // namespace

std::string kernel_flags() {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("flags")) return line.substr(line.find(':') + 1);
  }
  return {};
}

std::vector<std::string> processor_features(std::string_view flags) {
  const Answers answers = ask_processor();
  const std::uint64_t saved = saved_state(answers);
  std::vector<std::string> features;
  for (const Feature& feature : kFeatures) {
    const bool has = (answers[feature.leaf][feature.place] >> feature.bit & 1U) != 0;
    if (!has || (saved & feature.state) != feature.state) continue;
    if (lists(flags, feature.kernel_name)) features.emplace_back(feature.name);
  }
  return features;
}

bool processor_has(std::string_view feature) {
  const std::vector<std::string> features = processor_features(kernel_flags());
  return std::find(features.begin(), features.end(), feature) != features.end();
}

bool is_processor_feature(std::string_view name) {
  return std::any_of(std::begin(kFeatures), std::end(kFeatures),
                     [&](const Feature& feature) { return feature.name == name; });
}

std::string processor_name() {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

}  // namespace weft::host
