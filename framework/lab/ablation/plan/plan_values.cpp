// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>

#include "lab/ablation/plan/plan_keys.hpp"
#include "lab/ablation/plan/plan_parts.hpp"
#include "yaml/keys.hpp"

namespace weft::lab {
namespace {

constexpr std::size_t kMostSeeds = 10'000;

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

std::optional<std::int64_t> seed_in(const std::string& text) {
  const auto seed = yaml::as_int64(yaml::plain_node(text));
  return seed && *seed >= 0 && *seed <= kLargestSeed ? seed : std::nullopt;
}

}  // namespace

bool PlanValues::is_map(const yaml::Node& node, const std::string& what,
                        const yaml::KeyTable& table) {
  if (node.kind != yaml::Kind::map && !yaml::is_null(node)) {
    problem(node.at, what + " must be a map");
    return false;
  }
  const std::vector<std::string> keys = yaml::names_of(table);
  for (const yaml::Entry& entry : node.entries) {
    if (std::find(keys.begin(), keys.end(), entry.key) != keys.end()) continue;
    problem(entry.at, what + " has no key " + quote(entry.key) +
                          did_you_mean(entry.key, keys, "; it may have: " + joined(keys)));
  }
  return true;
}

void PlanValues::correct_keys(yaml::Node& map, const std::string& what,
                              const yaml::KeyTable& table) {
  const std::vector<std::string> keys = yaml::names_of(table);
  yaml::correct_keys(map, keys, [&](const yaml::Entry& entry, const std::string& near) {
    problem(entry.at, what + " has no key " + quote(entry.key) +
                          meant(near, "; it may have: " + joined(keys)));
  });
}

std::string PlanValues::text(const yaml::Node& node, const std::string& what) {
  const bool is_text = node.kind == yaml::Kind::scalar && !node.scalar.empty();
  if (!is_text) problem(node.at, what + " must be a text");
  // A text with NUL was refused where it stands.
  return is_text && node.scalar.find('\0') == std::string::npos ? node.scalar : std::string();
}

std::vector<std::pair<std::string, yaml::Position>> PlanValues::texts(const yaml::Node& node,
                                                                      const std::string& what) {
  std::vector<std::pair<std::string, yaml::Position>> found;
  if (node.kind != yaml::Kind::sequence) problem(node.at, what + " must be a list of texts");
  for (const yaml::Node& item : node.items) {
    found.emplace_back(text(item, "an entry of " + what), item.at);
  }
  return found;
}

std::optional<double> PlanValues::number(const yaml::Node& node, const std::string& what) {
  const auto value = yaml::as_double(node);
  if (value && std::isfinite(*value)) return value;
  problem(node.at, what + " must be a number");
  return std::nullopt;
}

std::optional<bool> PlanValues::flag(const yaml::Node& node, const std::string& what) {
  const auto value = yaml::as_bool(node);
  if (!value) problem(node.at, what + " must be true or false");
  return value;
}

std::vector<std::uint64_t> PlanValues::seeds(const yaml::Node& node, const std::string& what) {
  std::vector<std::uint64_t> found;
  const bool is_list = node.kind == yaml::Kind::sequence;
  const std::vector<yaml::Node> items = is_list ? node.items : std::vector<yaml::Node>{node};
  for (const yaml::Node& item : items) add_seeds(item, what, found);
  if (items.empty()) problem(node.at, what + " are an empty list");
  std::set<std::uint64_t> known;
  const auto is_new = [&](std::uint64_t seed) { return known.insert(seed).second; };
  const auto twice = std::find_if_not(found.begin(), found.end(), is_new);
  if (twice == found.end()) return found;
  problem(node.at, what + " hold the seed " + std::to_string(*twice) + " twice");
  return {};
}

void PlanValues::add_seeds(const yaml::Node& node, const std::string& what,
                           std::vector<std::uint64_t>& seeds) {
  const std::size_t dash = std::min(node.scalar.find('-', 1), node.scalar.size());
  const bool range = dash < node.scalar.size();
  const auto first = seed_in(node.scalar.substr(0, dash));
  const auto last = range ? seed_in(node.scalar.substr(dash + 1)) : first;
  if (node.kind != yaml::Kind::scalar || !first || !last || *last < *first) {
    return problem(node.at, what + " must be whole numbers from 0 or ranges such as 101-120");
  }
  if (seeds.size() + to_index(*last - *first) >= kMostSeeds) {
    return problem(node.at, what + " are more than " + std::to_string(kMostSeeds));
  }
  for (auto seed = *first; seed <= *last; ++seed) seeds.push_back(static_cast<std::uint64_t>(seed));
}

bool PlanValues::is_name(const std::string& name, yaml::Position at, const std::string& what) {
  const auto legal = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '.' || c == '_' || c == '-' || c == '+' || c == '/';
  };
  if (!name.empty() && std::all_of(name.begin(), name.end(), legal)) return true;
  problem(at, what + " must be made of letters, digits and . _ - + /, not " + quote(name));
  return false;
}

/// The results folder is called by the name of the plan.
bool PlanValues::is_folder_name(const std::string& name, yaml::Position at) {
  constexpr std::size_t kLongest = 100;
  constexpr const char* kLegal =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
  const bool legal = !name.empty() && name.size() <= kLongest && name.front() != '.' &&
                     name.find_first_not_of(kLegal) == std::string::npos;
  if (legal) return true;
  problem(at, "'name' names a folder: it must be made of at most " + std::to_string(kLongest) +
                  " letters, digits and _ . -, and must not begin with a dot");
  return false;
}

bool PlanValues::has(const yaml::Node& map, const char* key, const std::string& what) {
  if (map.find(key) != nullptr) return true;
  problem(map.at, what + " lacks the key '" + key + "'");
  return false;
}

void PlanValues::unknown(yaml::Position at, const std::string& what, const std::string& word,
                         const std::vector<std::string>& known) {
  const std::string others = known.empty() ? "" : "; there are: " + joined(known);
  problem(at, "there is no " + what + " " + quote(word) + did_you_mean(word, known, others));
}

}  // namespace weft::lab
