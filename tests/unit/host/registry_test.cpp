// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "misbehaving/misbehaving.hpp"

namespace weft::host {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;
using misbehaving::TemporaryFolder;

/// Sets a variable of the environment for one test.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    setenv(name, value.c_str(), 1);
  }
  ~Variable() {
    if (before_) {
      setenv(name_, before_->c_str(), 1);
    } else {
      unsetenv(name_);
    }
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

std::string folder_of(const Registry& registry, const std::string& id) {
  const Installed* installed = registry.find(id);
  return installed == nullptr ? "" : fs::path(installed->library->library).parent_path().string();
}

TEST(SearchPath, IsWhatWasGivenThenTheVariableThenBesideTheProgram) {
  const Variable variable("WEFT_PLUGIN_PATH", "/one::/two");
  const std::vector<SearchFolder> folders = search_path({"/given", "/also"});
  ASSERT_GE(folders.size(), 4U);
  EXPECT_EQ(folders[0].path, "/given");
  EXPECT_EQ(folders[0].origin, "--plugin-path");
  EXPECT_EQ(folders[1].path, "/also");
  EXPECT_EQ(folders[2].path, "/one");
  EXPECT_EQ(folders[2].origin, "WEFT_PLUGIN_PATH");
  EXPECT_EQ(folders[3].path, "/two");
  if (folders.size() > 4) {
    EXPECT_EQ(folders[4].origin, "beside the program");
  }
}

TEST(Registry, TheFirstFolderWithAnIdWinsAndTheOtherIsShown) {
  const TemporaryFolder first, second;
  first.adopt("filters_test_good");
  second.adopt("filters_test_good");
  second.adopt("filters_test_throws");
  const Registry registry = Registry::scan({{first.path(), "a"}, {second.path(), "b"}});
  EXPECT_TRUE(registry.refusals().empty());
  EXPECT_EQ(folder_of(registry, "filters/test_good"), first.path().string());
  EXPECT_EQ(registry.find("filters/test_good")->origin, "a");
  EXPECT_EQ(folder_of(registry, "filters/test_throws"), second.path().string());
  int shadowed = 0;
  for (const Installed& entry : registry.installed()) {
    if (!entry.shadowed) continue;
    ++shadowed;
    EXPECT_EQ(entry.origin, "b");
  }
  EXPECT_EQ(shadowed, 3);  // the three components of the good library
  const Registry reversed = Registry::scan({{second.path(), "b"}, {first.path(), "a"}});
  EXPECT_EQ(folder_of(reversed, "filters/test_good"), second.path().string());
}

TEST(Registry, TheOrderOfTheVariableDecides) {
  const TemporaryFolder first, second;
  first.adopt("filters_test_good");
  second.adopt("filters_test_good");
  const std::string one = first.path().string(), two = second.path().string();
  {
    const Variable variable("WEFT_PLUGIN_PATH", one + ":" + two);
    EXPECT_EQ(folder_of(Registry::scan(search_path({})), "filters/test_good"), one);
    EXPECT_EQ(folder_of(Registry::scan(search_path({two})), "filters/test_good"), two);
  }
  const Variable variable("WEFT_PLUGIN_PATH", two + ":" + one);
  EXPECT_EQ(folder_of(Registry::scan(search_path({})), "filters/test_good"), two);
}

TEST(Registry, AFolderNamedTwiceCountsOnce) {
  const TemporaryFolder folder;
  folder.adopt("filters_test_good");
  const std::string path = folder.path();
  const Registry registry =
      Registry::scan({{path, "a"}, {path + "/../" + folder.path().filename().string(), "b"}});
  EXPECT_EQ(registry.folders().size(), 1U);
  EXPECT_TRUE(registry.refusals().empty());
  EXPECT_EQ(registry.installed().size(), 3U);
}

TEST(Registry, ARefusedLibraryDoesNotHideTheSameIdInALaterFolder) {
  const TemporaryFolder first, second;
  first.adopt("filters_test_good");
  misbehaving::write_file(first / "filters_test_good.so", "no library");
  second.adopt("filters_test_good");
  const Registry registry = Registry::scan({{first.path(), "a"}, {second.path(), "b"}});
  EXPECT_EQ(registry.refusals().size(), 1U);
  EXPECT_EQ(folder_of(registry, "filters/test_good"), second.path().string());
}

TEST(Registry, ALoopOfLinksIsRefusedAndTheOthersAreUsable) {
  const TemporaryFolder folder;
  folder.adopt("filters_test_good");
  folder.adopt("filters_test_throws");
  const std::string loop = folder / "loop.so", library = folder / "filters_test_throws.so";
  fs::create_symlink(loop, loop);
  fs::remove(library);
  fs::create_symlink(library, library);
  const Registry registry = Registry::scan({{folder.path(), "a"}});
  EXPECT_NE(registry.find("filters/test_good"), nullptr);
  EXPECT_EQ(registry.refusals().size(), 2U);
  for (const char* name : {"loop.so", "filters_test_throws.so"}) {
    EXPECT_THAT(misbehaving::refusal_of(registry, name).cause,
                HasSubstr("cannot be read: Too many levels of symbolic links"));
  }
}

TEST(Registry, ExplainsWhatIsMissing) {
  const Registry registry = misbehaving::scan();
  EXPECT_EQ(registry.find("filters/test_god"), nullptr);
  EXPECT_THAT(registry.explain_missing("filters/test_god"),
              HasSubstr("did you mean 'filters/test_good'?"));
  EXPECT_THAT(
      registry.explain_missing("completely/different"),
      AllOf(HasSubstr("an id begins with one of these roles: filters, passes, sinks, warps"),
            HasSubstr("--plugin-path")));
}

TEST(Manifest, SaysWhatTheSourceDeclares) {
  const auto manifest = read_manifest(misbehaving::kFolder + "/filters_test_good.plugin.yaml");
  ASSERT_TRUE(manifest) << manifest.error().message;
  EXPECT_EQ(manifest->library, misbehaving::library("filters_test_good"));
  EXPECT_EQ(manifest->abi_major, WEFT_ABI_MAJOR);
  EXPECT_EQ(manifest->abi_minor, WEFT_ABI_MINOR);
  EXPECT_FALSE(manifest->compiler.empty());
  ASSERT_EQ(manifest->components.size(), 3U);
  const ComponentManifest& good = manifest->components[0];
  EXPECT_EQ(good.id, "filters/test_good");
  EXPECT_EQ(good.role(), "filters");
  EXPECT_EQ(good.version, "1.2.3");
  EXPECT_EQ(good.summary, "Keeps every match; \"quoted\", \\ and all.");
  EXPECT_EQ(good.implements, "own");
  EXPECT_EQ(good.licence, "Apache-2.0");
  EXPECT_EQ(good.determinism, "exact");
  EXPECT_THAT(good.reads, ::testing::ElementsAre("template"));
  EXPECT_TRUE(good.needs.empty());
  EXPECT_TRUE(good.random);
  EXPECT_FALSE(good.uses_truth);
  ASSERT_EQ(good.parameters.size(), 13U);
  const ParameterSpec& length = good.parameters[0];
  EXPECT_EQ(length.name, "length_mm");
  EXPECT_EQ(length.unit, "mm");
  EXPECT_EQ(length.help, "a length");
  EXPECT_TRUE(length.bounded);
  EXPECT_EQ(length.minimum, 0.0);
  EXPECT_EQ(length.maximum, 100.0);
  EXPECT_EQ(yaml::as_double(length.default_value), 12.5);
  EXPECT_FALSE(good.parameters[1].bounded);
  EXPECT_THAT(good.parameters[4].choices, ::testing::ElementsAre("red", "green", "blue"));
  EXPECT_TRUE(good.parameters[5].is_vector);
  EXPECT_EQ(good.parameters[10].role, "warps");
  const ParameterSpec &steps = good.parameters[11], &words = good.parameters[12];
  EXPECT_EQ(steps.type, WEFT_VALUE_I64);
  EXPECT_TRUE(steps.is_vector);
  ASSERT_EQ(steps.default_value.items.size(), 2U);
  EXPECT_EQ(yaml::as_int64(steps.default_value.items[1]), -4);
  EXPECT_EQ(words.type, WEFT_VALUE_TEXT);
  EXPECT_TRUE(words.is_vector);
  ASSERT_EQ(words.default_value.items.size(), 2U);
  EXPECT_EQ(words.default_value.items[1].scalar, "three");
  for (const ParameterSpec& parameter : manifest->components[1].parameters) {
    EXPECT_TRUE(parameter.required) << parameter.name;
  }
}

}  // namespace
}  // namespace weft::host
