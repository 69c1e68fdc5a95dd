// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>
#include <weft/data/array.hpp>

#include "kept_descriptors.hpp"

namespace weft::sift_gpu {

/// The result of the search for a query, as the kernels write it; -1 where there is none.
struct Pair {
  std::int32_t best, second;
  float best_square, second_square;  ///< squared distances
};

/// Thrown for descriptors that are kept on another device and cannot be had from there.
struct OutOfReach {
  Error error;
};

/// Exact search for nearest descriptors on a device. Methods throw as those of Queue.
class Search {
 public:
  explicit Search(std::shared_ptr<Device> device);

  bool is_on(const Device& device) const { return device_.get() == &device; }

  /// Descriptors [count,length], here or kept on a device; with `root` each, which is not negative,
  /// becomes sqrt(d / |d|_1). Descriptors on this device are not copied, and repeated ones, such as
  /// those of a template, are loaded only once. Both sides have the same length. Throws OutOfReach
  /// too.
  void load_queries(const Array<float>& descriptors, bool root, const CancelledCheck& cancelled) {
    load(queries_, descriptors, root, cancelled);
  }
  void load_trains(const Array<float>& descriptors, bool root, const CancelledCheck& cancelled) {
    load(trains_, descriptors, root, cancelled);
  }

  struct Options {
    float elsewhere_px = 0.0F;  ///< the second is farther than this from the best; 0: any other
    bool mutual = false;        ///< the query nearest to each train is wanted too
  };
  struct Found {
    std::vector<Pair> pairs;                 ///< [queries]
    std::vector<std::int32_t> best_queries;  ///< [trains] with `mutual`, else empty
  };

  /// For each query its nearest trains; `places` [trains,2] px. The lowest index wins a tie.
  Found run(std::span<const float> places, const Options& options, const CancelledCheck& cancelled);

  bool idle() const { return queue_.idle(); }

 private:
  /// Kept from call to call.
  struct GrowingBuffer {
    cl::Buffer buffer;
    std::uint64_t bytes = 0;
  };
  /// Descriptors [count,length] f32 as the search wants them, with their squared norms.
  struct Loaded {
    GrowingBuffer rows, norms;
    int count = 0, length = 0;
    std::shared_ptr<const KeptDescriptors> source;  ///< null where they came from the host
    bool root = false;
  };
  const cl::Buffer& reserve(GrowingBuffer& place, std::uint64_t bytes);
  void load(Loaded& side, const Array<float>& descriptors, bool root,
            const CancelledCheck& cancelled);
  void send(const Array<float>& descriptors, const cl::Buffer& to);
  void launch_block(int first, int rows, const Options& options);

  std::shared_ptr<Device> device_;
  Queue queue_;
  cl::Kernel widen_, load_, distances_, nearest_, nearest_queries_;
  Loaded queries_, trains_;
  GrowingBuffer squares_, places_, pairs_, least_, best_;
};

}  // namespace weft::sift_gpu
