// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::testing {

/// The program, started by a shell that gives it other outputs or takes rights away from it.
class ShelledProgram : public PipelineTest {
 protected:
  /// `shell` runs in the test's folder and starts the program by "$0" "$@".
  Ended weft(const std::string& shell, const std::vector<std::string>& arguments) const {
    std::vector<std::string> words{"/bin/sh",
                                   "-c",
                                   "cd '" + folder_ + "' && { " + shell + "; }",
                                   WEFT_PROGRAM,
                                   "--plugin-path",
                                   WEFT_TEST_PLUGINS,
                                   "--plugin-path",
                                   WEFT_REAL_PLUGINS};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return Child(words, path("printed")).wait();
  }
  Ended weft(const std::vector<std::string>& arguments) const {
    return weft(R"(exec "$0" "$@")", arguments);
  }
};

}  // namespace weft::testing
