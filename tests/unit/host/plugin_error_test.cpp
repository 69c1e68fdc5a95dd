// SPDX-License-Identifier: Apache-2.0
#include "host/records/plugin_error.hpp"

#include <gtest/gtest.h>

#include <cstring>

namespace weft::host {
namespace {

TEST(PluginError, ShowsWhatAPluginQuotesFromAFileWithoutControlCharacters) {
  weft_error raw{sizeof(weft_error), 0, {}, {}, {}};
  raw.code = static_cast<std::int32_t>(Errc::invalid_data);
  std::strcpy(raw.where, "sources/x\x1b[2J");
  std::strcpy(raw.message, "mesh.ply:7: '\x01' does not belong\nthere");
  const Error error = plugin_error(WEFT_ERROR, raw, "sources/x");
  EXPECT_EQ(error.message, "mesh.ply:7: '\\x01' does not belong\\nthere");
  EXPECT_EQ(error.where, "sources/x\\x1B[2J");
}

}  // namespace
}  // namespace weft::host
