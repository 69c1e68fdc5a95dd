// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace weft {

/// Thrown when a component uses an input that was not delivered.
struct NotDelivered : std::logic_error {
  using std::logic_error::logic_error;
};

namespace detail {

[[noreturn]] inline void not_delivered(const char* slot) {
  const std::string name = '"' + std::string(slot) + '"';
  throw NotDelivered("input " + name + " is not delivered: add " + name +
                     " to kAbout.needs, or ask first whether it is there");
}

}  // namespace detail

/// An optional input: a std::optional that throws NotDelivered, with the input's name, when an
/// absent value is used.
template <class RecordType>
class OptionalInput : public std::optional<RecordType> {
  using Base = std::optional<RecordType>;

 public:
  using Base::Base;
  OptionalInput() = default;
  OptionalInput(Base record) : Base(std::move(record)) {}

  const RecordType& operator*() const& {
    expect_it();
    return Base::operator*();
  }
  RecordType& operator*() & {
    expect_it();
    return Base::operator*();
  }
  RecordType&& operator*() && {
    expect_it();
    return std::move(Base::operator*());
  }
  const RecordType* operator->() const { return &**this; }
  RecordType* operator->() { return &**this; }
  const RecordType& value() const { return **this; }

  /// Sets the name in kAbout, which lives as long as the program.
  void call_it(const char* slot) { slot_ = slot; }

 private:
  void expect_it() const {
    if (!this->has_value()) detail::not_delivered(slot_);
  }

  const char* slot_ = "";
};

/// An input with any number of records, including none.
template <class RecordType>
class ListInput : public std::vector<RecordType> {
 public:
  const RecordType& operator[](std::size_t i) const {
    if (i >= this->size()) detail::not_delivered(slot_);
    return std::vector<RecordType>::operator[](i);
  }
  const RecordType& front() const { return (*this)[0]; }
  const RecordType& back() const { return (*this)[this->size() - 1]; }

  /// Sets the name in kAbout, which lives as long as the program.
  void call_it(const char* slot) { slot_ = slot; }

 private:
  const char* slot_ = "";
};

}  // namespace weft
