// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace weft {

/// One page of black graphics at exact size (ISO 32000-1), in mm from its top left corner, x right
/// and y down. The same drawing is the same bytes.
class PdfPage {
 public:
  PdfPage(double width_mm, double height_mm);

  void fill_rectangle(double x_mm, double y_mm, double width_mm, double height_mm);
  void draw_line(double x0_mm, double y0_mm, double x1_mm, double y1_mm, double width_mm);
  /// Helvetica, which every reader has. `text` is ASCII.
  void write_text(double x_mm, double baseline_mm, double size_mm, const std::string& text);

  /// The whole file.
  std::string file() const;

 private:
  std::string page_;      ///< the page's dictionary
  std::string graphics_;  ///< operators, in order
};

}  // namespace weft
