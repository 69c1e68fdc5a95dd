// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pipeline/configuration/config.hpp"

namespace weft::cli {

/// YAML that a command writes for its arguments. An error in a line of it is one of the argument
/// that the line was made from, since the caller never wrote the line.
class GeneratedText {
 public:
  /// `otherwise` names what lines without an argument come from: "weft compare".
  explicit GeneratedText(std::string otherwise) : otherwise_(std::move(otherwise)) {}

  /// Adds lines, each with its line break, that are made from an argument such as "--data FOLDER".
  void add(const std::string& lines, const std::string& argument = {});
  const std::string& text() const { return text_; }

  /// One line an error: its place, or its argument where it is in `file`, which has this text.
  std::string report_text(const ConfigReport& report, const std::string& file) const;

 private:
  std::string otherwise_, text_;
  std::vector<std::string> arguments_;  ///< arguments of each line
};

}  // namespace weft::cli
