// SPDX-License-Identifier: Apache-2.0
// Libraries that must not be used: each is refused by file, cause and fix, and the good ones in
// the same folder stay usable.
#include <gmock/gmock.h>

#include "misbehaving.hpp"

namespace weft::misbehaving {
namespace {

using host::Refusal;
using host::Registry;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char *kGood = "filters_test_good", *kGoodId = "filters/test_good";

/// Loads a component that the registry has accepted; it must fail.
Error load_error(const Registry& registry, const std::string& id) {
  const host::Installed* installed = registry.find(id);
  if (installed == nullptr) {
    ADD_FAILURE() << registry.explain_missing(id);
    return {};
  }
  const auto loaded = host::load(*installed);
  EXPECT_FALSE(loaded) << id;
  return loaded ? Error{} : loaded.error();
}

TEST(MisbehavingPlugins, RefusesWhatNeedsALaterAbiByItsNumber) {
  const Registry registry = scan();
  const Refusal refusal = refusal_of(registry, "filters_test_wrong_abi.so");
  const std::string abi = std::to_string(WEFT_ABI_MAJOR) + ".";
  EXPECT_THAT(refusal.cause, AllOf(HasSubstr("plugin ABI " + abi + "99"),
                                   HasSubstr(abi + std::to_string(WEFT_ABI_MINOR))));
  EXPECT_THAT(refusal.fix, HasSubstr("rebuild"));
  EXPECT_THAT(
      registry.explain_missing("filters/test_wrong_abi"),
      AllOf(HasSubstr("filters_test_wrong_abi.so"), HasSubstr("ABI"), HasSubstr("rebuild")));
  const auto table = host::load_library(library("filters_test_wrong_abi"));
  ASSERT_FALSE(table) << "loaded without its manifest";
  EXPECT_EQ(table.error().code, Errc::incompatible);
  EXPECT_THAT(table.error().message, AllOf(HasSubstr("99"), HasSubstr("rebuild")));
}

TEST(MisbehavingPlugins, LoadsWhatALaterMinorVersionHasBuiltIfItNeedsNothingOfIt) {
  const Registry registry = scan();
  Subject newer(registry, "filters/test_newer");
  ASSERT_TRUE(newer.created()) << newer.created().error().message;
  const host::Outcome outcome = newer.filter(4);
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.error.message;
  const auto mask = host::view_as<InlierMask>(*outcome.find("inlier_mask"));
  ASSERT_TRUE(mask);
  EXPECT_EQ(mask->kept.rows(), 4);
}

TEST(MisbehavingPlugins, RefusesAComponentThatIsUnknownAndUsesTheOthersOfItsLibrary) {
  const std::vector<std::pair<std::string, std::string>> changes{
      {"filters/test_strict", "clouds/test_strict"},
      {"type: f64", "type: tensor"},
      {"type: component\n", "type: component\n        vector: true\n"}};
  const std::vector<std::string> unknown{"clouds/test_strict", kGoodId, kGoodId};
  const std::vector<std::string> known{kGoodId, "filters/test_strict", "filters/test_strict"};
  const std::vector<std::string> causes{"'clouds' of 'clouds/test_strict' is no role",
                                        "has the unknown type 'tensor'",
                                        "parameter 'warp' is a list of the type 'component'"};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    SCOPED_TRACE(causes[i]);
    const TemporaryFolder folder;
    folder.adopt(kGood);
    const std::string file = folder / "filters_test_good.plugin.yaml";
    std::string manifest = read_file(file);
    manifest.replace(manifest.find(changes[i].first), changes[i].first.size(), changes[i].second);
    write_file(file, manifest);
    const Registry registry = scan(folder.path());
    EXPECT_EQ(registry.find(unknown[i]), nullptr);
    EXPECT_NE(registry.find(known[i]), nullptr);
    EXPECT_THAT(registry.explain_missing(unknown[i]),
                AllOf(HasSubstr(causes[i]), HasSubstr("newer Weft")));
  }
}

TEST(MisbehavingPlugins, RefusesALibraryThatHidesItsTable) {
  const Error error = load_error(scan(), "filters/test_no_symbol");
  EXPECT_EQ(error.code, Errc::incompatible);
  EXPECT_EQ(error.where, library("filters_test_no_symbol"));
  EXPECT_THAT(error.message, AllOf(HasSubstr("weft_library"), HasSubstr("weft_add_plugin")));
}

TEST(MisbehavingPlugins, RefusesALibraryThatNeedsAnAbsentOne) {
  const Error error = load_error(scan(), "filters/test_needs_missing");
  EXPECT_EQ(error.code, Errc::incompatible);
  EXPECT_EQ(error.where, library("filters_test_needs_missing"));
  EXPECT_THAT(error.message, AllOf(HasSubstr("libtest_absent.so"), HasSubstr("install")));
}

TEST(MisbehavingPlugins, RefusesAProcessorFeatureThatThisVersionOfWeftDoesNotKnow) {
  const Refusal refusal = refusal_of(scan(), "filters_test_wrong_isa.so");
  EXPECT_THAT(refusal.cause, HasSubstr("this version of Weft does not know: amx_fake"));
  EXPECT_THAT(refusal.cause, ::testing::Not(HasSubstr("sse4.2")));
  EXPECT_THAT(refusal.fix, HasSubstr("rebuild"));
}

TEST(MisbehavingPlugins, RefusesASymbolThatIsNoTable) {
  const Error error = load_error(scan(), "filters/test_wrong_magic");
  EXPECT_EQ(error.code, Errc::incompatible);
  EXPECT_THAT(error.message, HasSubstr("no Weft library table"));
}

TEST(MisbehavingPlugins, RefusesARoleThatThereIsNotAndSuggestsOne) {
  const Refusal refusal = refusal_of(scan(), "filtres_test_wrong_role.so");
  EXPECT_THAT(refusal.cause, AllOf(HasSubstr("'filtres'"), HasSubstr("'filters'")));
}

TEST(MisbehavingPlugins, RefusesAManifestOfAnotherBuild) {
  const TemporaryFolder folder;
  folder.adopt(kGood);
  std::string manifest = read_file(folder / "filters_test_good.plugin.yaml");
  const std::size_t at = manifest.find("build_id: \"") + 11;
  manifest[at] = manifest[at] == '0' ? '1' : '0';
  write_file(folder / "filters_test_good.plugin.yaml", manifest);
  const Registry registry = scan(folder.path());
  EXPECT_EQ(registry.find("filters/test_good"), nullptr);
  const Refusal refusal = refusal_of(registry, "filters_test_good.so");
  EXPECT_THAT(refusal.cause, HasSubstr("another build"));
  EXPECT_THAT(refusal.fix, HasSubstr("weft plugins describe"));
}

TEST(MisbehavingPlugins, RefusesTheSameIdTwiceInOneFolder) {
  const TemporaryFolder folder;
  folder.adopt(kGood, "one");
  folder.adopt(kGood, "two");
  folder.adopt("filters_test_throws");
  const Registry registry = scan(folder.path());
  EXPECT_EQ(registry.find("filters/test_good"), nullptr);
  EXPECT_THAT(refusal_of(registry, "one.so").cause,
              AllOf(HasSubstr("filters/test_good"), HasSubstr("two.so")));
  EXPECT_THAT(refusal_of(registry, "two.so").cause, HasSubstr("one.so"));
  EXPECT_THAT(registry.explain_missing("filters/test_good"), HasSubstr("keep one of the two"));
  EXPECT_NE(registry.find("filters/test_throws"), nullptr);
}

TEST(MisbehavingPlugins, RefusesALibraryWithoutAManifest) {
  const TemporaryFolder folder;
  folder.adopt(kGood);
  fs::remove(folder / "filters_test_good.plugin.yaml");
  const Registry registry = scan(folder.path());
  const Refusal refusal = refusal_of(registry, "filters_test_good.so");
  EXPECT_THAT(refusal.cause, HasSubstr("no manifest"));
  EXPECT_EQ(refusal.fix, "run: weft plugins describe " + (folder / "filters_test_good.so"));
  EXPECT_THAT(registry.explain_missing("filters/test_good"), HasSubstr("no manifest"));
}

TEST(MisbehavingPlugins, RefusesAManifestWithoutItsLibrary) {
  const TemporaryFolder folder;
  folder.adopt(kGood);
  fs::remove(folder / "filters_test_good.so");
  const Refusal refusal = refusal_of(scan(folder.path()), "filters_test_good.so");
  EXPECT_THAT(refusal.cause, HasSubstr("library is missing"));
}

TEST(MisbehavingPlugins, RefusesADamagedManifestAtItsPlace) {
  const std::string whole = read_file(kFolder + "/filters_test_good.plugin.yaml");
  const auto refusal_with = [&](const std::string& before, const std::string& after) {
    const TemporaryFolder folder;
    folder.adopt(kGood);
    std::string manifest = whole;
    const std::size_t at = manifest.find(before);
    EXPECT_NE(at, std::string::npos) << before;
    manifest.replace(at, before.size(), after);
    write_file(folder / "filters_test_good.plugin.yaml", manifest);
    return refusal_of(scan(folder.path()), "filters_test_good.so").cause;
  };
  EXPECT_THAT(refusal_with("components:", "components: ["), HasSubstr("plugin.yaml:"));
  EXPECT_THAT(refusal_with("compiler:", "kompiler:"), HasSubstr("'compiler' is missing"));
  EXPECT_THAT(refusal_with("type: f64", "type: f99"), HasSubstr("unknown type 'f99'"));
  EXPECT_THAT(refusal_with("range: [0, 100]", "range: [0, x]"), HasSubstr("'range'"));
  EXPECT_THAT(refusal_with("range: [0, 100]", "range: [1, 0]"), HasSubstr("'range'"));
  EXPECT_THAT(refusal_with("abi: [", "abi: [1e9, "), HasSubstr("'abi'"));
  EXPECT_THAT(refusal_with("isa: [", "isa: {}  # ["), HasSubstr("'isa' is no list"));
  EXPECT_THAT(refusal_with("filters/test_good", "Filters test_good"), HasSubstr("role/name"));
  EXPECT_THAT(refusal_with("filters/test_strict", "filters/test_good"), HasSubstr("in it twice"));
  EXPECT_THAT(refusal_with("weft_plugin: 1", "weft_plugin: 2"), HasSubstr("manifest version"));
}

TEST(MisbehavingPlugins, RefusesWhatIsNoElfFile) {
  const std::string image = read_file(library(kGood));
  for (const std::string& content :
       {std::string("this is text"), std::string(), image.substr(0, 40), image.substr(0, 90)}) {
    const TemporaryFolder folder;
    folder.adopt(kGood);
    write_file(folder / "filters_test_good.so", content);
    const Registry registry = scan(folder.path());
    EXPECT_EQ(registry.find("filters/test_good"), nullptr);
    EXPECT_THAT(refusal_of(registry, "filters_test_good.so").cause, HasSubstr("ELF"));
    const auto table = host::load_library(folder / "filters_test_good.so");
    ASSERT_FALSE(table);
    EXPECT_THAT(table.error().message, HasSubstr("cannot be loaded"));
  }
}

TEST(MisbehavingPlugins, RefusesALibraryThatDoesNotContainWhatItsManifestSays) {
  const TemporaryFolder folder;
  folder.adopt(kGood);
  std::string manifest = read_file(folder / "filters_test_good.plugin.yaml");
  manifest.replace(manifest.find("filters/test_strict"), 19, "filters/test_forged");
  write_file(folder / "filters_test_good.plugin.yaml", manifest);
  const Error error = load_error(scan(folder.path()), "filters/test_forged");
  EXPECT_THAT(error.message, HasSubstr("does not contain 'filters/test_forged'"));
}

TEST(MisbehavingPlugins, NamesAFolderThatCannotBeRead) {
  const Registry registry = scan("/nowhere/at/all");
  ASSERT_EQ(registry.refusals().size(), 1U);
  EXPECT_EQ(registry.refusals()[0].file, "/nowhere/at/all");
  EXPECT_THAT(registry.refusals()[0].cause, HasSubstr("cannot be read"));
}

TEST(MisbehavingPlugins, KeepsTheGoodOnesUsableAmongTheBroken) {
  const Registry registry = scan();
  EXPECT_GE(registry.refusals().size(), 3U);
  for (const Refusal& refusal : registry.refusals()) {
    EXPECT_FALSE(refusal.file.empty() || refusal.cause.empty() || refusal.fix.empty());
  }
  for (const char* broken : {"no_symbol", "needs_missing", "wrong_magic"}) {
    load_error(registry, std::string("filters/test_") + broken);
  }
  Subject good(registry, "filters/test_good");
  ASSERT_TRUE(good.created()) << good.created().error().message;
  const host::Outcome outcome = good.filter(7);
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.error.message;
  const auto mask = host::view_as<InlierMask>(*outcome.find("inlier_mask"));
  ASSERT_TRUE(mask);
  EXPECT_EQ(mask->kept.rows(), 7);
}

}  // namespace
}  // namespace weft::misbehaving
