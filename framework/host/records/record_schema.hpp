// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::host {

/// One array of a vendor's record type, as weft_field.
struct FieldSchema {
  std::string name, shape, unit, meaning;
  std::int32_t dtype = 0;  ///< weft_dtype
  bool optional = false, may_be_nan = false;

  bool operator==(const FieldSchema&) const = default;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.name), visit(self.shape), visit(self.unit), visit(self.meaning);
    visit(self.dtype), visit(self.optional), visit(self.may_be_nan);
  }
};

/// A record type that the catalogue does not have, as a library declares it.
struct RecordSchema {
  std::string type;                 ///< "acme.depth/1"
  std::vector<FieldSchema> arrays;  ///< [.] its arrays

  bool operator==(const RecordSchema&) const = default;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.type), visit(self.arrays);
  }
};

/// The weft_dtype of "f64"; 0 where there is none.
std::int32_t dtype_called(std::string_view word);

/// As validate() of a record of the catalogue, by structure: its arrays, their elements and shapes,
/// and that they are finite. Nothing of it may lie in device memory.
Result<void> validate(const weft_record& record, const RecordSchema& schema);

}  // namespace weft::host
