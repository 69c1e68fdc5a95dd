// SPDX-License-Identifier: Apache-2.0
#include "cairo_bytes.hpp"

namespace weft::cli {

cairo_status_t append_to_text(void* text, const unsigned char* bytes, unsigned count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

std::string to_png(cairo_surface_t* surface) {
  std::string png;
  const auto status = cairo_surface_write_to_png_stream(surface, append_to_text, &png);
  return status == CAIRO_STATUS_SUCCESS ? png : std::string{};
}

}  // namespace weft::cli
