// SPDX-License-Identifier: Apache-2.0
#include "matcher.hpp"

#include <cmath>
#include <weft/core/index.hpp>

namespace weft::sift_gpu {

GpuMatcher::GpuMatcher(Params& p) : matching_(p) {
  device_.read(p);
  p.component("fallback", fallback_,
              "matcher that replaces this one, with its own parameters; see without_device");
}

std::vector<matchers::Neighbours> GpuMatcher::search(const matchers::Sides& sides,
                                                     const CancelledCheck& cancelled) {
  places_.clear();
  for (std::int64_t i = 0; i < sides.trains.count(); ++i) {
    places_.push_back(static_cast<float>(sides.trains.xy_px(i, 0)));
    places_.push_back(static_cast<float>(sides.trains.xy_px(i, 1)));
  }
  const bool root = matching_.root_sift();
  search_->load_queries(sides.queries.descriptors, root, cancelled);
  search_->load_trains(sides.trains.descriptors, root, cancelled);
  const auto [pairs, best_queries] = search_->run(
      places_, {static_cast<float>(matching_.elsewhere_px()), matching_.mutual()}, cancelled);
  std::vector<matchers::Neighbours> neighbours;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Pair& pair = pairs[i];
    const auto query = static_cast<int>(i);
    if (pair.best < 0 || pair.second < 0) continue;
    if (matching_.mutual() && best_queries[to_index(pair.best)] != query) continue;
    neighbours.push_back({query, pair.best, std::sqrt(static_cast<double>(pair.best_square)),
                          std::sqrt(static_cast<double>(pair.second_square))});
  }
  return neighbours;
}

Result<Correspondences> GpuMatcher::match(const MatcherInput& in) {
  auto sides = matching_.sides(in);
  if (!sides) return sides.error();
  const auto device = device_.open();
  if (!device) return device.error();
  if (*device == nullptr) {
    return device_.flagged(in.call, fallback_.match(in.call, sides->image, sides->templ));
  }
  if (sides->templ.metric != "l2") {
    return Error{Errc::unsupported, "matchers/gpu compares descriptors of metric l2, not " +
                                        sides->templ.metric + "; use matchers/descriptor"};
  }
  abandoned_.bury();
  const std::string doing = "matching " + std::to_string(sides->queries.count()) + " x " +
                            std::to_string(sides->trains.count()) + " descriptors on " +
                            (*device)->name();
  try {
    if (search_ == nullptr || !search_->is_on(**device))
      search_ = std::make_unique<Search>(*device);
    return matching_.answer(*sides, search(*sides, [&] { return in.call.cancelled(); }));
  } catch (const OutOfReach& lost) {
    search_.reset();
    return lost.error;
  } catch (const cl::Error& failure) {
    search_.reset();
    device_.give_up();
    return error_of(failure, doing);
  } catch (const Cancelled&) {
    abandoned_.keep(std::move(search_));
    return Error{Errc::cancelled, "cancelled while " + doing};
  }
}

}  // namespace weft::sift_gpu
