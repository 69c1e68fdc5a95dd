// SPDX-License-Identifier: Apache-2.0
#include "host/loading/processor.hpp"

#include <algorithm>
#include <fstream>

namespace weft::host {

std::vector<std::string> processor_features() {
  std::vector<std::string> features;
  const auto add = [&](const char* name, int supported) {
    if (supported != 0) features.emplace_back(name);
  };
  add("sse4.2", __builtin_cpu_supports("sse4.2"));
  add("avx", __builtin_cpu_supports("avx"));
  add("avx2", __builtin_cpu_supports("avx2"));
  add("fma", __builtin_cpu_supports("fma"));
  add("bmi2", __builtin_cpu_supports("bmi2"));
  add("avx512f", __builtin_cpu_supports("avx512f"));
  return features;
}

bool processor_has(std::string_view feature) {
  const std::vector<std::string> features = processor_features();
  return std::find(features.begin(), features.end(), feature) != features.end();
}

std::string processor_name() {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

}  // namespace weft::host
