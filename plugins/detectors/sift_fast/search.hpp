// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/workers/workers.hpp"
#include "description.hpp"
#include "extrema.hpp"
#include "kernels.hpp"
#include "orientation.hpp"
#include "pyramid.hpp"
#include "refinement.hpp"
#include "schedule.hpp"
#include "settings.hpp"

namespace weft::sift_fast {

/// Grey levels 0 to 255, `stride` bytes between rows.
struct GreyImage {
  const std::uint8_t* pixels = nullptr;
  std::ptrdiff_t stride = 0;
  int width = 0, height = 0;
};

/// SIFT in three steps, so that keypoints can be chosen in between. Each step takes the number of
/// threads that share it and gives the same bits for any; memory and threads are kept for the next
/// image. Cancelled calls throw weft::Stopped.
class Search {
 public:
  explicit Search(const Settings& settings);

  /// Refined extrema of the image, in a fixed order; valid until the next image.
  std::span<const Spot> find(const GreyImage& image, int threads);

  /// Keypoints at extrema of the last image: one or more each, in their order, by angle.
  std::span<const Spot> orient(std::span<const Spot> extrema, int threads);

  /// Descriptors of keypoints of the last image, [n, kDescriptorLength].
  void describe(std::span<const Spot> keypoints, float* descriptors, int threads);

 private:
  /// The buffers that one thread needs.
  struct Worker {
    RowScratch rows;
    ExtremaScratch extrema;
    Orientation orientation;
    Description description;
  };

  void plan(int width, int height);
  void reserve_workers(int threads);
  void carry_out(const Task& task, const GreyImage& image, Worker& worker);
  void search(const Task& task, Worker& worker);
  void refine(const Task& task);
  void gather(std::span<const Task> tasks);
  /// Waits until all that a task needs is done; false when another thread has given up.
  bool wait_for(const Task& task);
  /// Calls `each(worker, i)` for i in [0, count), a few at a time.
  template <class Each>
  void for_each(std::size_t count, int threads, Each each);
  const Plane& layer_of(const Spot& spot) const;

  Settings settings_;
  Blurs blurs_;
  Refinement refinement_;
  Pyramid pyramid_;
  Schedule schedule_;
  Workers pool_;
  std::vector<Worker> workers_;
  int width_ = 0, height_ = 0;

  std::unique_ptr<std::atomic<bool>[]> done_;  ///< flags of tasks
  std::size_t done_capacity_ = 0;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> given_up_{false};

  std::vector<std::vector<Candidate>> candidates_;  ///< candidates of each task
  std::vector<std::vector<Spot>> found_;            ///< spots of each task
  std::vector<int> seen_;                           ///< hash table of `extrema_`
  std::vector<Spot> extrema_, keypoints_;
  std::vector<float> angles_;  ///< angles of each extremum, room for Orientation::kMostAngles
  std::vector<std::size_t> angle_counts_;
};

}  // namespace weft::sift_fast
