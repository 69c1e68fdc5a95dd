// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kit/testing/contract_checks.hpp"
#include "kit/testing/contract_subject.hpp"

/// Checks that components respect geometry: the same answer, moved, to a scene that is moved, and
/// accurate answers at the matches.
namespace weft::testing {

/// All checks of this folder. If one does not apply to the component, it reports the reason.
void check_geometry(const Subject& subject, Checks& checks);

/// Scenes that are permuted, given twice, shifted, scaled, rolled, mirrored and renumbered.
void check_symmetries(const Subject& subject, Checks& checks);

/// That exact matches give the truth within what the role owes, and noise no better answer.
void check_exactness(const Subject& subject, Checks& checks);

/// Checks that the warp of an image to itself is the identity.
void check_identity_warp(const Subject& subject, Checks& checks);

}  // namespace weft::testing
