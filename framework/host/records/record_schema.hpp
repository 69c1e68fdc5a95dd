// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::host {

/// One array of a record type, as weft_field.
struct FieldSchema {
  std::string name, shape, unit, meaning;
  std::int32_t dtype = 0;  ///< weft_dtype
  bool optional = false, may_be_nan = false;
  bool may_be_on_device = false;  ///< in the catalogue only

  bool operator==(const FieldSchema&) const = default;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.name), visit(self.shape), visit(self.unit), visit(self.meaning);
    visit(self.dtype), visit(self.optional), visit(self.may_be_nan);
  }
};

/// A record type: of the catalogue, or as a library declares it.
struct RecordSchema {
  std::string type;                 ///< "acme.depth/1"
  std::vector<FieldSchema> arrays;  ///< [.] its arrays, except those of a prefix like `diag.*`

  bool operator==(const RecordSchema&) const = default;

  const FieldSchema* find(std::string_view array) const;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.type), visit(self.arrays);
  }
};

/// The catalogue's schema of a type; null if it has no such type.
const RecordSchema* catalogue_schema(std::string_view type);

/// The weft_dtype of "f64"; 0 where there is none.
std::int32_t dtype_called(std::string_view word);

/// Checks that a record has the arrays of its schema, with their elements and shapes, and no NaN or
/// infinity in finite fields. All are in host memory unless the schema permits another. Arrays of
/// third parties are arbitrary, but must be readable and have a name that the catalogue will never
/// use. The Error names the array.
Result<void> validate(const weft_record& record, const RecordSchema& schema);

/// As above, for a record of the catalogue.
Result<void> validate(const weft_record& record);

/// The reason why validate() will refuse a record with this array, whatever its content, or an
/// empty text. Lengths that depend on other arrays are not compared.
std::string illegal_array(const RecordSchema& schema, const weft_array& array);

}  // namespace weft::host
