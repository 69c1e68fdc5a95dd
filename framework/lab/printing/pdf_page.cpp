// SPDX-License-Identifier: Apache-2.0
#include "lab/printing/pdf_page.hpp"

#include <fmt/core.h>

#include <vector>

namespace weft {
namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;

}  // namespace

PdfPage::PdfPage(double width_mm, double height_mm) {
  const double width = width_mm * kPointsPerMm, height = height_mm * kPointsPerMm;
  page_ = fmt::format(
      "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.8g} {:.8g}] /Contents 4 0 R\n"
      "/Resources << /Font << /F << /Type /Font /Subtype /Type1 /BaseFont /Helvetica >> >> >> >>",
      width, height);
  graphics_ = fmt::format("{0:.8g} 0 0 -{0:.8g} 0 {1:.8g} cm\n", kPointsPerMm, height);
}

void PdfPage::fill_rectangle(double x_mm, double y_mm, double width_mm, double height_mm) {
  graphics_ += fmt::format("{:.8g} {:.8g} {:.8g} {:.8g} re f\n", x_mm, y_mm, width_mm, height_mm);
}

void PdfPage::draw_line(double x0_mm, double y0_mm, double x1_mm, double y1_mm, double width_mm) {
  graphics_ += fmt::format("{:.8g} w {:.8g} {:.8g} m {:.8g} {:.8g} l S\n", width_mm, x0_mm, y0_mm,
                           x1_mm, y1_mm);
}

void PdfPage::write_text(double x_mm, double baseline_mm, double size_mm, const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '(' || c == ')' || c == '\\') escaped += '\\';
    escaped += c;
  }
  graphics_ += fmt::format("BT /F {:.8g} Tf 1 0 0 -1 {:.8g} {:.8g} Tm ({}) Tj ET\n", size_mm, x_mm,
                           baseline_mm, escaped);
}

std::string PdfPage::file() const {
  const std::vector<std::string> objects{
      "<< /Type /Catalog /Pages 2 0 R >>", "<< /Type /Pages /Kids [3 0 R] /Count 1 >>", page_,
      fmt::format("<< /Length {} >>\nstream\n{}endstream", graphics_.size(), graphics_)};
  std::string file = "%PDF-1.4\n", index = "0000000000 65535 f \n";
  for (std::size_t i = 0; i < objects.size(); ++i) {
    index += fmt::format("{:010} 00000 n \n", file.size());
    file += fmt::format("{} 0 obj\n{}\nendobj\n", i + 1, objects[i]);
  }
  const std::size_t count = objects.size() + 1;
  return fmt::format("{}xref\n0 {}\n{}trailer\n<< /Size {} /Root 1 0 R >>\nstartxref\n{}\n%%EOF\n",
                     file, count, index, count, file.size());
}

}  // namespace weft
