// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/forms/metric_path.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>

#include "lab/metrics/forms/former_words.hpp"
#include "lab/metrics/forms/json.hpp"

namespace weft::lab {
namespace {

using nlohmann::json;

std::string label_of(const json& entry) {
  for (const char* key : {"stage", "kind", "part"}) {
    const auto found = entry.find(key);
    if (found != entry.end() && found->is_string()) return found->get<std::string>();
  }
  return {};
}

std::vector<std::string> names_in(const json& place) {
  std::vector<std::string> names;
  if (place.is_object()) {
    for (const auto& [key, value] : place.items()) names.push_back(key);
  } else {
    for (const json& entry : place) names.push_back(label_of(entry));
  }
  return names;
}

Error no_such(const std::string& path, const std::string& word, const json& place) {
  const std::vector<std::string> names = names_in(place);
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "; there are: " : ", ") + name;
  return {
      Errc::not_found,
      "the metric " + quote(path) + ": there is no " + quote(word) + did_you_mean(word, names, all),
      {}};
}

/// Goes into a list, by the name of an entry or because there is one only; true where `word` was
/// that name.
Result<bool> enter_list(const std::string& path, const std::string& word, const json*& place) {
  for (const json& entry : *place) {
    if (label_of(entry) != word) continue;
    place = &entry;
    return true;
  }
  if (place->size() != 1) return no_such(path, word, *place);
  place = &place->front();
  return false;
}

}  // namespace

Result<double> metric_at(const json& metrics, const std::string& path) {
  const json* place = &metrics;
  for (std::size_t start = 0; start <= path.size();) {
    const std::size_t end = std::min(path.find('.', start), path.size());
    const std::string word = path.substr(start, end - start);
    start = end + 1;
    if (place->is_array()) {
      const auto named = enter_list(path, word, place);
      if (!named) return named.error();
      if (*named) continue;
    }
    auto found = place->is_object() ? place->find(word) : place->end();
    // The path or the file may be older than a renamed metric.
    for (const std::string_view other : {current_word(word), former_word(word)}) {
      if (found == place->end() && place->is_object()) found = place->find(std::string(other));
    }
    if (found == place->end()) return no_such(path, word, *place);
    place = &*found;
  }
  if (place->is_null()) return kUnknown;
  if (place->is_number()) return place->get<double>();
  return Error{Errc::not_found, "the metric " + quote(path) + " is no number"};
}

std::string why_no_metric(const std::string& path, const std::vector<std::string>& filters) {
  // Their kinds and parts are the data's.
  if (path.starts_with("groups.") || path.starts_with("parts.")) return {};
  RunMetrics metrics;
  for (const std::string& stage : filters) {
    metrics.filters.emplace_back();
    metrics.filters.back().stage = stage;
  }
  const auto figure = metric_at(json(json_of(metrics)), path);
  return figure ? std::string() : figure.error().message;
}

}  // namespace weft::lab
