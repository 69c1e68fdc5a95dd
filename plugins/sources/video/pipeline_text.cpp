// SPDX-License-Identifier: Apache-2.0
#include "pipeline_text.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <vector>

namespace weft::video {
namespace {

bool is_of_word(char letter) {
  return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '-' || letter == '_';
}

/// True if the value of a property is free text of the user, which names no element.
bool is_free_text(std::string_view property) {
  return property == "name" || property == "location" || property == "uri" || property == "device";
}

/// Where a value ends that begins at `at`: at its second quote, or at a blank or !.
std::size_t end_of_value(std::string_view pipeline, std::size_t at) {
  const bool is_quoted = at < pipeline.size() && (pipeline[at] == '"' || pipeline[at] == '\'');
  const std::size_t end =
      is_quoted ? pipeline.find(pipeline[at], at + 1) : pipeline.find_first_of(" \t\n!\"'", at);
  return std::min(end, pipeline.size());
}

/// Names of elements and properties, and words in values. Quotes and backslashes, by which a name
/// can be written in another way, are skipped.
std::vector<std::string> words_of(std::string_view pipeline) {
  std::vector<std::string> words{""};
  for (std::size_t i = 0; i < pipeline.size(); ++i) {
    const char letter = pipeline[i];
    if (letter == '"' || letter == '\'' || letter == '\\') continue;
    if (letter == '=' && is_free_text(words.back())) i = end_of_value(pipeline, i + 1);
    if (is_of_word(letter)) {
      words.back() += letter;
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  return words;
}

/// filesink, splitmuxsink, hlssink2: GStreamer names elements without an output by their end. Also
/// a property that takes such an element, such as playbin's video-sink.
bool is_sink(std::string_view word) {
  const std::size_t end = word.find_last_not_of("0123456789");
  return end != word.npos && word.substr(0, end + 1).ends_with("sink");
}

/// Properties of encoders that name a file to be written.
bool is_output_file(std::string_view word) {
  return word == "multipass-cache-file" || word == "stats-file" || word == "log-file" ||
         word == "dump-location";
}

}  // namespace

bool is_pipeline(const std::string& address) { return address.find('!') != std::string::npos; }

Result<void> check_pipeline(const std::string& pipeline) {
  bool has_appsink = false;
  for (const std::string& word : words_of(pipeline)) {
    has_appsink = has_appsink || word == "appsink";
    if (word == "appsink" || (!is_sink(word) && !is_output_file(word))) continue;
    return Error{
        Errc::invalid_value,
        "the pipeline of 'address' may give its frames to appsink alone: remove '" + word + "'"};
  }
  if (has_appsink) return {};
  return Error{Errc::invalid_value,
               "the pipeline of 'address' must end in appsink: add '! appsink'"};
}

}  // namespace weft::video
