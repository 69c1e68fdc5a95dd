// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

namespace weft::inference {

/// One field of a message in the wire format of Protocol Buffers.
struct WireField {
  enum class Kind { varint, fixed64, bytes, fixed32 };
  std::uint32_t number = 0;
  Kind kind = Kind::varint;
  std::uint64_t value = 0;   ///< value of a varint or a fixed number
  std::string_view bytes{};  ///< contents of a text, a message or a packed list
};

/// Reads the fields of a message. It never reads beyond the bytes that it is given, and each field
/// advances it, so that it ends on any bytes.
class WireReader {
 public:
  explicit WireReader(std::string_view bytes) : rest_(bytes) {}

  bool at_end() const { return rest_.empty(); }

  /// The next field; nothing if the bytes end within it or are no field.
  std::optional<WireField> next() {
    const auto key = varint();
    if (!key) return std::nullopt;
    WireField field;
    if (*key >> 3U == 0 || *key >> 3U > 0x1FFFFFFFU) return std::nullopt;
    field.number = static_cast<std::uint32_t>(*key >> 3U);
    switch (*key & 7U) {
      case 0:
        return with_varint(field);
      case 1:
        field.kind = WireField::Kind::fixed64;
        return with_fixed(field, 8);
      case 2:
        field.kind = WireField::Kind::bytes;
        return with_bytes(field);
      case 5:
        field.kind = WireField::Kind::fixed32;
        return with_fixed(field, 4);
      default:
        return std::nullopt;  // groups, which ONNX does not use
    }
  }

  std::optional<std::uint64_t> varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64 && !rest_.empty(); shift += 7) {
      const auto byte = static_cast<unsigned char>(rest_.front());
      rest_.remove_prefix(1);
      value |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
      if (byte < 0x80U) return value;
    }
    return std::nullopt;
  }

 private:
  std::optional<WireField> with_varint(WireField field) {
    const auto value = varint();
    if (!value) return std::nullopt;
    field.value = *value;
    return field;
  }
  std::optional<WireField> with_fixed(WireField field, std::size_t size) {
    if (rest_.size() < size) return std::nullopt;
    std::memcpy(&field.value, rest_.data(), size);  // little endian, as on all our machines
    rest_.remove_prefix(size);
    return field;
  }
  std::optional<WireField> with_bytes(WireField field) {
    const auto size = varint();
    if (!size || *size > rest_.size()) return std::nullopt;
    field.bytes = rest_.substr(0, static_cast<std::size_t>(*size));
    rest_.remove_prefix(field.bytes.size());
    return field;
  }

  std::string_view rest_;
};

}  // namespace weft::inference
