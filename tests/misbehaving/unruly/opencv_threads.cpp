// SPDX-License-Identifier: Apache-2.0
// Decides for the whole process how many threads OpenCV uses.
#include <opencv2/core.hpp>
#include <weft/sdk/filter.hpp>

namespace {

class Bossy final : public weft::Filter {
 public:
  explicit Bossy(weft::Params&) {}
  weft::Result<weft::InlierMask> filter(const weft::FilterInput&) override {
    cv::setNumThreads(cv::getNumThreads() + 3);
    return weft::no_result("never finds one");
  }
};

}  // namespace

WEFT_PLUGIN(Bossy, "filters/test_bossy", "1.0.0", "Changes what all share.")
