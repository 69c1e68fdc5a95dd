// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "cli/output/generated_text.hpp"

namespace weft::cli {

/// Runs a pipeline that writes a sequence into `folder`, new or empty, where its text is kept as
/// make.yaml. Prints progress and errors, and sets Context::exit_code. If nothing could be made,
/// the folder is removed. `frames_in` counts the frames that are in it; a run that wrote none is
/// the error `none`.
void make_sequence(const GeneratedText& pipeline_text, const std::string& folder,
                   const std::vector<std::string>& settings, bool quiet,
                   std::int64_t (*frames_in)(const std::string&), const Error& none,
                   Context& context);

/// The images of a folder that sinks/dataset wrote.
std::int64_t frames_in_sequence(const std::string& folder);
/// The frames of a folder of sinks/shards; at least its shards if the run broke off.
std::int64_t frames_in_shards(const std::string& folder);

/// A text as a YAML value, whatever it holds.
std::string yaml_quoted(const std::string& text);

}  // namespace weft::cli
