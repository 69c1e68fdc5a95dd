// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/whole_file.hpp>

#include "host/records/record.hpp"

namespace weft::host {

/// Writes records as NumPy's npz: array `a` of slot `s` is the member `s/a.npy`, the record's type
/// the member `s/record_type.npy` (u8 text). The file appears whole: it is written under a
/// temporary name beside its place and renamed. Equal records give equal bytes.
/// Fails without records.
Result<void> write_npz(const std::string& file, const NamedRecords& records,
                       Durability durability = Durability::synced);

/// `none` is for a reader that counts bad records instead of refusing them.
enum class NpzCheck { catalogue, none };

/// Reads what write_npz wrote; each record is checked against the catalogue.
Result<NamedRecords> read_npz(const std::string& file, NpzCheck check = NpzCheck::catalogue);

}  // namespace weft::host
