// SPDX-License-Identifier: Apache-2.0
// Linked with the objects of a plugin: writes the manifest of its library.
#include <weft/abi.h>

#include <cstdio>
#include <fstream>

#include "describe/build_id.hpp"
#include "describe/describe.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: <plugin>_describe LIBRARY.so MANIFEST.yaml\n", stderr);
    return 2;
  }
  const auto build_id = weft::host::read_build_id(argv[1]);
  if (!build_id || build_id->empty()) {
    std::fprintf(stderr, "%s: has no build-id; link it with -Wl,--build-id=sha1\n", argv[1]);
    return 1;
  }
  const auto description = weft::host::describe_library(weft_library, *build_id);
  if (!description) {
    const weft::Error& error = description.error();
    std::fprintf(stderr, "%s: %s\n", error.where.c_str(), error.message.c_str());
    return 1;
  }
  std::ofstream manifest(argv[2], std::ios::trunc);
  manifest << *description;
  manifest.close();
  if (!manifest) std::fprintf(stderr, "%s: cannot be written\n", argv[2]);
  return manifest ? 0 : 1;
}
