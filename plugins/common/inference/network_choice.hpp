// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/mistakes.hpp>
#include <weft/core/params.hpp>

#include "common/inference/network.hpp"

namespace weft::inference {

/// The parameters that all components with a network of the template have.
struct NetworkChoice {
  std::string path;
  Runtime runtime = Runtime::opencv;
  double least_probability = 0.6;  ///< [] of the mask, of a cell that counts

  /// Declares or reads all.
  void read(Params& p) {
    p.input_path("network", path,
                 "network file NAME.yaml of the template; the ONNX file is in the same folder",
                 Need::required);
    p.read("mask", least_probability, "", {0.0, 1.0},
           "minimum probability that a cell shows the object");
    read_runtime(p, runtime);
  }
  void check(Mistakes& mistakes) const {
    mistakes.expect("network", Network::check(path, runtime));
    mistakes.expect("runtime", Engine::check(runtime));
  }
};

}  // namespace weft::inference
