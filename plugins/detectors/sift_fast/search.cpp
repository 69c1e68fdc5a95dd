// SPDX-License-Identifier: Apache-2.0
#include "search.hpp"

#include <algorithm>
#include <bit>
#include <functional>
#include <thread>
#include <tuple>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "common/workers/sharing.hpp"

namespace weft::sift_fast {
namespace {

/// Passes of ten nanoseconds or so in a task, in an orientation and in a description.
constexpr int kPassesOfTask = 3'000, kPassesOfKeypoint = 200;
/// Keypoints that a thread takes at a time.
constexpr int kAtATime = 16;
/// Sigmas from a keypoint to the farthest gradients of its angle, and to most of its descriptor.
constexpr float kReachOfAngle = 4.5F, kReachOfDescriptor = 8.0F;

/// Prefetches the pixels around a spot, as far as `sigmas`: they arrive while another one is
/// computed.
void fetch(const Plane& layer, const Spot& spot, float sigmas) {
  constexpr int kStep = 32;
  const auto x = static_cast<int>(spot.x), y = static_cast<int>(spot.y);
  const auto radius = static_cast<int>(sigmas * spot.scale) + 1;
  const int left = std::max(x - radius, 0), right = std::min(x + radius, layer.width - 1);
  const int top = std::max(y - radius, 0), bottom = std::min(y + radius, layer.height - 1);
  for (int v = top; v <= bottom; ++v) {
    const std::int16_t* row = layer.row(v);
    for (int u = left; u < right + kStep; u += kStep) __builtin_prefetch(row + std::min(u, right));
  }
}

}  // namespace

Search::Search(const Settings& settings)
    : settings_(settings), blurs_(settings), refinement_(settings) {}

void Search::plan(int width, int height) {
  if (width == width_ && height == height_) return;
  width_ = height_ = 0;
  pyramid_.resize(width, height, settings_.upsample, blurs_.layers);
  schedule_.make(pyramid_, blurs_);
  const auto count = to_index(schedule_.count());
  if (count > done_capacity_) {
    done_ = std::make_unique<std::atomic<bool>[]>(count);
    done_capacity_ = count;
    candidates_.resize(count);
    found_.resize(count);
  }
  width_ = width;
  height_ = height;
}

void Search::reserve_workers(int threads) {
  while (static_cast<int>(workers_.size()) < threads) workers_.emplace_back();
}

bool Search::wait_for(const Task& task) {
  for (int needed = task.first_needed; needed < task.end_needed; ++needed) {
    while (!done_[to_index(needed)].load(std::memory_order_acquire)) {
      if (given_up_.load(std::memory_order_relaxed)) return false;
      std::this_thread::yield();
    }
  }
  return true;
}

void Search::search(const Task& task, Worker& worker) {
  const auto found =
      find_extrema(pyramid_.octave(task.octave), task.rows, refinement_.weakest(), worker.extrema);
  candidates_[to_index(task.id)].assign(found.begin(), found.end());
}

/// A refinement may walk to any row: it waits until all are made.
void Search::refine(const Task& task) {
  std::vector<Spot>& found = found_[to_index(task.id)];
  found.clear();
  for (const Candidate& at : candidates_[to_index(task.id)]) {
    auto spot = refinement_.refine(pyramid_.octave(task.octave), at.x, at.y, at.layer);
    if (!spot) continue;
    spot->octave = task.octave;
    found.push_back(*spot);
  }
  std::sort(found.begin(), found.end(), [](const Spot& a, const Spot& b) {
    return std::tuple(a.y, a.x, a.scale) < std::tuple(b.y, b.x, b.scale);
  });
}

void Search::carry_out(const Task& task, const GreyImage& image, Worker& worker) {
  if (task.kind == Task::Kind::load) {
    load_rows(image.pixels, image.stride, pyramid_.image(), task.rows);
  } else if (task.kind == Task::Kind::search) {
    search(task, worker);
  } else {
    const std::vector<Plane>& layers = pyramid_.octave(task.octave).layers;
    const Plane& to = layers[to_index(task.layer)];
    if (task.layer > 0) {
      blur_rows(layers[to_index(task.layer - 1)], blurs_.steps[to_index(task.layer)], to, task.rows,
                worker.rows);
    } else if (task.octave > 0) {
      halve_rows(pyramid_.octave(task.octave - 1).layers[to_index(settings_.octave_layers)], to,
                 task.rows);
    } else if (settings_.upsample) {
      double_rows(pyramid_.image(), blurs_.doubling, to, task.rows, worker.rows);
    } else {
      blur_rows(pyramid_.image(), blurs_.first, to, task.rows, worker.rows);
    }
  }
}

template <class Each>
void Search::for_each(std::size_t count, int threads, Each each) {
  reserve_workers(threads);
  const Shares shares{static_cast<int>(count), kAtATime, threads};
  share_out(pool_, shares, [&](int worker, int begin, int end) {
    for (int i = begin; i < end; ++i) each(workers_[to_index(worker)], to_index(i));
    if (worker == 0) worked(std::int64_t{kPassesOfKeypoint} * (end - begin));
    return true;
  });
}

std::span<const Spot> Search::find(const GreyImage& image, int threads) {
  plan(image.width, image.height);
  reserve_workers(threads);
  const std::span<const Task> tasks = schedule_.tasks();
  for (std::size_t i = 0; i < tasks.size(); ++i) done_[i].store(false, std::memory_order_relaxed);
  next_ = 0;
  given_up_ = false;
  auto work = [&](int worker) {
    try {
      for (std::size_t i = next_++; i < tasks.size(); i = next_++) {
        if (worker == 0) worked(kPassesOfTask);
        if (given_up_ || !wait_for(tasks[i])) return;
        carry_out(tasks[i], image, workers_[to_index(worker)]);
        done_[to_index(tasks[i].id)].store(true, std::memory_order_release);
      }
    } catch (...) {
      given_up_ = true;
      throw;
    }
  };
  pool_.run(threads, std::ref(work));
  for_each(tasks.size(), threads, [&](Worker&, std::size_t i) {
    if (tasks[i].kind == Task::Kind::search) refine(tasks[i]);
  });
  gather(tasks);
  return extrema_;
}

/// Extrema of all tasks, each once: refinement may lead from two pixels to the same place.
void Search::gather(std::span<const Task> tasks) {
  std::size_t most = 0;
  for (const Task& task : tasks) {
    if (task.kind == Task::Kind::search) most += found_[to_index(task.id)].size();
  }
  const std::size_t size = std::bit_ceil(2 * most + 1);
  seen_.assign(size, -1);
  extrema_.clear();
  for (const Task& task : tasks) {
    if (task.kind != Task::Kind::search) continue;
    for (const Spot& spot : found_[to_index(task.id)]) {
      const std::uint64_t key = (std::uint64_t{std::bit_cast<std::uint32_t>(spot.x)} << 32U) +
                                std::bit_cast<std::uint32_t>(spot.y);
      std::size_t slot = (key * 0x9E3779B97F4A7C15U >> 32U) % size;
      const auto is_other = [&](int index) {
        const Spot& there = extrema_[to_index(index)];
        return there.x != spot.x || there.y != spot.y || there.octave != spot.octave ||
               there.scale != spot.scale;
      };
      while (seen_[slot] >= 0 && is_other(seen_[slot])) slot = (slot + 1) % size;
      if (seen_[slot] >= 0) continue;
      seen_[slot] = static_cast<int>(extrema_.size());
      extrema_.push_back(spot);
    }
  }
}

const Plane& Search::layer_of(const Spot& spot) const {
  return pyramid_.octave(spot.octave).layers[to_index(spot.layer)];
}

std::span<const Spot> Search::orient(std::span<const Spot> extrema, int threads) {
  constexpr std::size_t kMost = Orientation::kMostAngles;
  angles_.resize(extrema.size() * kMost);
  angle_counts_.resize(extrema.size());
  for_each(extrema.size(), threads, [&](Worker& worker, std::size_t i) {
    const Spot& next = extrema[std::min(i + 1, extrema.size() - 1)];
    fetch(layer_of(next), next, kReachOfAngle);
    const auto angles = worker.orientation.angles(layer_of(extrema[i]), extrema[i]);
    std::copy(angles.begin(), angles.end(), angles_.data() + i * kMost);
    angle_counts_[i] = angles.size();
  });
  keypoints_.clear();
  for (std::size_t i = 0; i < extrema.size(); ++i) {
    for (std::size_t a = 0; a < angle_counts_[i]; ++a) {
      keypoints_.push_back(extrema[i]);
      keypoints_.back().angle = angles_[i * kMost + a];
    }
  }
  return keypoints_;
}

void Search::describe(std::span<const Spot> keypoints, float* descriptors, int threads) {
  for_each(keypoints.size(), threads, [&](Worker& worker, std::size_t i) {
    const Spot& next = keypoints[std::min(i + 1, keypoints.size() - 1)];
    fetch(layer_of(next), next, kReachOfDescriptor);
    worker.description.describe(layer_of(keypoints[i]), keypoints[i],
                                descriptors + i * kDescriptorLength);
  });
}

}  // namespace weft::sift_fast
