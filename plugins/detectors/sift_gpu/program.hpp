// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device.hpp"

namespace weft::sift_gpu {

/// The text of all kernels, in the order in which they need one another.
extern const char* const kKernels;

/// The kernels for a device, from the cache of programs if they are there. Throws cl::BuildError or
/// cl::Error.
cl::Program compiled(const cl::Context& context, const cl::Device& device);

}  // namespace weft::sift_gpu
