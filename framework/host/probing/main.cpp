// SPDX-License-Identifier: Apache-2.0
// Writes the manifest of a plugin that has been built.
#include <cstdio>
#include <weft/core/whole_file.hpp>

#include "host/probing/probe.hpp"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs(
        "usage: weft-describe LIBRARY.so MANIFEST.yaml ID\n"
        "Writes the manifest of a plugin library whose first component is ID.\n",
        stderr);
    return 2;
  }
  const auto manifest = weft::host::probe_manifest(argv[1], argv[3]);
  const auto written = manifest ? weft::write_whole(*manifest, argv[2]) : manifest.error();
  if (written) return 0;
  std::fprintf(stderr, "%s: %s\n", written.error().where.c_str(), written.error().message.c_str());
  return 1;
}
