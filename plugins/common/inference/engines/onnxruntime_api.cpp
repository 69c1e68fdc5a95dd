// SPDX-License-Identifier: Apache-2.0
#include "common/inference/engines/onnxruntime_api.hpp"

#include <dlfcn.h>

#include <cstdlib>

#include "common/inference/engines/engines.hpp"

namespace weft::inference::ort {
namespace {

constexpr const char* kVariable = "WEFT_ONNXRUNTIME";

}  // namespace

Result<Api> Api::open() {
  const char* given = std::getenv(kVariable);
  const bool is_given = given != nullptr && *given != '\0';
  const std::string path = is_given ? given : "libonnxruntime.so.1";
  // Threads and thread-local objects of the library outlive a session, so that it stays loaded.
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (library == nullptr) {
    const char* reason = dlerror();
    return Error{Errc::not_found,
                 "ONNX Runtime cannot be opened: " + (reason != nullptr ? reason : path) +
                     "; set " + kVariable +
                     " to the path of libonnxruntime.so.1 (docs/install.md), or use runtime: "
                     "opencv"};
  }
  const auto base_of = reinterpret_cast<const ApiBase* (*)()>(dlsym(library, "OrtGetApiBase"));
  const ApiBase* base = base_of != nullptr ? base_of() : nullptr;
  if (base == nullptr) {
    return Error{Errc::incompatible, path +
                                         " is not ONNX Runtime, because it lacks OrtGetApiBase: "
                                         "correct " +
                                         kVariable};
  }
  Table* table = base->get_api(kVersion);
  if (table == nullptr) {
    return Error{Errc::incompatible, path + " is ONNX Runtime " + one_line(base->version()) +
                                         ", but 1." + std::to_string(kVersion) +
                                         " or later is needed: install a later version"};
  }
  return Api(table);
}

std::string Api::failure(Status* status) const {
  if (status == nullptr) return {};
  const std::string text = one_line((*this)[kErrorMessage](status));
  (*this)[kReleaseStatus](status);
  return text.empty() ? "unknown error" : text;
}

}  // namespace weft::inference::ort
