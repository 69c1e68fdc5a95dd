// SPDX-License-Identifier: Apache-2.0
#include "page.hpp"

// The assembler reads the files of the folder WEFT_LIVE_PAGE, which CMake has filled, as they are.
#define WEFT_EMBED(name, file)             \
  __asm__(                                 \
      ".pushsection .rodata\n"             \
      ".globl weft_live_" name             \
      "\n"                                 \
      ".hidden weft_live_" name            \
      "\n"                                 \
      "weft_live_" name                    \
      ":\n"                                \
      ".incbin \"" WEFT_LIVE_PAGE "/" file \
      "\"\n"                               \
      ".globl weft_live_" name             \
      "_end\n"                             \
      ".hidden weft_live_" name            \
      "_end\n"                             \
      "weft_live_" name                    \
      "_end:\n"                            \
      ".byte 0\n"                          \
      ".popsection\n")

WEFT_EMBED("html", "live.html");
WEFT_EMBED("js", "live.js");
WEFT_EMBED("css", "live.css");

#define WEFT_HIDDEN __attribute__((visibility("hidden")))
extern "C" {
extern const char weft_live_html[] WEFT_HIDDEN, weft_live_html_end[] WEFT_HIDDEN;
extern const char weft_live_js[] WEFT_HIDDEN, weft_live_js_end[] WEFT_HIDDEN;
extern const char weft_live_css[] WEFT_HIDDEN, weft_live_css_end[] WEFT_HIDDEN;
}

namespace weft::live {
namespace {

std::string_view between(const char* begin, const char* end) {
  return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace

const PageFile* page_file(std::string_view path) {
  static const PageFile kHtml{"text/html; charset=utf-8",
                              between(weft_live_html, weft_live_html_end), false};
  static const PageFile kScript{"text/javascript; charset=utf-8",
                                between(weft_live_js, weft_live_js_end), true};
  static const PageFile kStyle{"text/css; charset=utf-8", between(weft_live_css, weft_live_css_end),
                               true};
  if (path == "/") return &kHtml;
  if (path == "/live.js") return &kScript;
  return path == "/live.css" ? &kStyle : nullptr;
}

}  // namespace weft::live
