// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kit/testing/contract_checks.hpp"
#include "kit/testing/contract_subject.hpp"

/// What components owe to geometry: the same answer, moved, to a scene that is moved, and right
/// ones where the matches are.
namespace weft::testing {

/// All checks of this room. Of each that says nothing of the component, it tells why.
void check_geometry(const Subject& subject, Checks& checks);

/// Scenes that are permuted, given twice, shifted, scaled, rolled, mirrored and renumbered.
void check_symmetries(const Subject& subject, Checks& checks);

/// That exact matches give the truth within what the role owes, and noise no better answer.
void check_exactness(const Subject& subject, Checks& checks);

/// That the warp of a picture to itself moves nothing.
void check_identity_warp(const Subject& subject, Checks& checks);

}  // namespace weft::testing
