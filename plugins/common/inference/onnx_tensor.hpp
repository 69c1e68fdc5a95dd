// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <weft/core/result.hpp>

namespace weft::inference {

/// Checks one tensor of an ONNX file of `file_bytes` bytes and returns its number of elements. Its
/// size must be that of its data, and its weights must be finite. Element types are float32, int32
/// and int64. Data in other files are refused.
Result<std::int64_t> check_tensor(std::string_view bytes, std::size_t file_bytes);

/// An error in the contents of a file; the caller adds the path.
Error refused(const std::string& what);

/// The error of a file that ends or is damaged within a part.
Error damaged(const std::string& part);

/// A name of the file for a message: short, and printable whatever bytes it has.
std::string shown(std::string_view name);

}  // namespace weft::inference
