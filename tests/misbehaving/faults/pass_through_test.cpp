// SPDX-License-Identifier: Apache-2.0
// The library of faults must not change a plugin in which it makes no fault.
#include <gmock/gmock.h>

#include "../misbehaving.hpp"
#include "host/describe/build_id.hpp"
#include "kit/testing/contract_cases.hpp"
#include "kit/testing/contract_stages.hpp"

namespace weft::misbehaving {
namespace {

/// The library of faults in front of a plugin, as a plugin of the same name.
void put_in_front_of(const std::string& plugin, const TemporaryFolder& folder) {
  const std::string installed = std::string(WEFT_PLUGIN_FOLDER) + "/" + plugin;
  const std::string faulty = std::string(WEFT_FAULTY_FOLDER) + "/filters_test_faulty.so";
  fs::copy_file(faulty, folder.path() / (plugin + ".so"));
  std::string manifest = read_file(installed + ".plugin.yaml");
  const std::string theirs = *host::read_build_id(installed + ".so");
  manifest.replace(manifest.find(theirs), theirs.size(), *host::read_build_id(faulty));
  write_file(folder / (plugin + ".plugin.yaml"), manifest);
  setenv("WEFT_FAULT_PLUGIN", (installed + ".so").c_str(), 1);
}

class PassedOn : public ::testing::TestWithParam<const char*> {};

TEST_P(PassedOn, PluginAnswersBitByBitAsWithoutTheLibraryOfFaults) {
  const std::string id = GetParam();
  std::string plugin = id;
  std::replace(plugin.begin(), plugin.end(), '/', '_');
  const TemporaryFolder folder;
  put_in_front_of(plugin, folder);
  const std::string own = folder.path().string();
  const auto plain = host::Registry::scan({{WEFT_PLUGIN_FOLDER, "test"}});
  const auto passed = host::Registry::scan({{own, "test"}, {WEFT_PLUGIN_FOLDER, "test"}});
  auto of_plain = testing::Subject::find(plain, id, "{}", "/tmp");
  auto of_passed = testing::Subject::find(passed, id, "{}", "/tmp");
  ASSERT_TRUE(of_plain && of_passed);
  EXPECT_TRUE(of_passed->spec().installed->library->library.starts_with(own));
  for (const auto& given : testing::cases_of(*of_plain)) {
    testing::Performer one(*of_plain), other(*of_passed);
    ASSERT_TRUE(one.begin(given.scene.templ, given.scene.camera));
    ASSERT_TRUE(other.begin(given.scene.templ, given.scene.camera));
    EXPECT_EQ(difference(other.call(kRunStage, given.inputs), one.call(kRunStage, given.inputs)),
              "")
        << given.name;
  }
  unsetenv("WEFT_FAULT_PLUGIN");
}

INSTANTIATE_TEST_SUITE_P(Faults, PassedOn,
                         ::testing::Values("detectors/orb", "matchers/descriptor", "filters/lpm",
                                           "warps/tps", "passes/near_shape",
                                           "solvers/bartoli_isometric"));

}  // namespace
}  // namespace weft::misbehaving
