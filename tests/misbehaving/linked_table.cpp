// SPDX-License-Identifier: Apache-2.0
// Linked with the objects of a library that cannot be loaded: writes its manifest, whatever is
// wrong with its table.
#include <weft/abi.h>

#include <cstdio>
#include <weft/core/whole_file.hpp>

#include "host/describe/build_id.hpp"
#include "host/describe/describe.hpp"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto build_id = weft::host::read_build_id(argv[1]);
  if (!build_id) return 1;
  const auto manifest = weft::host::describe_library(weft_library, *build_id);
  const auto written = manifest ? weft::write_whole(*manifest, argv[2]) : manifest.error();
  if (!written) std::fputs(written.error().message.c_str(), stderr);
  return written ? 0 : 1;
}
