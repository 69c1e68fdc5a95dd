// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/params.hpp>

namespace weft::inference {

/// The library that runs a network on the processor.
enum class Runtime {
  opencv,       ///< OpenCV's module dnn
  onnxruntime,  ///< ONNX Runtime, a shared library that is opened at run time
};

/// Declares or reads the parameter that all components with a network have.
inline void read_runtime(Params& p, Runtime& runtime) {
  p.choice("runtime", runtime, {{"opencv", Runtime::opencv}, {"onnxruntime", Runtime::onnxruntime}},
           "library that runs the network; onnxruntime: ONNX Runtime, installed separately");
}

}  // namespace weft::inference
