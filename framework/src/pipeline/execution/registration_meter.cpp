// SPDX-License-Identifier: Apache-2.0
#include "pipeline/execution/registration_meter.hpp"

#include <string>
#include <utility>
#include <vector>

#include "roles/role_rules.hpp"

namespace weft {

Result<std::unique_ptr<RegistrationMeter>> RegistrationMeter::open(
    const PipelineConfig& config, host::Lane& lane, host::RecordPtr templ,
    const host::ComponentSpec& pass) {
  auto input = PipelineInput::open(config, lane);
  if (!input) return input.error();
  if (input->is_live()) {
    return Error{Errc::invalid_value,
                 "the source of the run is live, so that its images cannot be read again; add the "
                 "stage '" +
                     pass.component().id + "' to the pipeline and run it",
                 config.file};
  }
  std::unique_ptr<RegistrationMeter> meter(
      new RegistrationMeter(*std::move(input), lane, std::move(templ)));
  const auto made = lane.instantiate(pass, pass.component().id);
  if (!made) return made.error();
  meter->pass_ = *made;
  const auto ready = lane.prepare(**made, *meter->template_, *meter->input_.camera());
  if (!ready) return ready.error();
  return meter;
}

Result<host::RecordPtr> RegistrationMeter::measure(std::uint64_t frame, const host::Record& shape) {
  const std::string name = "frame " + std::to_string(frame);
  const auto read = input_.read(frame);
  if (!read || !read->input.failure.empty()) return host::RecordPtr();
  const host::RecordPtr image = read->input.find("image");
  if (image == nullptr) {
    return Error{Errc::no_result,
                 name +
                     " has no image to compare with the flat reference; measure a pipeline "
                     "whose source gives images",
                 {}};
  }
  const std::vector<weft_record> inputs{template_->view("template"),
                                        input_.camera()->view("camera"), image->view("image"),
                                        shape.view("shape")};
  host::Outcome outcome = lane_.call(*pass_, kRunStage, inputs, frame);
  if (!outcome.usable()) {
    const Error& error = outcome.error;
    return Error{error.code, name + ": " + error.message, error.where};
  }
  return outcome.find("registration");
}

}  // namespace weft
