// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <cstdint>
#include <deque>
#include <string>
#include <vector>
#include <weft/core/version.hpp>

namespace weft::host {

inline constexpr const char* kHostName = "weft";

/// The functions of this host beyond weft_host: none yet.
inline const void* host_extension(const weft_host* /*host*/, void* /*context*/,
                                  const char* /*name*/) {
  return nullptr;
}

/// The arguments that create a component to check its parameters. Its host answers no calls.
inline weft_create made_from(const std::vector<weft_value>& values) {
  static constexpr weft_host kHost{sizeof(weft_host), WEFT_ABI_MAJOR, WEFT_ABI_MINOR, kHostName,
                                   kVersion,          nullptr,        nullptr,        nullptr,
                                   nullptr,           nullptr,        &host_extension};
  return {sizeof(weft_create), 0, &kHost, values.data(), values.size(), nullptr};
}

/// Values for a component's parameters as the contract carries them, with the storage behind them.
class Arguments {
 public:
  Arguments() = default;
  Arguments(Arguments&&) = default;
  Arguments& operator=(Arguments&&) = default;

  void add_number(const std::string& name, double value) {
    store(name, WEFT_VALUE_F64, numbers_.emplace_back(1, value));
  }
  void add_numbers(const std::string& name, std::vector<double> values) {
    store(name, WEFT_VALUE_F64, numbers_.emplace_back(std::move(values)), true);
  }
  void add_integer(const std::string& name, std::int64_t value) {
    store(name, WEFT_VALUE_I64, integers_.emplace_back(1, value));
  }
  void add_integers(const std::string& name, std::vector<std::int64_t> values) {
    store(name, WEFT_VALUE_I64, integers_.emplace_back(std::move(values)), true);
  }
  void add_flag(const std::string& name, bool value) {
    store(name, WEFT_VALUE_BOOL, flags_.emplace_back(1, value ? 1 : 0));
  }
  void add_component(const std::string& name, std::uint64_t handle) {
    store(name, WEFT_VALUE_COMPONENT, handles_.emplace_back(1, handle));
  }
  /// A choice, a text, a path (one text), labels (key, text, ...) or a list of texts.
  void add_texts(const std::string& name, weft_value_type type, std::vector<std::string> texts,
                 bool is_vector = false) {
    const std::vector<std::string>& kept = texts_.emplace_back(std::move(texts));
    std::vector<const char*> pointers;
    for (const std::string& text : kept) pointers.push_back(text.c_str());
    store(name, type, pointers_.emplace_back(std::move(pointers)), is_vector);
  }

  const std::vector<weft_value>& values() const { return values_; }

 private:
  template <class T>
  void store(const std::string& name, weft_value_type type, const std::vector<T>& data,
             bool is_vector = false) {
    const char* stable_name = names_.emplace_back(name).c_str();
    values_.push_back({stable_name, type, is_vector ? 1 : 0, data.size(), data.data(), {}});
  }

  // Deques, so that pointers into earlier elements stay valid, also when this object moves.
  std::deque<std::string> names_;
  std::deque<std::vector<double>> numbers_;
  std::deque<std::vector<std::int64_t>> integers_;
  std::deque<std::vector<std::uint8_t>> flags_;
  std::deque<std::vector<std::uint64_t>> handles_;
  std::deque<std::vector<std::string>> texts_;
  std::deque<std::vector<const char*>> pointers_;
  std::vector<weft_value> values_;
};

}  // namespace weft::host
