// SPDX-License-Identifier: Apache-2.0
// Manifests of plugins: refused at a place inside the file, or as the host expects them.
#include <weft/core/quote.hpp>

#include "fuzzing.hpp"
#include "host/loading/manifest.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace weft;
  using fuzzing::require;
  std::string_view text = fuzzing::text_of(data, size);
  const fuzzing::InputFile file(text);
  const auto manifest = host::read_manifest(file.path());
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // not counted in columns
  if (!manifest) {
    const Error& error = manifest.error();
    require(error.code == Errc::syntax || error.code == Errc::invalid_data, "a code of mistakes");
    require(!error.message.empty(), "a message");
    require(fuzzing::require_place(error.where, file.path(), text).empty(), "a place alone",
            error.where);
    return 0;
  }
  require(manifest->file == file.path(), "the name of its file");
  require(!manifest->components.empty(), "a component");
  for (const host::ComponentManifest& component : manifest->components) {
    for (const host::ParameterSpec& parameter : component.parameters) {
      require(std::string_view(host::parameter_type_name(parameter.type)) != "unknown",
              "a type that is known", parameter.name);
      require(parameter.required || parameter.default_value.at.line > 0, "a default");
      require(!parameter.bounded || !(parameter.minimum > parameter.maximum), "a range",
              parameter.name);
    }
  }
  return 0;
}
