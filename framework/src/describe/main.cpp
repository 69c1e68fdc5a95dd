// SPDX-License-Identifier: Apache-2.0
// Linked with the objects of a plugin: writes the manifest of its library.
#include <weft/abi.h>

#include <cstdio>
#include <fstream>
#include <string_view>

#include "describe/build_id.hpp"
#include "describe/describe.hpp"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: <plugin>_describe LIBRARY.so MANIFEST.yaml ID\n", stderr);
    return 2;
  }
  const char* first = weft_library.count > 0 ? weft_library.components[0]->id : "";
  if (first != std::string_view(argv[3])) {
    std::fprintf(stderr,
                 "%s: its first component is '%s', and weft_add_plugin() builds '%s': give both "
                 "the same id\n",
                 argv[1], first, argv[3]);
    return 1;
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
