// SPDX-License-Identifier: Apache-2.0
// The compiler refuses an invalid component with a readable message. The headers' promises about
// compilers hold.
#include <gmock/gmock.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "host/loading/processor.hpp"
#include "misbehaving.hpp"
#include "support/child.hpp"

namespace weft::misbehaving {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// The compiler, with nothing but the installed headers on its path: no Eigen.
testing::Ended compiled(const std::string& file, const std::vector<std::string>& options,
                        const TemporaryFolder& folder) {
  std::vector<std::string> command{WEFT_CXX_PROGRAM, "-std=c++20", "-I" WEFT_INCLUDE};
  command.insert(command.end(), options.begin(), options.end());
  command.push_back(file);
  return testing::Child(command, folder / "compiler").wait();
}

TEST(MistakenComponents, AreRefusedByTheCompilerEachInASentence) {
  const TemporaryFolder folder;
  const testing::Ended ended = compiled(WEFT_SOURCES "/mistaken.cpp", {"-fsyntax-only"}, folder);
  EXPECT_NE(ended.exit_code, 0);
  for (const char* sentence : {"kAbout of a component is public and a weft::About",
                               "a component calls its weft::About kAbout",
                               "the id of a component begins with the role of its class",
                               "an id reads", "overrides each method that its role leaves open",
                               "has the public constructor `explicit Mine(weft::Params&)`"}) {
    EXPECT_THAT(ended.err, HasSubstr(sentence));
  }
}

TEST(HeadersWithoutEigen, SayWhichOneMakesMatricesOfArrays) {
  const TemporaryFolder folder;
  const std::string file = folder / "matrices.cpp";
  write_file(file,
             "#include <weft/data/array.hpp>\n"
             "double first(const weft::Array<double>& a) { return a.matrix<2>()(0, 0); }\n"
             "weft::Array<double> made(double x) { return weft::make_array<double>(x); }\n");
  const testing::Ended ended = compiled(file, {"-fsyntax-only"}, folder);
  EXPECT_NE(ended.exit_code, 0);
  for (const char* what : {"array.matrix<N>()", "make_array()"}) {
    EXPECT_THAT(ended.err, HasSubstr(std::string(what) + " works with Eigen matrices: #include "
                                                         "<weft/data/matrix.hpp>"));
  }
}

/// The CPU features that a library compiled with this option declares.
std::set<std::string> features_with(const std::string& option, const TemporaryFolder& folder) {
  const std::string file = folder / "isa.cpp";
  write_file(file, "#include <weft/sdk/isa.hpp>\n");
  const testing::Ended ended = compiled(file, {"-E", "-P", option}, folder);
  EXPECT_EQ(ended.exit_code, 0) << option << ": " << ended.err;
  std::set<std::string> features;
  std::size_t at = ended.out.find("kIsa[]");
  while ((at = ended.out.find('"', at)) != std::string::npos) {
    const std::size_t end = ended.out.find('"', at + 1);
    std::istringstream words(ended.out.substr(at + 1, end - at - 1));
    for (std::string word; words >> word;) features.insert(word);
    at = end + 1;
  }
  return features;
}

#ifdef __x86_64__
TEST(ProcessorFeatures, AreNamedForEachOptionAndKnownToTheHost) {
  const TemporaryFolder folder;
  EXPECT_THAT(features_with("-march=x86-64", folder), ::testing::IsEmpty());
  for (const std::string name : {"sse3",
                                 "ssse3",
                                 "sse4.1",
                                 "sse4.2",
                                 "sse4a",
                                 "popcnt",
                                 "lzcnt",
                                 "bmi",
                                 "bmi2",
                                 "tbm",
                                 "movbe",
                                 "adx",
                                 "cx16",
                                 "sahf",
                                 "aes",
                                 "pclmul",
                                 "sha",
                                 "gfni",
                                 "rdrnd",
                                 "rdseed",
                                 "avx",
                                 "avx2",
                                 "fma",
                                 "fma4",
                                 "xop",
                                 "f16c",
                                 "vaes",
                                 "vpclmulqdq",
                                 "avxvnni",
                                 "avx512f",
                                 "avx512cd",
                                 "avx512vl",
                                 "avx512bw",
                                 "avx512dq",
                                 "avx512ifma",
                                 "avx512vbmi",
                                 "avx512vbmi2",
                                 "avx512vnni",
                                 "avx512bitalg",
                                 "avx512vpopcntdq",
                                 "avx512bf16",
                                 "avx512fp16",
                                 "avx512vp2intersect",
                                 "amx-tile",
                                 "amx-int8",
                                 "amx-bf16"}) {
    EXPECT_THAT(features_with("-m" + name, folder), ::testing::Contains(name));
  }
  for (const std::string processor : {"sapphirerapids", "znver3", "bdver4", "tigerlake", "knl"}) {
    const std::set<std::string> features = features_with("-march=" + processor, folder);
    EXPECT_GE(features.size(), 15U) << processor;
    for (const std::string& feature : features) {
      EXPECT_TRUE(host::is_processor_feature(feature)) << feature;
    }
  }
}

/// The compiler's own reading of CPUID, which no list of the kernel changes.
const std::vector<std::pair<std::string, bool>>& compiler_features() {
  __builtin_cpu_init();
#define WEFT_COMPILED_FOR(name) \
  std::pair<std::string, bool> { name, __builtin_cpu_supports(name) != 0 }
  static const std::vector<std::pair<std::string, bool>> kFeatures{
      WEFT_COMPILED_FOR("sse3"),       WEFT_COMPILED_FOR("ssse3"),
      WEFT_COMPILED_FOR("sse4.1"),     WEFT_COMPILED_FOR("sse4.2"),
      WEFT_COMPILED_FOR("sse4a"),      WEFT_COMPILED_FOR("popcnt"),
      WEFT_COMPILED_FOR("bmi"),        WEFT_COMPILED_FOR("bmi2"),
      WEFT_COMPILED_FOR("aes"),        WEFT_COMPILED_FOR("pclmul"),
      WEFT_COMPILED_FOR("gfni"),       WEFT_COMPILED_FOR("avx"),
      WEFT_COMPILED_FOR("avx2"),       WEFT_COMPILED_FOR("fma"),
      WEFT_COMPILED_FOR("fma4"),       WEFT_COMPILED_FOR("xop"),
      WEFT_COMPILED_FOR("vpclmulqdq"), WEFT_COMPILED_FOR("avx512f"),
      WEFT_COMPILED_FOR("avx512cd"),   WEFT_COMPILED_FOR("avx512vl"),
      WEFT_COMPILED_FOR("avx512bw"),   WEFT_COMPILED_FOR("avx512dq"),
      WEFT_COMPILED_FOR("avx512ifma"), WEFT_COMPILED_FOR("avx512vbmi"),
      WEFT_COMPILED_FOR("avx512vnni"), WEFT_COMPILED_FOR("avx512bitalg")};
#undef WEFT_COMPILED_FOR
  return kFeatures;
}

TEST(ProcessorFeatures, AreThoseThatTheCompilerReadsWhereTheKernelListsNothing) {
  const std::vector<std::string> features = host::processor_features("");
  for (const auto& [name, is_enabled] : compiler_features()) {
    EXPECT_EQ(std::count(features.begin(), features.end(), name), is_enabled ? 1 : 0) << name;
  }
}

TEST(ProcessorFeatures, AreNoneThatTheKernelHidesThoughTheProcessorHasThem) {
  const std::vector<std::string> all = host::processor_features("");
  const std::vector<std::string> masked = host::processor_features(" fpu sse4_2 ");
  EXPECT_EQ(std::count(masked.begin(), masked.end(), "sse4.2"),
            std::count(all.begin(), all.end(), "sse4.2"));
  for (const char* hidden : {"sse3", "sse4.1", "lzcnt", "sse4a", "avx", "avx2", "fma"}) {
    EXPECT_THAT(masked, Not(::testing::Contains(hidden)));
  }
  // Linux 6.1 has no name for these, so that its silence means nothing.
  for (const char* unlisted : {"avxvnniint8", "sha512", "amx-complex"}) {
    EXPECT_EQ(std::count(masked.begin(), masked.end(), unlisted),
              std::count(all.begin(), all.end(), unlisted))
        << unlisted;
  }
}
#endif

testing::Ended describe(const std::string& library, const std::string& manifest,
                        const std::string& id, const TemporaryFolder& folder) {
  return testing::Child({WEFT_DESCRIBE, library, manifest, id}, folder / "describe").wait();
}

TEST(WeftDescribe, RefusesAnIdThatTheBuildDoesNotName) {
  const TemporaryFolder folder;
  const std::string good = library("filters_test_good"), manifest = folder / "good.plugin.yaml";
  const testing::Ended refused = describe(good, manifest, "filters/test_better", folder);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("its first component is 'filters/test_good', and "
                                     "weft_add_plugin() builds 'filters/test_better': give both "
                                     "the same id"));
  EXPECT_FALSE(fs::exists(manifest));
  EXPECT_EQ(describe(good, manifest, "filters/test_good", folder).exit_code, 0);
  EXPECT_EQ(read_file(manifest), read_file(kFolder + "/filters_test_good.plugin.yaml"));
}

TEST(WeftDescribe, SaysWhatALibraryDoesInsteadOfDescribingItself) {
  struct Case {
    std::string action, says;
  };
  // A sanitizer ends what it has reported.
#ifdef __SANITIZE_THREAD__
  const std::string fault = "exit(66)";
#elif defined(WEFT_SANITIZED)
  const std::string fault = "exit(1)";
#else
  const std::string fault = "signal 11";
#endif
  for (const auto& [action, says] :
       {Case{"fault", "it ends the process that loads it by " + fault},
        Case{"exit", "it ends the process that loads it by exit(0)"},
        Case{"leave", "it ends the process that loads it by exit(7)"},
        Case{"throw",
             "its constructor failed while it declared its parameters (threw: no such table); it "
             "should read them all and do nothing else: files and checks belong in prepare()"}}) {
    const TemporaryFolder folder;
    const std::string manifest = folder / "falls.plugin.yaml";
    setenv("WEFT_FALLS", action.c_str(), 1);
    const testing::Ended ended = describe(WEFT_FALLS_FOLDER "/filters_test_falls.so", manifest,
                                          "filters/test_falls", folder);
    unsetenv("WEFT_FALLS");
    EXPECT_EQ(ended.exit_code, 1) << action;
    EXPECT_THAT(ended.err, HasSubstr(says));
    EXPECT_FALSE(fs::exists(manifest)) << action;
  }
}

TEST(WeftDescribe, SaysOfALibraryThatCannotBeLoadedWhy) {
  const TemporaryFolder folder;
  for (const auto& [name, says] : {std::pair("no_symbol", "exports no symbol 'weft_library'"),
                                   std::pair("wrong_magic", "is no Weft library table"),
                                   std::pair("wrong_abi", "needs plugin ABI"),
                                   std::pair("needs_missing", "libtest_absent.so")}) {
    const std::string id = std::string("filters/test_") + name;
    const testing::Ended ended = describe(library(std::string("filters_test_") + name),
                                          folder / "refused.plugin.yaml", id, folder);
    EXPECT_EQ(ended.exit_code, 1) << name;
    EXPECT_THAT(ended.err, AllOf(HasSubstr(says), Not(HasSubstr("ends the process"))));
  }
}

#ifdef WEFT_CLANG
TEST(APluginLinkedWithLibcxx, IsDescribedAndRunByThisHost) {
  const TemporaryFolder folder;
  const std::string built = folder / "filters_test_good.so";
  const testing::Ended compiler =
      testing::Child({WEFT_CLANG, "-std=c++20", "-stdlib=libc++", "-shared", "-fPIC",
                      "-fvisibility=hidden", "-Wl,--build-id=sha1", "-Wl,-z,defs",
                      "-I" WEFT_INCLUDE, WEFT_SOURCES "/good.cpp", "-o", built},
                     folder / "clang")
          .wait();
  ASSERT_EQ(compiler.exit_code, 0) << compiler.err;
  const testing::Ended described =
      describe(built, folder / "filters_test_good.plugin.yaml", "filters/test_good", folder);
  ASSERT_EQ(described.exit_code, 0) << described.err;
  EXPECT_THAT(read_file(folder / "filters_test_good.plugin.yaml"),
              AllOf(HasSubstr("compiler: \"clang"), HasSubstr("default: [-1, 2.5]")));
  Subject ours(scan(), "filters/test_good"), theirs(scan(folder.path()), "filters/test_good");
  const host::Outcome one = ours.filter(), other = theirs.filter();
  ASSERT_EQ(one.status, WEFT_OK) << one.error.message;
  ASSERT_EQ(other.status, WEFT_OK) << other.error.message;
  const auto mask = *host::view_as<InlierMask>(*one.find("inlier_mask"));
  const auto their_mask = *host::view_as<InlierMask>(*other.find("inlier_mask"));
  ASSERT_EQ(their_mask.kept.rows(), 5);
  for (std::int64_t i = 0; i < 5; ++i) EXPECT_EQ(their_mask.kept(i), 1);
  EXPECT_EQ(their_mask.diag.value("first_draw", -1.0), mask.diag.value("first_draw", -2.0));
}
#endif

}  // namespace
}  // namespace weft::misbehaving
