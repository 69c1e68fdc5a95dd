// SPDX-License-Identifier: Apache-2.0
// Meshes in OBJ: refused at a line of the file, or legal and the same when printed and read again.
#include "mesh_checks.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace weft;
  using fuzzing::require;
  const std::string text(fuzzing::text_of(data, size));
  const fuzzing::InputFile input(text);
  const auto file = mesh::read_mesh_file(input.path());
  if (!file) {
    const Error& error = file.error();
    require(error.code == Errc::invalid_data, "invalid data", error.message);
    for (const char* whole : {": the mesh has no faces", ": is a file of the format ",
                              ": is text in UTF-", ": the faces have "}) {
      if (error.message.starts_with(input.path() + whole)) return 0;
    }
    if (text.starts_with("ply")) return 0;
    fuzzing::require_place(error.message, input.path(), text, false);
    return 0;
  }
  fuzzing::require_legal(*file);
  fuzzing::require_same_printed(*file);
  return 0;
}
