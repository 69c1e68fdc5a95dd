// SPDX-License-Identifier: Apache-2.0
#include "faulty_driver.hpp"

#include <dlfcn.h>

namespace weft::sift_gpu {
namespace {

template <class Function>
Function* real(Function* /*same_type*/, const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

// No fault is planned for the functions that query contexts: these are the loader's.
cl_context context_of(cl_context context) { return context; }
cl_context context_of(cl_command_queue queue) {
  cl_context context = nullptr;
  clGetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof(context), &context, nullptr);
  return context;
}
cl_context context_of(cl_kernel kernel) {
  cl_context context = nullptr;
  clGetKernelInfo(kernel, CL_KERNEL_CONTEXT, sizeof(context), &context, nullptr);
  return context;
}
cl_context context_of(cl_program program) {
  cl_context context = nullptr;
  real(&clGetProgramInfo, "clGetProgramInfo")(program, CL_PROGRAM_CONTEXT, sizeof(context),
                                              &context, nullptr);
  return context;
}
cl_context context_of(cl_event event) {
  cl_context context = nullptr;
  real(&clGetEventInfo, "clGetEventInfo")(event, CL_EVENT_CONTEXT, sizeof(context), &context,
                                          nullptr);
  return context;
}
template <class Other>
cl_context context_of(const Other& /*of_none*/) {
  return nullptr;
}

/// A function that returns its status.
template <class... Parameters, class First, class... Rest>
cl_int call(cl_int (*function)(Parameters...), const char* name, First first, Rest... rest) {
  const cl_int refusal = FaultyDriver::get().refusal(name, context_of(first));
  return refusal != CL_SUCCESS ? refusal : real(function, name)(first, rest...);
}

/// A function that returns what it makes, with its status beside.
template <class Made, class... Parameters, class First, class... Rest>
Made make(Made (*function)(Parameters...), const char* name, cl_int* status, First first,
          Rest... rest) {
  const cl_int refusal = FaultyDriver::get().refusal(name, context_of(first));
  if (refusal == CL_SUCCESS) return real(function, name)(first, rest..., status);
  if (status != nullptr) *status = refusal;
  return nullptr;
}

}  // namespace

FaultyDriver& FaultyDriver::get() {
  static FaultyDriver driver;
  return driver;
}

void FaultyDriver::plan(std::optional<Fault> fault) {
  const std::lock_guard lock(mutex_);
  fault_ = std::move(fault);
  calls_.clear();
  asked_ = nullptr;
  put_off_ = 0;
}

void FaultyDriver::work() {
  plan({});
  const std::lock_guard lock(mutex_);
  for (const cl_event event : hanging_) {
    clWaitForEvents(1, &event);  // a busy machine may still execute what was reported as running
    clReleaseEvent(event);
  }
  hanging_.clear();
}

std::map<std::string, int> FaultyDriver::calls() const {
  const std::lock_guard lock(mutex_);
  return calls_;
}

int FaultyDriver::calls(const std::string& function) const {
  const std::lock_guard lock(mutex_);
  const auto found = calls_.find(function);
  return found != calls_.end() ? found->second : 0;
}

int FaultyDriver::put_off() const {
  const std::lock_guard lock(mutex_);
  return put_off_;
}

cl_int FaultyDriver::answer(const std::string& function, bool counted, cl_context context) {
  if (const auto found = lost_.find(context); found != lost_.end()) return found->second;
  const int call = counted ? ++calls_[function] : calls_[function];
  if (!fault_ || fault_->function != function) return CL_SUCCESS;
  if (fault_->kind == Fault::always) return fault_->code;
  if (!counted || call != fault_->nth) return CL_SUCCESS;
  if (fault_->kind == Fault::lost && context != nullptr) {
    clRetainContext(context);
    lost_[context] = fault_->code;
  }
  return fault_->code;
}

cl_int FaultyDriver::refusal(const std::string& function, cl_context context) {
  const std::lock_guard lock(mutex_);
  asked_ = nullptr;
  return answer(function, true, context);
}

cl_int FaultyDriver::refusal(cl_event event, cl_context context) {
  const std::lock_guard lock(mutex_);
  const bool another = event != asked_;
  asked_ = event;
  if (!hanging_.contains(event) || lost_.contains(context)) {
    const cl_int code = answer(kWait, another, context);
    if (code != CL_RUNNING) return code;
    clRetainEvent(event);
    hanging_.insert(event);
  }
  ++put_off_;
  return CL_RUNNING;
}

}  // namespace weft::sift_gpu

// Each function identifies itself by its own name, __func__.
#pragma GCC visibility push(default)
extern "C" {
using weft::sift_gpu::call;
using weft::sift_gpu::make;

cl_int clGetPlatformIDs(cl_uint room, cl_platform_id* platforms, cl_uint* count) {
  return call(&clGetPlatformIDs, __func__, room, platforms, count);
}
cl_int clGetDeviceIDs(cl_platform_id platform, cl_device_type type, cl_uint room,
                      cl_device_id* devices, cl_uint* count) {
  return call(&clGetDeviceIDs, __func__, platform, type, room, devices, count);
}
cl_int clGetDeviceInfo(cl_device_id device, cl_device_info what, size_t room, void* value,
                       size_t* size) {
  return call(&clGetDeviceInfo, __func__, device, what, room, value, size);
}
cl_int clGetPlatformInfo(cl_platform_id platform, cl_platform_info what, size_t room, void* value,
                         size_t* size) {
  return call(&clGetPlatformInfo, __func__, platform, what, room, value, size);
}
cl_context clCreateContext(const cl_context_properties* properties, cl_uint count,
                           const cl_device_id* devices,
                           void(CL_CALLBACK* notify)(const char*, const void*, size_t, void*),
                           void* user, cl_int* status) {
  return make(&clCreateContext, __func__, status, properties, count, devices, notify, user);
}
cl_program clCreateProgramWithSource(cl_context context, cl_uint count, const char** texts,
                                     const size_t* lengths, cl_int* status) {
  return make(&clCreateProgramWithSource, __func__, status, context, count, texts, lengths);
}
cl_program clCreateProgramWithBinary(cl_context context, cl_uint count, const cl_device_id* devices,
                                     const size_t* lengths, const unsigned char** binaries,
                                     cl_int* of_each, cl_int* status) {
  return make(&clCreateProgramWithBinary, __func__, status, context, count, devices, lengths,
              binaries, of_each);
}
cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id* devices,
                      const char* options, void(CL_CALLBACK* notify)(cl_program, void*),
                      void* user) {
  const cl_int refusal =
      weft::sift_gpu::FaultyDriver::get().refusal(__func__, weft::sift_gpu::context_of(program));
  // The program is built even so, because its log is requested.
  const cl_int status = weft::sift_gpu::real(&clBuildProgram, __func__)(program, count, devices,
                                                                        options, notify, user);
  return refusal != CL_SUCCESS ? refusal : status;
}
cl_int clGetProgramInfo(cl_program program, cl_program_info what, size_t room, void* value,
                        size_t* size) {
  return call(&clGetProgramInfo, __func__, program, what, room, value, size);
}
cl_command_queue clCreateCommandQueue(cl_context context, cl_device_id device,
                                      cl_command_queue_properties properties, cl_int* status) {
  return make(&clCreateCommandQueue, __func__, status, context, device, properties);
}
cl_int clReleaseCommandQueue(cl_command_queue queue) {  // counted, never refused
  static_cast<void>(weft::sift_gpu::FaultyDriver::get().refusal(__func__, nullptr));
  return weft::sift_gpu::real(&clReleaseCommandQueue, __func__)(queue);
}
cl_kernel clCreateKernel(cl_program program, const char* name, cl_int* status) {
  return make(&clCreateKernel, __func__, status, program, name);
}
cl_int clSetKernelArg(cl_kernel kernel, cl_uint index, size_t size, const void* value) {
  return call(&clSetKernelArg, __func__, kernel, index, size, value);
}
cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t bytes, void* from,
                      cl_int* status) {
  return make(&clCreateBuffer, __func__, status, context, flags, bytes, from);
}
cl_int clGetMemObjectInfo(cl_mem object, cl_mem_info what, size_t room, void* value, size_t* size) {
  return call(&clGetMemObjectInfo, __func__, object, what, room, value, size);
}
cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint axes,
                              const size_t* offset, const size_t* items, const size_t* group,
                              cl_uint count, const cl_event* after, cl_event* event) {
  return call(&clEnqueueNDRangeKernel, __func__, queue, kernel, axes, offset, items, group, count,
              after, event);
}
cl_int clEnqueueFillBuffer(cl_command_queue queue, cl_mem buffer, const void* pattern,
                           size_t pattern_bytes, size_t offset, size_t bytes, cl_uint count,
                           const cl_event* after, cl_event* event) {
  return call(&clEnqueueFillBuffer, __func__, queue, buffer, pattern, pattern_bytes, offset, bytes,
              count, after, event);
}
cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset,
                            size_t bytes, const void* from, cl_uint count, const cl_event* after,
                            cl_event* event) {
  return call(&clEnqueueWriteBuffer, __func__, queue, buffer, blocking, offset, bytes, from, count,
              after, event);
}
cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset,
                           size_t bytes, void* to, cl_uint count, const cl_event* after,
                           cl_event* event) {
  return call(&clEnqueueReadBuffer, __func__, queue, buffer, blocking, offset, bytes, to, count,
              after, event);
}
cl_int clEnqueueBarrierWithWaitList(cl_command_queue queue, cl_uint count, const cl_event* after,
                                    cl_event* event) {
  return call(&clEnqueueBarrierWithWaitList, __func__, queue, count, after, event);
}
cl_int clFlush(cl_command_queue queue) { return call(&clFlush, __func__, queue); }
cl_int clGetEventInfo(cl_event event, cl_event_info what, size_t room, void* value, size_t* size) {
  using weft::sift_gpu::FaultyDriver;
  const cl_int answer = FaultyDriver::get().refusal(event, weft::sift_gpu::context_of(event));
  if (answer != CL_SUCCESS && answer != CL_RUNNING) return answer;
  const cl_int status =
      weft::sift_gpu::real(&clGetEventInfo, __func__)(event, what, room, value, size);
  if (answer == CL_RUNNING && value != nullptr) *static_cast<cl_int*>(value) = CL_RUNNING;
  return status;
}
}
#pragma GCC visibility pop
