// SPDX-License-Identifier: Apache-2.0
#include "session.hpp"

#include <algorithm>
#include <cstring>
#include <tuple>
#include <weft/core/index.hpp>

namespace weft::sift_gpu {
namespace {

constexpr int kTileWidth = 32, kTileHeight = 8;
constexpr int kPixelsPerSpot = 200;  // at first; buffers grow where there are more
constexpr int kFewestSpots = 1024;

const cl::NDRange kTile(kTileWidth, kTileHeight);

cl::NDRange pixels_of(int width, int height) {
  const auto whole = [](int length, int tile) {
    return static_cast<cl::size_type>((length + tile - 1) / tile * tile);
  };
  return {whole(width, kTileWidth), whole(height, kTileHeight)};
}

std::uint64_t layer_size(const Octave& octave) {
  return static_cast<std::uint64_t>(octave.width) * static_cast<std::uint64_t>(octave.height);
}

int first_capacity(const ScalePlan& plan) {
  const std::int64_t pixels = std::int64_t{plan.width} * plan.height;
  return static_cast<int>(std::max<std::int64_t>(kFewestSpots, pixels / kPixelsPerSpot));
}

std::uint64_t image_bytes(const ScalePlan& plan, int channels) {
  return static_cast<std::uint64_t>(plan.image_width) *
         static_cast<std::uint64_t>(plan.image_height) * static_cast<std::uint64_t>(channels);
}

std::uint64_t scratch_size(const ScalePlan& plan) {
  return static_cast<std::uint64_t>(plan.width) * static_cast<std::uint64_t>(plan.height);
}

}  // namespace

std::uint64_t Session::bytes_needed(const ScalePlan& plan, int channels) {
  return image_bytes(plan, channels) + sizeof(float) * (plan.pyramid_size + scratch_size(plan)) +
         2 * sizeof(Spot) * static_cast<std::uint64_t>(first_capacity(plan));
}

std::uint64_t Session::largest_buffer_bytes(const ScalePlan& plan) {
  return sizeof(float) * plan.pyramid_size;
}

Session::Session(std::shared_ptr<Device> device, int width, int height, int channels,
                 const Settings& settings, bool timed)
    : device_(std::move(device)),
      settings_(settings),
      plan_(width, height, settings),
      channels_(channels),
      queue_(device_, timed),
      grey_levels_(queue_.kernel("grey_levels")),
      blur_rows_(queue_.kernel("blur_rows")),
      blur_columns_(queue_.kernel("blur_columns")),
      halve_(queue_.kernel("halve")),
      extrema_(queue_.kernel("extrema")),
      orientations_(queue_.kernel("orientations")),
      descriptions_(queue_.kernel("descriptions")),
      image_(queue_.buffer(image_bytes(plan_, channels))),
      scratch_(queue_.buffer(sizeof(float) * scratch_size(plan_))),
      pyramid_(queue_.buffer(sizeof(float) * plan_.pyramid_size)),
      octaves_(queue_.buffer(sizeof(Octave) * plan_.octaves.size())),
      taps_(queue_.buffer(sizeof(float) * plan_.taps.size())),
      count_(queue_.buffer(sizeof(cl_int))),
      extrema_capacity_(first_capacity(plan_)),
      keypoints_capacity_(first_capacity(plan_)) {
  extrema_found_ = queue_.buffer(sizeof(Spot) * static_cast<std::uint64_t>(extrema_capacity_));
  keypoints_found_ = queue_.buffer(sizeof(Spot) * static_cast<std::uint64_t>(keypoints_capacity_));
  queue_.write(taps_, sizeof(float) * plan_.taps.size(), plan_.taps.data());
  queue_.write(octaves_, sizeof(Octave) * plan_.octaves.size(), plan_.octaves.data());
}

bool Session::fits(const Device& device, int width, int height, int channels) const {
  return device_.get() == &device && plan_.image_width == width && plan_.image_height == height &&
         channels_ == channels;
}

void Session::upload(const Array<std::uint8_t>& pixels) {
  const auto row_bytes = to_index(plan_.image_width * channels_);
  queue_.write(image_, to_index(plan_.image_height) * row_bytes, [&](std::byte* to) {
    for (std::int64_t y = 0; y < pixels.rows(); ++y, to += row_bytes) {
      std::memcpy(to, pixels.row(y), row_bytes);
    }
  });
}

void Session::blur(std::uint64_t from_offset, const Octave& octave, const Blur& gaussian,
                   std::uint64_t to_offset) {
  const cl::NDRange pixels = pixels_of(octave.width, octave.height);
  queue_.launch(blur_rows_, pixels, kTile, pyramid_, static_cast<cl_ulong>(from_offset),
                octave.width, octave.height, taps_, gaussian.offset, gaussian.radius, scratch_);
  queue_.launch(blur_columns_, pixels, kTile, scratch_, octave.width, octave.height, taps_,
                gaussian.offset, gaussian.radius, pyramid_, static_cast<cl_ulong>(to_offset));
}

void Session::build_pyramid() {
  const Octave* before = nullptr;
  for (const Octave& octave : plan_.octaves) {
    const std::uint64_t size = layer_size(octave);
    if (before == nullptr) {
      // The second layer's place is free until it is made.
      const std::uint64_t place = octave.offset + size;
      queue_.launch(grey_levels_, pixels_of(plan_.width, plan_.height), kTile, image_,
                    plan_.image_width, plan_.image_height, channels_, settings_.upsample ? 1 : 0,
                    pyramid_, static_cast<cl_ulong>(place));
      blur(place, octave, plan_.blurs.front(), octave.offset);
    } else {
      const std::uint64_t from =
          before->offset +
          static_cast<std::uint64_t>(settings_.octave_layers) * layer_size(*before);
      queue_.launch(halve_, pixels_of(octave.width, octave.height), kTile, pyramid_,
                    static_cast<cl_ulong>(from), before->width,
                    static_cast<cl_ulong>(octave.offset), octave.width, octave.height);
    }
    for (int layer = 1; layer < plan_.layers(); ++layer) {
      const std::uint64_t to = octave.offset + static_cast<std::uint64_t>(layer) * size;
      blur(to - size, octave, plan_.blurs[to_index(layer)], to);
    }
    before = &octave;
  }
}

void Session::launch_extrema() {
  queue_.fill(count_, 0);
  for (std::size_t i = 0; i < plan_.octaves.size(); ++i) {
    const Octave& octave = plan_.octaves[i];
    queue_.launch(
        extrema_, pixels_of(octave.width, octave.height), kTile, pyramid_,
        static_cast<cl_ulong>(octave.offset), octave.width, octave.height, static_cast<cl_int>(i),
        settings_.octave_layers, static_cast<float>(settings_.sigma_px),
        static_cast<float>(settings_.contrast_threshold),
        static_cast<float>(settings_.edge_threshold), extrema_found_, count_, extrema_capacity_);
  }
}

void Session::launch_orientations(int extrema) {
  queue_.fill(count_, 0);
  queue_.launch(orientations_, groups_for(extrema), one_group(), pyramid_, octaves_, extrema_found_,
                keypoints_found_, count_, keypoints_capacity_);
}

int Session::read_count(const CancelledCheck& cancelled) {
  cl_int count = 0;
  queue_.read(count_, sizeof(count), &count, cancelled);
  return count;
}

std::vector<Spot> Session::find(const Array<std::uint8_t>& pixels,
                                const CancelledCheck& cancelled) {
  if (plan_.octaves.empty()) return {};
  upload(pixels);
  build_pyramid();
  launch_extrema();
  int extrema = read_count(cancelled);
  if (extrema > extrema_capacity_) {
    extrema_capacity_ = extrema + extrema / 4;
    extrema_found_ = queue_.buffer(sizeof(Spot) * static_cast<std::uint64_t>(extrema_capacity_));
    launch_extrema();
    extrema = read_count(cancelled);
  }
  if (extrema == 0) return {};

  launch_orientations(extrema);
  int count = read_count(cancelled);
  if (count > keypoints_capacity_) {
    keypoints_capacity_ = count + count / 4;
    keypoints_found_ =
        queue_.buffer(sizeof(Spot) * static_cast<std::uint64_t>(keypoints_capacity_));
    launch_orientations(extrema);
    count = read_count(cancelled);
  }
  std::vector<Spot> spots(to_index(count));
  if (count > 0)
    queue_.read(keypoints_found_, sizeof(Spot) * spots.size(), spots.data(), cancelled);
  // Neighbours can be refined to the same extremum.
  const auto key = [](const Spot& s) {
    return std::tuple(s.octave, s.layer, s.y, s.x, s.scale, s.angle);
  };
  std::sort(spots.begin(), spots.end(),
            [&](const Spot& a, const Spot& b) { return key(a) < key(b); });
  spots.erase(std::unique(spots.begin(), spots.end()), spots.end());
  return spots;
}

/// A buffer for descriptors without any reader left.
const std::shared_ptr<const cl::Buffer>& Session::free_rows(std::size_t bytes) {
  const auto is_free = [](const auto& buffer) { return buffer.use_count() == 1; };
  const auto found = std::find_if(rows_.begin(), rows_.end(), is_free);
  std::shared_ptr<const cl::Buffer>& rows = found != rows_.end() ? *found : rows_.emplace_back();
  if (rows == nullptr || rows->getInfo<CL_MEM_SIZE>() < bytes) {
    rows = std::make_shared<const cl::Buffer>(queue_.buffer(bytes + bytes / 4));
  }
  return rows;
}

std::shared_ptr<const KeptDescriptors> Session::describe(const std::vector<Spot>& keypoints) {
  const auto count = static_cast<int>(keypoints.size());
  if (count > selected_capacity_) {
    selected_capacity_ = count + count / 4;
    selected_ = queue_.buffer(sizeof(Spot) * static_cast<std::uint64_t>(selected_capacity_));
  }
  queue_.write(selected_, sizeof(Spot) * keypoints.size(), keypoints.data());
  const auto& rows = free_rows(keypoints.size() * kDescriptorLength);
  queue_.launch(descriptions_, groups_for(count), one_group(), pyramid_, octaves_, selected_,
                *rows);
  queue_.flush();
  return std::make_shared<const KeptDescriptors>(device_, rows, queue_.last_kernel(), count);
}

std::vector<float> Session::octave(std::size_t index) {
  const Octave& octave = plan_.octaves.at(index);
  std::vector<float> values(to_index(plan_.layers()) * layer_size(octave));
  queue_.read(
      pyramid_, sizeof(float) * values.size(), values.data(), [] { return false; },
      sizeof(float) * octave.offset);
  return values;
}

}  // namespace weft::sift_gpu
