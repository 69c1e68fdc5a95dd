/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What OpenCL C and CUDA C++ call differently. The other files are written in their common part, with
 * these names; launches have one group of GROUP items for each thing, or one item for each pixel.
 * GROUP and other sizes come from kernel_sizes.hpp, as options of the compiler.
 */
#if defined(__OPENCL_VERSION__)

#define KERNEL __kernel
#define FUNCTION
#define GLOBAL __global
#define LOCAL __local
#define LOCAL_POINTER __local
#define BARRIER() barrier(CLK_LOCAL_MEM_FENCE)
#define GLOBAL_ID(axis) ((int)get_global_id(axis))
#define GROUP_ID ((int)get_group_id(0))
#define LOCAL_ID ((int)get_local_id(0))
#define NEXT(counter) atomic_inc(counter)
#define ADD_LOCAL(place, value) atomic_add(place, value)
#define TO_BYTE(value) convert_uchar_sat_rte(value)
typedef ulong wide;
#pragma OPENCL FP_CONTRACT OFF

#else

#define KERNEL extern "C" __global__
#define FUNCTION static __device__
#define GLOBAL
#define LOCAL __shared__
#define LOCAL_POINTER
#define BARRIER() __syncthreads()
#define GLOBAL_ID(axis) \
  ((int)((axis) == 0 ? blockIdx.x * blockDim.x + threadIdx.x : blockIdx.y * blockDim.y + threadIdx.y))
#define GROUP_ID ((int)blockIdx.x)
#define LOCAL_ID ((int)threadIdx.x)
#define NEXT(counter) atomicAdd(counter, 1)
#define ADD_LOCAL(place, value) atomicAdd(place, value)
#define TO_BYTE(value) ((uchar)fminf(fmaxf(rintf(value), 0.0f), 255.0f))
typedef unsigned char uchar;
typedef unsigned long long wide;

#endif

#define PI 3.14159265358979f
