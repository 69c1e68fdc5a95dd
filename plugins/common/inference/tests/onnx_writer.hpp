// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Writes ONNX files in tests, so that what a network answers is known by construction.
namespace weft::inference::testing {

/// A message in the wire format of Protocol Buffers.
class WireWriter {
 public:
  WireWriter& number(unsigned field, std::uint64_t value) {
    varint(field << 3U);
    varint(value);
    return *this;
  }
  WireWriter& text(unsigned field, std::string_view value) {
    varint(field << 3U | 2U);
    varint(value.size());
    bytes_ += value;
    return *this;
  }
  /// A text that claims another length than it has.
  WireWriter& torn_text(unsigned field, std::uint64_t claimed, std::string_view value) {
    varint(field << 3U | 2U);
    varint(claimed);
    bytes_ += value;
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  void varint(std::uint64_t value) {
    for (; value >= 0x80U; value >>= 7U) bytes_ += static_cast<char>((value & 0x7FU) | 0x80U);
    bytes_ += static_cast<char>(value);
  }
  std::string bytes_;
};

template <class Number>
std::string raw(const std::vector<Number>& values) {
  std::string bytes(values.size() * sizeof(Number), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

enum class ElementType : std::uint64_t { f32 = 1, i64 = 7, f16 = 10 };

/// A TensorProto with its data as raw_data.
struct OnnxTensor {
  std::string name;
  std::vector<std::uint64_t> dims;
  std::string data;
  ElementType type = ElementType::f32;
  bool lists_floats = false;  ///< as float_data instead

  std::string bytes() const {
    WireWriter tensor;
    for (const std::uint64_t dim : dims) tensor.number(1, dim);
    tensor.number(2, static_cast<std::uint64_t>(type)).text(8, name);
    tensor.text(lists_floats ? 4 : 9, data);
    return tensor.bytes();
  }
};

inline OnnxTensor f32_tensor(std::string name, std::vector<std::uint64_t> dims,
                             const std::vector<float>& values) {
  return {std::move(name), std::move(dims), raw(values)};
}

inline OnnxTensor i64_tensor(std::string name, const std::vector<std::int64_t>& values) {
  return {std::move(name), {values.size()}, raw(values), ElementType::i64};
}

struct OnnxNode {
  std::string op;
  std::vector<std::string> inputs, outputs;
  std::vector<std::pair<std::string, std::vector<std::int64_t>>> lists{};
  std::vector<std::pair<std::string, std::int64_t>> numbers{};
  std::string domain{};

  std::string bytes() const {
    WireWriter node;
    for (const std::string& input : inputs) node.text(1, input);
    for (const std::string& output : outputs) node.text(2, output);
    node.text(3, op + "_" + outputs.front()).text(4, op).text(7, domain);
    for (const auto& [name, values] : lists) {
      WireWriter attribute;
      attribute.text(1, name);
      for (const std::int64_t value : values)
        attribute.number(8, static_cast<std::uint64_t>(value));
      node.text(5, attribute.number(20, 7).bytes());
    }
    for (const auto& [name, value] : numbers) {
      WireWriter attribute;
      attribute.text(1, name).number(3, static_cast<std::uint64_t>(value)).number(20, 2);
      node.text(5, attribute.bytes());
    }
    return node.bytes();
  }
};

/// An input or output of the network.
struct OnnxValue {
  std::string name;
  std::vector<std::uint64_t> dims;
  ElementType type = ElementType::f32;

  std::string bytes() const {
    WireWriter shape;
    for (const std::uint64_t dim : dims) shape.text(1, WireWriter().number(1, dim).bytes());
    const std::string tensor =
        WireWriter().number(1, static_cast<std::uint64_t>(type)).text(2, shape.bytes()).bytes();
    return WireWriter().text(1, name).text(2, WireWriter().text(1, tensor).bytes()).bytes();
  }
};

struct OnnxModel {
  std::vector<OnnxNode> nodes;
  std::vector<OnnxTensor> tensors;
  std::vector<OnnxValue> inputs, outputs;
  std::uint64_t opset = 11;

  std::string bytes() const {
    WireWriter graph;
    for (const OnnxNode& node : nodes) graph.text(1, node.bytes());
    graph.text(2, "test");
    for (const OnnxTensor& tensor : tensors) graph.text(5, tensor.bytes());
    for (const OnnxValue& input : inputs) graph.text(11, input.bytes());
    for (const OnnxValue& output : outputs) graph.text(12, output.bytes());
    WireWriter model;
    model.number(1, 6).text(2, "weft").text(7, graph.bytes());
    return model.text(8, WireWriter().text(1, "").number(2, opset).bytes()).bytes();
  }
};

}  // namespace weft::inference::testing
