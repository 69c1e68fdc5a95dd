// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lab/report/text/text_table.hpp"

namespace weft::lab {

/// A table for \input in LaTeX, with the rules of the package booktabs; folded, what is folded and
/// the lines of `origin` as comments above it.
std::string to_latex(const TextTable& table, const std::string& origin);

/// Lines of comment.
std::string latex_comment(const std::string& text);

/// Text that is no markup in LaTeX.
std::string latex_escaped(const std::string& text);

}  // namespace weft::lab
