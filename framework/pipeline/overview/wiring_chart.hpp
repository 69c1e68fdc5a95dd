// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/graph/graph.hpp"

namespace weft {

/// The wiring of a pipeline as a chart: components are rows in the order in which they run, values
/// are columns in the order in which they are made. A value's column begins in the row of its
/// maker and ends in the row of its last reader, so that lines to readers never meet its name.
struct WiringChart {
  struct Value {
    std::string type;  ///< "correspondences"
    std::size_t maker = 0;
    std::size_t last_reader = 0;  ///< the maker where nothing reads it
  };
  struct Input {
    std::size_t value = 0;  ///< index into WiringChart::values
    bool required = true;
  };
  struct Row {
    std::string name;          ///< "source", "filters", "earlier frames"
    std::string id;            ///< its component's; empty for earlier frames
    std::optional<double> ms;  ///< [ms] of a call
    std::vector<Input> inputs;
    std::vector<std::size_t> outputs;  ///< indices into WiringChart::values
  };

  std::vector<Row> rows;      ///< [.] source, template, values of earlier frames, stages, sinks
  std::vector<Value> values;  ///< [.] those of a row are adjacent
};

/// The chart of a pipeline. `times_ms` has the times of components, by the names of their rows.
WiringChart wiring_chart(const CheckedPipeline& pipeline,
                         const std::map<std::string, double>& times_ms = {});

}  // namespace weft
