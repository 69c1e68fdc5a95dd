// SPDX-License-Identifier: Apache-2.0
// Libraries that were built with a sanitizer: a program without it detects them before it loads
// them. tests/abi/pairings builds real ones.
#include "host/loading/sanitizer.hpp"

#include <dlfcn.h>
#include <gmock/gmock.h>

#include "host/describe/build_id.hpp"
#include "misbehaving.hpp"
#include "support/child.hpp"

namespace weft::misbehaving {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A library of this source, NAME.so.
std::string built(const TemporaryFolder& folder, const std::string& name,
                  const std::string& source) {
  write_file(folder / (name + ".cpp"), source);
  const std::string library = folder / (name + ".so");
  const testing::Ended ended =
      testing::Child({WEFT_CXX_PROGRAM, "-shared", "-fPIC", "-Wl,--build-id=sha1",
                      folder / (name + ".cpp"), "-o", library},
                     folder / "compiler")
          .wait();
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  return library;
}

const std::string kMemory =
    "extern \"C\" void __msan_init();\n"
    "struct Start { Start() { __msan_init(); } } start;\n";

TEST(ALibraryOfASanitizer, IsRefusedByItsNameBeforeItIsLoaded) {
  const TemporaryFolder folder;
  const std::string library = built(folder, "filters_test_sanitized", kMemory);
  const auto missing = host::missing_sanitizer(library);
  ASSERT_TRUE(missing);
  EXPECT_THAT(missing->cause, HasSubstr("is built with MemorySanitizer"));
  EXPECT_THAT(missing->fix, HasSubstr("rebuild it without -fsanitize=memory"));
  const auto table = host::load_library(library);
  ASSERT_FALSE(table);
  EXPECT_EQ(table.error().code, Errc::incompatible);
  EXPECT_EQ(table.error().where, library);
  EXPECT_THAT(table.error().message, AllOf(HasSubstr(missing->cause), HasSubstr(missing->fix)));
}

TEST(ALibraryOfASanitizer, HasNoManifestForThatReason) {
  const TemporaryFolder folder;
  built(folder, "filters_test_sanitized", kMemory);
  EXPECT_THAT(scan(folder.path()).explain_missing("filters/test_sanitized"),
              AllOf(HasSubstr("it is built with MemorySanitizer"), HasSubstr("rebuild it")));
}

TEST(ALibraryOfASanitizer, IsRefusedThoughItHasAManifest) {
  const TemporaryFolder folder;
  folder.adopt("filters_test_good");
  built(folder, "filters_test_good", kMemory);
  std::string manifest = read_file(folder / "filters_test_good.plugin.yaml");
  const std::string key = "build_id: ";
  const std::size_t start = manifest.find(key) + key.size();
  manifest.replace(start, manifest.find('\n', start) - start,
                   '"' + *host::read_build_id(folder / "filters_test_good.so") + '"');
  write_file(folder / "filters_test_good.plugin.yaml", manifest);
  EXPECT_THAT(refusal_of(scan(folder.path()), "filters_test_good.so").cause,
              HasSubstr("it is built with MemorySanitizer"));
}

TEST(ALibraryOfASanitizer, IsUsedWhereTheRuntimeIsThere) {
  const TemporaryFolder folder;
  const std::string library = built(folder, "calls",
                                    "extern \"C\" void __hwasan_init();\n"
                                    "void start() { __hwasan_init(); }\n");
  EXPECT_TRUE(host::missing_sanitizer(library));
  const std::string runtime = built(folder, "runtime", "extern \"C\" void __hwasan_init() {}\n");
  void* const loaded = dlopen(runtime.c_str(), RTLD_NOW | RTLD_GLOBAL);
  ASSERT_NE(loaded, nullptr) << dlerror();
  EXPECT_FALSE(host::missing_sanitizer(library));
  dlclose(loaded);
}

TEST(ALibraryWithoutASanitizer, LacksNone) {
  EXPECT_FALSE(host::missing_sanitizer(library("filters_test_good")));
  EXPECT_FALSE(host::missing_sanitizer("/absent.so"));
}

}  // namespace
}  // namespace weft::misbehaving
