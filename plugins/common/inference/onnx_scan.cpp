// SPDX-License-Identifier: Apache-2.0
#include "common/inference/onnx_scan.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "common/inference/onnx_tensor.hpp"
#include "common/inference/wire_reader.hpp"

namespace weft::inference {
namespace {

// Numbers of the fields in onnx.proto.
namespace model_field {
constexpr std::uint32_t kGraph = 7, kOpset = 8, kFunctions = 25;
}
namespace graph_field {
constexpr std::uint32_t kNode = 1, kInitializer = 5, kInput = 11, kOutput = 12, kSparse = 15;
}
namespace node_field {
constexpr std::uint32_t kInput = 1, kOutput = 2, kName = 3, kOperator = 4, kAttribute = 5,
                        kDomain = 7;
}
namespace attribute_field {
constexpr std::uint32_t kTensor = 5, kGraph = 6, kTensors = 10, kGraphs = 11;
}

constexpr std::size_t kMostOperators = 10000;
constexpr std::size_t kMostInputs = 10000;  // older exporters list the weights as inputs

constexpr std::string_view kLayers[] = {"AveragePool", "BatchNormalization",
                                        "Conv",        "ConvTranspose",
                                        "Gemm",        "InstanceNormalization",
                                        "MatMul",      "MaxPool",
                                        "Resize",      "Softmax"};
constexpr std::string_view kElementwise[] = {
    "Add",   "Clip", "Div",  "Elu",  "HardSigmoid", "Identity", "LeakyRelu", "Mul",
    "PRelu", "Pow",  "Relu", "Selu", "Sigmoid",     "Sqrt",     "Sub",       "Tanh"};
constexpr std::string_view kShapes[] = {
    "Concat",     "Constant",  "DepthToSpace", "Expand", "Flatten", "Pad",     "ReduceL2",
    "ReduceMean", "ReduceSum", "Reshape",      "Shape",  "Slice",   "Squeeze", "Transpose"};
// The beginnings of the names of operators that draw random numbers.
constexpr std::string_view kRandom[] = {"Bernoulli", "Multinomial", "Random"};

bool is_known(std::string_view op, Runtime runtime) {
  if (runtime == Runtime::onnxruntime) {
    return !op.empty() &&
           std::none_of(std::begin(kRandom), std::end(kRandom),
                        [&](std::string_view random) { return op.starts_with(random); });
  }
  const auto has = [&](const auto& list) {
    return std::find(std::begin(list), std::end(list), op) != std::end(list);
  };
  return has(kLayers) || has(kElementwise) || has(kShapes);
}

class Scan {
 public:
  Scan(std::size_t file_bytes, Runtime runtime) : file_bytes_(file_bytes), runtime_(runtime) {}

  Result<void> model(std::string_view bytes) {
    bool has_graph = false, has_opset = false;
    for (WireReader reader(bytes); !reader.at_end();) {
      const auto field = reader.next();
      if (!field) return damaged("the model");
      has_opset = has_opset || field->number == model_field::kOpset;
      if (field->number == model_field::kFunctions) {
        return refused("has functions: export the network with their operators instead");
      }
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
    std::string op, name, domain;
    std::size_t inputs = 0, outputs = 0;
    for (WireReader reader(bytes); !reader.at_end();) {
      const auto field = reader.next();
      if (!field) return damaged("a node");
      if (field->number == node_field::kInput) ++inputs;
      if (field->number == node_field::kOutput) ++outputs;
      if (field->number == node_field::kName) name = std::string(field->bytes);
      if (field->number == node_field::kOperator) op = std::string(field->bytes);
      if (field->number == node_field::kDomain) domain = std::string(field->bytes);
      if (field->number != node_field::kAttribute) continue;
      if (auto read = attribute(field->bytes); !read) return read;
    }
    if (!is_known(op, runtime_) || !(domain.empty() || domain == "ai.onnx")) {
      return Error{Errc::unsupported,
                   "has the operator " + shown(op) +
                       (domain.empty() ? "" : " of " + shown(domain)) + " (node " + shown(name) +
                       "), which is not supported: export the network " + "without it" +
                       (runtime_ == Runtime::opencv ? ", or use runtime: onnxruntime" : "")};
    }
    if (outputs == 0 || (inputs == 0 && op != "Constant")) {
      return refused("has a node " + shown(name) + " (" + op +
                     ") without inputs or outputs: export the network again");
    }
    contents.operators.push_back(op);
    if (contents.operators.size() > kMostOperators) return refused("has more than 10000 nodes");
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
    const auto count = check_tensor(bytes, file_bytes_);
    if (!count) return count.error();
    contents.weights += *count;
    return {};
  }

  std::uint64_t file_bytes_;
  Runtime runtime_;
};

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), 8); ++i) {
    text += (i == 0 ? "" : ", ") + shown(names[i]);
  }
  return text.empty() ? "none" : text;
}

}  // namespace

Result<OnnxContents> scan_onnx(std::string_view bytes, Runtime runtime) {
  if (bytes.empty()) return refused("is empty: give an ONNX file");
  // ONNX Runtime reads files with this mark in another format, which is not scanned.
  if (bytes.substr(std::min<std::size_t>(bytes.size(), 4)).starts_with("ORTM")) {
    return refused("has the format ORT: give the ONNX file");
  }
  Scan scan(bytes.size(), runtime);
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
