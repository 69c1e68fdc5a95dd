// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <weft/data/catalogue.hpp>

#include "host.hpp"
#include "host/records/record_schema.hpp"

namespace weft::abi_test {

void print_catalogue() {
  for_each_record_type([]<class RecordType>(std::type_identity<RecordType>) {
    const host::RecordSchema& schema = *host::catalogue_schema(RecordType::kType);
    std::cout << "record " << schema.type << '\n';
    for (const host::FieldSchema& field : schema.arrays) {
      std::cout << "array " << schema.type << '.' << field.name << ' ' << dtype_name(field.dtype)
                << " [" << field.shape << "] " << (field.optional ? "optional" : "required")
                << (field.may_be_nan ? " nan" : "") << (field.may_be_on_device ? " device" : "")
                << (field.unit.empty() ? "" : " unit ") << field.unit << '\n';
    }
  });
}

}  // namespace weft::abi_test
