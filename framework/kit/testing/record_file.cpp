// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>
#include <weft/testing/record_file.hpp>

#include "host/records/npz.hpp"

namespace weft::testing {

void write_record_file(const std::string& file, const char* slot, HostRecord record) {
  const auto written = host::write_npz(file, {{slot, std::move(record)}});
  if (!written) throw std::runtime_error(written.error().message);
}

RecordFile::RecordFile(const std::string& file) {
  auto read = host::read_npz(file);
  if (!read) throw std::runtime_error(file + ": " + read.error().message);
  records_.assign(read->begin(), read->end());
}

}  // namespace weft::testing
