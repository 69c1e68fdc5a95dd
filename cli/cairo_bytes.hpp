// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cairo.h>

#include <string>

namespace weft::cli {

/// A cairo_write_func_t that appends to a std::string.
cairo_status_t append_to_text(void* text, const unsigned char* bytes, unsigned count);

/// The surface as PNG; empty where Cairo failed.
std::string to_png(cairo_surface_t* surface);

}  // namespace weft::cli
