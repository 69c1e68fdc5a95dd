// SPDX-License-Identifier: Apache-2.0
#include "common/inference/onnx_tensor.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <vector>

#include "common/inference/wire_reader.hpp"

namespace weft::inference {
namespace {

// Numbers of the fields in onnx.proto.
namespace tensor_field {
constexpr std::uint32_t kDims = 1, kType = 2, kFloats = 4, kInt32s = 5, kInt64s = 7, kName = 8,
                        kRaw = 9, kExternal = 13, kLocation = 14;
}

constexpr std::uint64_t kFloat32 = 1, kInt32 = 6, kInt64 = 7;
constexpr std::size_t kLongestName = 60;
constexpr std::size_t kMostAxes = 8;

/// The parts of a tensor that its check needs.
struct TensorParts {
  std::string name;
  std::uint64_t type = 0;
  std::vector<std::uint64_t> dims;
  std::optional<std::string_view> raw;
  std::uint64_t floats = 0, int32s = 0, int64s = 0;  ///< numbers of elements outside `raw`
  bool floats_are_finite = true;
  bool is_external = false;

  /// Elements of the list that belongs to the type.
  std::uint64_t listed() const {
    return type == kFloat32 ? floats : type == kInt32 ? int32s : int64s;
  }
};

bool is_finite_f32(const char* bytes) {
  float value = 0.0F;
  std::memcpy(&value, bytes, sizeof value);
  return std::isfinite(value);
}

bool all_finite_f32(std::string_view bytes) {
  for (std::size_t i = 0; i + sizeof(float) <= bytes.size(); i += sizeof(float)) {
    if (!is_finite_f32(bytes.data() + i)) return false;
  }
  return true;
}

/// Hands on the numbers of a field that may be packed; false if they are damaged.
template <class Take>
bool each_varint(const WireField& field, Take&& take) {
  if (field.kind == WireField::Kind::varint) {
    take(field.value);
    return true;
  }
  if (field.kind != WireField::Kind::bytes) return false;
  WireReader packed(field.bytes);
  while (!packed.at_end()) {
    const auto value = packed.varint();
    if (!value) return false;
    take(*value);
  }
  return true;
}

bool read_floats(const WireField& field, TensorParts& tensor) {
  if (field.kind == WireField::Kind::fixed32) {
    char bytes[sizeof(float)];
    std::memcpy(bytes, &field.value, sizeof bytes);
    tensor.floats_are_finite = tensor.floats_are_finite && is_finite_f32(bytes);
    ++tensor.floats;
    return true;
  }
  if (field.kind != WireField::Kind::bytes || field.bytes.size() % sizeof(float) != 0) return false;
  tensor.floats += field.bytes.size() / sizeof(float);
  tensor.floats_are_finite = tensor.floats_are_finite && all_finite_f32(field.bytes);
  return true;
}

bool read_tensor_field(const WireField& field, TensorParts& tensor) {
  const bool is_bytes = field.kind == WireField::Kind::bytes;
  switch (field.number) {
    case tensor_field::kDims:
      return each_varint(field, [&](std::uint64_t dim) {
        if (tensor.dims.size() <= kMostAxes) tensor.dims.push_back(dim);
      });
    case tensor_field::kType:
      tensor.type = field.value;
      return field.kind == WireField::Kind::varint;
    case tensor_field::kFloats:
      return read_floats(field, tensor);
    case tensor_field::kInt32s:
      return each_varint(field, [&](std::uint64_t) { ++tensor.int32s; });
    case tensor_field::kInt64s:
      return each_varint(field, [&](std::uint64_t) { ++tensor.int64s; });
    case tensor_field::kName:
      tensor.name = std::string(field.bytes.substr(0, kLongestName));
      return is_bytes;
    case tensor_field::kRaw:
      tensor.raw = field.bytes;
      return is_bytes;
    case tensor_field::kExternal:
      tensor.is_external = true;
      return true;
    case tensor_field::kLocation:
      tensor.is_external = tensor.is_external || field.value != 0;
      return true;
    default:
      return true;
  }
}

/// The number of elements; nothing if it is beyond `most`.
std::optional<std::uint64_t> element_count(const std::vector<std::uint64_t>& dims,
                                           std::uint64_t most) {
  if (dims.size() > kMostAxes) return std::nullopt;
  if (std::find(dims.begin(), dims.end(), 0U) != dims.end()) return 0;
  std::uint64_t count = 1;
  for (const std::uint64_t dim : dims) {
    if (dim > most / count) return std::nullopt;
    count *= dim;
  }
  return count;
}

Result<void> check_size(const TensorParts& tensor, std::uint64_t count, const std::string& which) {
  const std::uint64_t size = tensor.type == kInt64 ? 8 : 4;
  const std::uint64_t found = tensor.raw ? tensor.raw->size() / size : tensor.listed();
  const std::uint64_t all_listed = tensor.floats + tensor.int32s + tensor.int64s;
  const bool is_torn =
      tensor.raw ? tensor.raw->size() % size != 0 || all_listed > 0 : all_listed != tensor.listed();
  if (found == count && !is_torn) return {};
  return refused("is damaged: " + which + " should have " + std::to_string(count) +
                 " elements, but have " + std::to_string(found) + ": copy it again");
}

}  // namespace

Error refused(const std::string& what) { return {Errc::invalid_data, what}; }

Error damaged(const std::string& part) {
  return refused("is damaged or cut off within " + part + ": copy it again");
}

std::string shown(std::string_view name) {
  std::string text(name.substr(0, kLongestName));
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return "'" + text + "'";
}

Result<std::int64_t> check_tensor(std::string_view bytes, std::size_t file_bytes) {
  TensorParts tensor;
  for (WireReader reader(bytes); !reader.at_end();) {
    const auto field = reader.next();
    if (!field || !read_tensor_field(*field, tensor)) {
      return damaged("the weights " + shown(tensor.name));
    }
  }
  const std::string which = "the weights " + shown(tensor.name);
  if (tensor.is_external) {
    return refused("has " + which + " in another file: export them into the ONNX file");
  }
  if (tensor.type != kFloat32 && tensor.type != kInt32 && tensor.type != kInt64) {
    return refused("has " + which + " of the element type " + std::to_string(tensor.type) +
                   ": export float32, int32 or int64");
  }
  const auto count = element_count(tensor.dims, file_bytes);
  if (!count) {
    return refused("is damaged: " + which + " claim more elements than the file has bytes, " +
                   std::to_string(file_bytes) + ": copy it again");
  }
  if (auto sized = check_size(tensor, *count, which); !sized) return sized.error();
  const bool is_finite = tensor.raw ? all_finite_f32(*tensor.raw) : tensor.floats_are_finite;
  if (tensor.type == kFloat32 && !is_finite) {
    return refused("has a weight that is not finite in " + shown(tensor.name) +
                   ": train the network again");
  }
  return static_cast<std::int64_t>(*count);
}

}  // namespace weft::inference
