// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <weft/host/npz.hpp>

namespace weft::testing {

/// Writes one noun into a file of records (npz). Throws std::runtime_error with the reason.
template <class Noun>
void write_record_file(const std::string& file, const char* slot, const Noun& noun) {
  const auto written = host::write_npz(file, {{slot, host::Record::copy_of(noun)}});
  if (!written) throw std::runtime_error(written.error().message);
}

/// A file of records, checked against the catalogue.
class RecordFile {
 public:
  /// Throws std::runtime_error with the reason.
  explicit RecordFile(const std::string& file) {
    auto read = host::read_npz(file);
    if (!read) throw std::runtime_error(file + ": " + read.error().message);
    records_ = *std::move(read);
  }

  std::size_t count() const { return records_.size(); }

  /// The first record of this type, if there is one; it borrows from this.
  template <class Noun>
  std::optional<Noun> get() const {
    for (const auto& [slot, record] : records_) {
      if (record->type() != Noun::kType) continue;
      if (auto noun = host::view_as<Noun>(*record)) return *std::move(noun);
    }
    return std::nullopt;
  }

 private:
  host::NamedRecords records_;
};

}  // namespace weft::testing
