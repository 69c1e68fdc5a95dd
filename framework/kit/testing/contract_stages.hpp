// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kit/testing/contract_cases.hpp"
#include "kit/testing/contract_checks.hpp"

/// The parts of the contract, each for the components that it is about.
namespace weft::testing {

/// Usual and degenerate inputs, purity and cancelling, of components that are stages.
void check_stage(const Subject& subject, Checks& checks);

/// That warps are evaluated from their record alone and that their derivatives are such.
void check_warp(const Subject& subject, Checks& checks);

/// Opens it, counts its frames, reads the first and the last.
void check_source(const Subject& subject, Checks& checks);

/// Builds the template.
void check_template(const Subject& subject, Checks& checks);

/// Writes two frames into a temporary folder. `find` makes the subject with another output folder.
using FindIn = std::function<Result<Subject>(const std::string& output_folder)>;
void check_sink(const FindIn& find, Checks& checks);

/// All of it, as far as the component's role has it.
void check_component(const FindIn& find, Checks& checks);

/// Why a component that computes on devices cannot be tried here; empty where it can.
std::string lacks_device(const Subject& subject);

/// Checks for the same answer from `answer(performer)` after cancellation: at once, and after a few
/// polls of the cancel flag. `begin` makes a performer ready.
using AskFor = std::function<Answer(Performer&)>;
void check_cancelling(const Subject& subject, const Scene& scene, const AskFor& begin,
                      const AskFor& ask, Checks& checks);

}  // namespace weft::testing
