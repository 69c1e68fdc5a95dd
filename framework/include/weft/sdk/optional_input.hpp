// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace weft {

/// What is thrown where a component uses an input that it was not given.
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

/// An input that a call may lack: a std::optional that is named when it is used although it is not
/// there. Throws NotDelivered then.
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

  /// What it is called in kAbout; lives as long as the program.
  void call_it(const char* slot) { slot_ = slot; }

 private:
  void expect_it() const {
    if (!this->has_value()) detail::not_delivered(slot_);
  }

  const char* slot_ = "";
};

/// An input of which a call has any number, none included; likewise.
template <class RecordType>
class ListInput : public std::vector<RecordType> {
 public:
  const RecordType& operator[](std::size_t i) const {
    if (i >= this->size()) detail::not_delivered(slot_);
    return std::vector<RecordType>::operator[](i);
  }
  const RecordType& front() const { return (*this)[0]; }
  const RecordType& back() const { return (*this)[this->size() - 1]; }

  /// What it is called in kAbout; lives as long as the program.
  void call_it(const char* slot) { slot_ = slot; }

 private:
  const char* slot_ = "";
};

}  // namespace weft
