// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "pipeline/execution/input.hpp"

namespace weft {

/// Compares the images of a finished run with its shapes: reads the images again and calls a pass
/// that makes a registration of image and shape.
class RegistrationMeter {
 public:
  /// Opens the source of the run's pipeline and makes the pass; `config` and `lane` outlive the
  /// meter. `templ` is the template of the run. Fails where the source is live, whose images are
  /// gone, and with what opening the source or making the pass says.
  static Result<std::unique_ptr<RegistrationMeter>> open(const PipelineConfig& config,
                                                         host::Lane& lane, host::RecordPtr templ,
                                                         const host::ComponentSpec& pass);

  /// The registration of a frame; null where its image cannot be read. Frames in their order. Fails
  /// where the source gives no image, and with the error of the pass.
  Result<host::RecordPtr> measure(std::uint64_t frame, const host::Record& shape);

 private:
  RegistrationMeter(PipelineInput input, host::Lane& lane, host::RecordPtr templ)
      : input_(std::move(input)), lane_(lane), template_(std::move(templ)) {}

  PipelineInput input_;
  host::Lane& lane_;
  host::RecordPtr template_;
  host::Instance* pass_ = nullptr;
};

}  // namespace weft
