// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>
#include <weft/data/array.hpp>

#include "queue.hpp"

namespace weft::sift_gpu {

/// Descriptors [count,length] f32 on a device, with their squared norms.
struct DeviceDescriptors {
  cl::Buffer rows, norms;
  int count = 0, length = 0;
};

/// What the search found for a query, as the kernels write it; -1 where there is none.
struct Pair {
  std::int32_t best, second;
  float best_square, second_square;  ///< squared distances
};

/// Exact search for nearest descriptors on a device. Methods throw as those of Queue.
class Search {
 public:
  explicit Search(std::shared_ptr<Device> device);

  /// Descriptors [count,length]; with `root` each, which is not negative, becomes sqrt(d / |d|_1).
  DeviceDescriptors load(const Array<float>& descriptors, bool root);

  struct Options {
    float elsewhere_px = 0.0F;  ///< the second is farther than this from the best; 0: any other
    bool mutual = false;        ///< best_queries() is wanted too
  };

  /// For each query its nearest trains; `places` [trains,2] px. The lowest index wins a tie.
  std::vector<Pair> run(const DeviceDescriptors& queries, const DeviceDescriptors& trains,
                        std::span<const float> places, const Options& options,
                        const CancelledCheck& cancelled);

  /// The query nearest to each train, from the last run with `mutual`.
  const std::vector<std::int32_t>& best_queries() const { return best_queries_; }

  bool idle() const { return queue_.idle(); }

 private:
  /// A buffer that is kept from call to call and grows.
  struct Kept {
    cl::Buffer buffer;
    std::uint64_t bytes = 0;
  };
  const cl::Buffer& reserve(Kept& kept, std::uint64_t bytes);

  Queue queue_;
  cl::Kernel load_, distances_, nearest_, nearest_queries_;
  Kept squares_, places_, pairs_, least_, best_;
  std::vector<std::int32_t> best_queries_;
};

}  // namespace weft::sift_gpu
