// SPDX-License-Identifier: Apache-2.0
#include "common/inference/onnx_scan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <weft/core/quote.hpp>

#include "common/inference/wire_reader.hpp"

namespace weft::inference {
namespace {

// Numbers of the fields in onnx.proto.
namespace model_field {
constexpr std::uint32_t kGraph = 7, kOpset = 8;
}
namespace graph_field {
constexpr std::uint32_t kNode = 1, kInitializer = 5, kInput = 11, kOutput = 12, kSparse = 15;
}
namespace node_field {
constexpr std::uint32_t kInput = 1, kOutput = 2, kName = 3, kOperator = 4, kAttribute = 5;
}
namespace attribute_field {
constexpr std::uint32_t kTensor = 5, kGraph = 6, kTensors = 10, kGraphs = 11;
}
namespace tensor_field {
constexpr std::uint32_t kDims = 1, kType = 2, kFloats = 4, kInt32s = 5, kInt64s = 7, kName = 8,
                        kRaw = 9, kExternal = 13, kLocation = 14;
}

constexpr std::uint64_t kFloat32 = 1, kInt32 = 6, kInt64 = 7;
constexpr std::size_t kMostNodes = 10000;
constexpr std::size_t kLongestName = 60;
constexpr std::size_t kMostAxes = 8;
constexpr std::size_t kMostInputs = 10000;  // older exporters list the weights as inputs

constexpr std::array<std::string_view, 21> kOperators{
    "Add",     "AveragePool", "BatchNormalization",
    "Concat",  "Constant",    "Conv",
    "Flatten", "Gemm",        "Identity",
    "MatMul",  "MaxPool",     "Mul",
    "Pad",     "Relu",        "Reshape",
    "Resize",  "Sigmoid",     "Slice",
    "Softmax", "Sub",         "Transpose"};

Error refused(const std::string& what) { return {Errc::invalid_data, what}; }

Error damaged(const std::string& part) {
  return refused("is damaged or cut off within " + part + ": copy it again");
}

/// A name of the file for a message: short, and printable whatever bytes it has.
std::string shown(std::string_view name) {
  std::string text(name.substr(0, kLongestName));
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return "'" + text + "'";
}

/// The parts of a tensor that its check needs.
struct TensorParts {
  std::string name;
  std::uint64_t type = 0;
  std::vector<std::uint64_t> dims;
  std::optional<std::string_view> raw;
  std::uint64_t listed = 0;  ///< number of elements outside `raw`
  bool listed_are_finite = true;
  bool is_external = false;
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

/// Appends the numbers of a field that may be packed; false if they are damaged.
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
    tensor.listed_are_finite = tensor.listed_are_finite && is_finite_f32(bytes);
    ++tensor.listed;
    return true;
  }
  if (field.kind != WireField::Kind::bytes || field.bytes.size() % sizeof(float) != 0) return false;
  tensor.listed += field.bytes.size() / sizeof(float);
  tensor.listed_are_finite = tensor.listed_are_finite && all_finite_f32(field.bytes);
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
    case tensor_field::kInt64s:
      return each_varint(field, [&](std::uint64_t) { ++tensor.listed; });
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

class Scan {
 public:
  explicit Scan(std::size_t file_bytes) : file_bytes_(file_bytes) {}

  Result<void> model(std::string_view bytes) {
    bool has_graph = false, has_opset = false;
    for (WireReader reader(bytes); !reader.at_end();) {
      const auto field = reader.next();
      if (!field) return damaged("the model");
      has_opset = has_opset || field->number == model_field::kOpset;
      if (field->number != model_field::kGraph) continue;
      if (has_graph || field->kind != WireField::Kind::bytes) return damaged("the model");
      has_graph = true;
      if (auto read = graph(field->bytes); !read) return read;
    }
    if (!has_graph) return refused("has no network: give an ONNX file");
    if (!has_opset) return damaged("the model, which has no version of its operators,");
    return {};
  }

  OnnxContents contents;

 private:
  Result<void> graph(std::string_view bytes) {
    for (WireReader reader(bytes); !reader.at_end();) {
      const auto field = reader.next();
      if (!field) return damaged("the graph");
      if (auto read = graph_part(*field); !read) return read;
    }
    if (contents.operators.empty()) return refused("has a network without operators");
    return {};
  }

  Result<void> graph_part(const WireField& field) {
    switch (field.number) {
      case graph_field::kNode:
        return node(field.bytes);
      case graph_field::kInitializer:
        return tensor(field.bytes);
      case graph_field::kInput:
        return add(field.bytes, contents.inputs);
      case graph_field::kOutput:
        return add(field.bytes, contents.outputs);
      case graph_field::kSparse:
        return refused("has sparse weights: export them as dense ones");
      default:
        return {};
    }
  }

  /// Adds the name of an input or output of the network.
  static Result<void> add(std::string_view bytes, std::vector<std::string>& names) {
    if (names.size() >= kMostInputs) return refused("has more than 10000 inputs or outputs");
    for (WireReader reader(bytes); !reader.at_end();) {
      const auto field = reader.next();
      if (!field) return damaged("an input or output");
      if (field->number == 1) names.emplace_back(field->bytes);
    }
    return {};
  }

  Result<void> node(std::string_view bytes) {
    std::string op, name;
    std::size_t inputs = 0, outputs = 0;
    for (WireReader reader(bytes); !reader.at_end();) {
      const auto field = reader.next();
      if (!field) return damaged("a node");
      if (field->number == node_field::kInput) ++inputs;
      if (field->number == node_field::kOutput) ++outputs;
      if (field->number == node_field::kName) name = std::string(field->bytes);
      if (field->number == node_field::kOperator) op = std::string(field->bytes);
      if (field->number != node_field::kAttribute) continue;
      if (auto read = attribute(field->bytes); !read) return read;
    }
    if (std::find(kOperators.begin(), kOperators.end(), op) == kOperators.end()) {
      return Error{Errc::unsupported, "has the operator " + shown(op) + " (node " + shown(name) +
                                          "), which is not supported: export the network without "
                                          "it"};
    }
    if (outputs == 0 || (inputs == 0 && op != "Constant")) {
      return refused("has a node " + shown(name) + " (" + op +
                     ") without inputs or outputs: export the network again");
    }
    contents.operators.push_back(op);
    if (contents.operators.size() > kMostNodes) return refused("has more than 10000 nodes");
    return {};
  }

  Result<void> attribute(std::string_view bytes) {
    for (WireReader reader(bytes); !reader.at_end();) {
      const auto field = reader.next();
      if (!field) return damaged("an attribute");
      const bool is_tensor =
          field->number == attribute_field::kTensor || field->number == attribute_field::kTensors;
      if (field->number == attribute_field::kGraph || field->number == attribute_field::kGraphs) {
        return refused("has a graph within a node: export the network without If and Loop");
      }
      if (!is_tensor) continue;
      if (auto read = tensor(field->bytes); !read) return read;
    }
    return {};
  }

  Result<void> tensor(std::string_view bytes) {
    TensorParts parts;
    for (WireReader reader(bytes); !reader.at_end();) {
      const auto field = reader.next();
      if (!field || !read_tensor_field(*field, parts)) {
        return damaged("the weights " + shown(parts.name));
      }
    }
    return check(parts);
  }

  Result<void> check(const TensorParts& tensor) {
    const std::string which = "the weights " + shown(tensor.name);
    if (tensor.is_external) {
      return refused("has " + which + " in another file: export them into the ONNX file");
    }
    if (tensor.type != kFloat32 && tensor.type != kInt32 && tensor.type != kInt64) {
      return refused("has " + which + " of the element type " + std::to_string(tensor.type) +
                     ": export float32, int32 or int64");
    }
    const auto count = element_count(tensor.dims, file_bytes_);
    if (!count) {
      return refused("is damaged: " + which + " claim more elements than the file has bytes, " +
                     std::to_string(file_bytes_) + ": copy it again");
    }
    const std::uint64_t size = tensor.type == kInt64 ? 8 : 4;
    const std::uint64_t found = tensor.raw ? tensor.raw->size() / size : tensor.listed;
    const bool is_torn = tensor.raw && (tensor.raw->size() % size != 0 || tensor.listed > 0);
    if (found != *count || is_torn) {
      return refused("is damaged: " + which + " should have " + std::to_string(*count) +
                     " elements, but have " + std::to_string(found) + ": copy it again");
    }
    const bool is_float = tensor.type == kFloat32;
    if (is_float && !(tensor.raw ? all_finite_f32(*tensor.raw) : tensor.listed_are_finite)) {
      return refused("has a weight that is not finite in " + shown(tensor.name) +
                     ": train the network again");
    }
    contents.weights += static_cast<std::int64_t>(*count);
    return {};
  }

  std::uint64_t file_bytes_;
};

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), 8); ++i) {
    text += (i == 0 ? "" : ", ") + shown(names[i]);
  }
  return text.empty() ? "none" : text;
}

}  // namespace

Result<OnnxContents> scan_onnx(std::string_view bytes) {
  if (bytes.empty()) return refused("is empty: give an ONNX file");
  Scan scan(bytes.size());
  if (auto read = scan.model(bytes); !read) return read.error();
  return std::move(scan.contents);
}

Result<void> check_names(const OnnxContents& contents, const std::string& input,
                         const std::vector<std::string>& outputs) {
  const auto has = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (!has(contents.inputs, input)) {
    return refused("has no input " + shown(input) + ", but " + listed(contents.inputs) +
                   ": correct it in the yaml file");
  }
  for (const std::string& output : outputs) {
    if (has(contents.outputs, output)) continue;
    return refused("has no output " + shown(output) + ", but " + listed(contents.outputs) +
                   ": correct it in the yaml file");
  }
  return {};
}

}  // namespace weft::inference
