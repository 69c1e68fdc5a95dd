// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "cli/output/generated_text.hpp"

namespace weft::cli {

/// Runs a pipeline that writes a sequence into `folder`, new or empty, where its text is kept as
/// make.yaml. Prints progress and errors, and sets Context::exit_code. If nothing could be made,
/// the folder is removed. A run that wrote no frame is the error `none`.
void make_sequence(const GeneratedText& pipeline_text, const std::string& folder,
                   const std::vector<std::string>& settings, bool quiet, const Error& none,
                   Context& context);

/// A text as a YAML value, whatever it holds.
std::string yaml_quoted(const std::string& text);

}  // namespace weft::cli
