// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>

#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Pipeline files with errors. Their first comments are the expected messages, a line for each
/// error: `# line:column: beginning of the message`.
std::vector<std::string> malformed_files() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(WEFT_MALFORMED)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> expectations(const std::string& file) {
  std::vector<std::string> expected;
  for (const std::string& line : testing::read_lines(file)) {
    if (!line.starts_with("# ")) break;
    expected.push_back(line.substr(2));
  }
  return expected;
}

class Malformed : public testing::PipelineTest,
                  public ::testing::WithParamInterface<std::string> {};

TEST_P(Malformed, IsAnsweredWithEveryMistakeAndItsPlace) {
  const std::string file = std::string(WEFT_MALFORMED) + "/" + GetParam() + ".yaml";
  const std::vector<std::string> expected = expectations(file);
  ASSERT_FALSE(expected.empty()) << "the file says nothing of its mistakes";
  const auto report = check_pipeline(file, registry_, path("run")).second;
  const std::vector<std::string> found = testing::lines(report);
  EXPECT_EQ(found.size(), expected.size()) << report.text();
  for (std::size_t i = 0; i < std::min(found.size(), expected.size()); ++i) {
    EXPECT_THAT(found[i], StartsWith(expected[i]));
  }
}

TEST_P(Malformed, EndsTheProgramWithCodeTwo) {
  const std::string file = std::string(WEFT_MALFORMED) + "/" + GetParam() + ".yaml";
  const testing::Ended ended =
      testing::Child({WEFT_PROGRAM, "--plugin-path", WEFT_TEST_PLUGINS, "check", file},
                     path("printed"))
          .wait();
  EXPECT_EQ(ended.exit_code, 2) << ended.out << ended.err;
  for (const std::string& mistake : expectations(file)) {
    EXPECT_THAT(ended.err, HasSubstr(file + ":" + mistake));
  }
}

INSTANTIATE_TEST_SUITE_P(Files, Malformed, ::testing::ValuesIn(malformed_files()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace weft
