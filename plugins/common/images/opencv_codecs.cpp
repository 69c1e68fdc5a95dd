// SPDX-License-Identifier: Apache-2.0
#include "common/images/opencv_codecs.hpp"

#include <dlfcn.h>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

namespace weft::image_files {
namespace {

/// A function of the library by its mangled name; null if it is not there.
template <class Function>
Function* function(const char* name) {
  static void* const library = dlopen(WEFT_OPENCV_CODECS, RTLD_NOW | RTLD_LOCAL);
  return library != nullptr ? reinterpret_cast<Function*>(dlsym(library, name)) : nullptr;
}

}  // namespace

/// The log of OpenCV, to which libtiff reports, is silenced for good, as for films. The messages
/// that OpenCV itself prints for exceptions in its decoders cannot be disabled.
cv::Mat decode_by_opencv(const std::string& bytes, int flags) {
  using Decode = cv::Mat(cv::InputArray, int);
  static Decode* const decode = function<Decode>("_ZN2cv8imdecodeERKNS_11_InputArrayEi");
  if (bytes.empty() || decode == nullptr) return {};
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
  try {
    return decode(buffer, flags);
  } catch (const cv::Exception&) {  // reported by the caller: the file is at fault
    return {};
  }
}

std::vector<std::uint8_t> encode_by_opencv(const std::string& extension, const cv::Mat& image) {
  using Encode =
      bool(const cv::String&, cv::InputArray, std::vector<uchar>&, const std::vector<int>&);
  static Encode* const encode = function<Encode>(
      "_ZN2cv8imencodeERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKNS_11_InputArrayERSt"
      "6vectorIhSaIhEERKSB_IiSaIiEE");
  std::vector<std::uint8_t> bytes;
  if (encode == nullptr || !encode(extension, image, bytes, {})) return {};
  return bytes;
}

}  // namespace weft::image_files
