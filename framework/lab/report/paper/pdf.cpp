// SPDX-License-Identifier: Apache-2.0
#include "lab/report/paper/pdf.hpp"

#include <filesystem>

#include "process/program.hpp"

namespace weft::lab {
namespace {

constexpr const char* kConverter = "rsvg-convert";

}  // namespace

Result<std::optional<std::string>> write_pdf(const std::string& svg) {
  const std::string pdf = std::filesystem::path(svg).replace_extension(".pdf").string();
  // Without a date the file would hold the time of its making.
  const auto answer = process::run_program({kConverter, "--format=pdf", "--output=" + pdf, svg},
                                           {"SOURCE_DATE_EPOCH=0"});
  if (!answer) return std::optional<std::string>();
  if (answer->exit_code == 0) return std::optional(pdf);
  return Error{Errc::io,
               std::string(kConverter) +
                   " did not make a PDF of it; is the disk full? Without that program figures are "
                   "SVG alone",
               svg};
}

}  // namespace weft::lab
