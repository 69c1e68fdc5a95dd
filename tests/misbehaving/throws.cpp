// SPDX-License-Identifier: Apache-2.0
// Throws where its parameters specify, and what they specify.
#include <algorithm>
#include <new>
#include <stdexcept>
#include <weft/sdk/filter.hpp>

namespace {

enum class Place { nowhere, constructor, prepare, process };
enum class Kind { exception, number, memory, long_text };

class Throws final : public weft::Filter {
 public:
  explicit Throws(weft::Params& p) {
    p.choice("in", place_,
             {{"nowhere", Place::nowhere},
              {"constructor", Place::constructor},
              {"prepare", Place::prepare},
              {"process", Place::process}},
             "where it throws");
    p.choice("what", kind_,
             {{"exception", Kind::exception},
              {"number", Kind::number},
              {"memory", Kind::memory},
              {"long_text", Kind::long_text}},
             "what it throws");
    p.read("frame", frame_, "", {-1, 1e6}, "in which process throws, -1 for all");
    throw_in(Place::constructor);
  }

  weft::Result<void> prepare(const weft::PrepareInput&) override {
    throw_in(Place::prepare);
    return {};
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    if (frame_ < 0 || in.call.frame() == static_cast<std::uint64_t>(frame_)) {
      throw_in(Place::process);
    }
    const std::int64_t n = in.correspondences.count();
    weft::InlierMask mask{weft::Array<std::uint8_t>({n}, 0), weft::Array<double>({n}, 0.0), {}};
    std::fill_n(mask.kept.data(), n, std::uint8_t{1});
    return mask;
  }

 private:
  void throw_in(Place here) const {
    if (place_ != here) return;
    if (kind_ == Kind::number) throw 42;
    if (kind_ == Kind::memory) throw std::bad_alloc();
    std::string text = "the sky fell down";
    if (kind_ == Kind::long_text) {
      while (text.size() < 5000) text += "\xc3\xa9";  // two bytes each
    }
    throw std::runtime_error(text);
  }

  Place place_ = Place::nowhere;
  Kind kind_ = Kind::exception;
  int frame_ = -1;
};

}  // namespace

WEFT_PLUGIN(Throws, "filters/test_throws", "1.0.0", "Throws where and what it is told.")
