// SPDX-License-Identifier: Apache-2.0
#include "search.hpp"

#include <algorithm>
#include <cstring>

namespace weft::sift_gpu {
namespace {

constexpr int kTileSide = 32;  // rows and columns of distances of one group, as in the kernels
constexpr int kTileItems = 64;
constexpr std::uint64_t kBlockBytes = 64U << 20U;  // distances that are held at a time

int tiles(int count) { return (count + kTileSide - 1) / kTileSide; }

cl::NDRange one_item_each(int count) {
  return cl::NDRange(static_cast<cl::size_type>((count + kGroup - 1) / kGroup * kGroup));
}

std::uint64_t bytes_of(int count, int length) {
  return sizeof(float) * static_cast<std::uint64_t>(count) * static_cast<std::uint64_t>(length);
}

}  // namespace

Search::Search(std::shared_ptr<Device> device)
    : device_(std::move(device)),
      queue_(device_),
      widen_(queue_.kernel("widen")),
      load_(queue_.kernel("load")),
      distances_(queue_.kernel("distances")),
      nearest_(queue_.kernel("nearest")),
      nearest_queries_(queue_.kernel("nearest_queries")) {}

const cl::Buffer& Search::reserve(Kept& kept, std::uint64_t bytes) {
  if (kept.bytes < bytes) {
    kept.buffer = queue_.buffer(bytes + bytes / 4);
    kept.bytes = bytes + bytes / 4;
  }
  return kept.buffer;
}

void Search::send(const Array<float>& descriptors, const cl::Buffer& to) {
  const std::size_t row_bytes = sizeof(float) * static_cast<std::size_t>(descriptors.dim(1));
  queue_.write(to, static_cast<std::size_t>(descriptors.rows()) * row_bytes, [&](std::byte* at) {
    for (std::int64_t i = 0; i < descriptors.rows(); ++i, at += row_bytes) {
      std::memcpy(at, descriptors.row(i), row_bytes);
    }
  });
}

void Search::load(Loaded& side, const Array<float>& descriptors, bool root,
                  const CancelledCheck& cancelled) {
  auto kept = device_contents<KeptDescriptors>(descriptors);
  if (kept != nullptr && kept == side.source && root == side.root) return;
  side.source = nullptr;
  side.root = root;
  side.count = static_cast<int>(descriptors.dim(0));
  side.length = static_cast<int>(descriptors.dim(1));
  const cl::Buffer& rows = reserve(side.rows, bytes_of(side.count, side.length));
  const cl::Buffer& norms = reserve(side.norms, bytes_of(side.count, 1));
  if (kept == nullptr) {
    send(descriptors, rows);
  } else if (is_on(kept->device())) {
    kept->check();
    queue_.after(kept->ready());
    queue_.launch(widen_, one_item_each(side.count * side.length), one_group(), kept->rows(),
                  side.count * side.length, rows);
  } else {
    Array<float> here({side.count, side.length});
    const std::span<float> numbers(here.data(), static_cast<std::size_t>(here.size()));
    const auto fetched = kept->download(std::as_writable_bytes(numbers), cancelled);
    if (!fetched) throw OutOfReach{fetched.error()};
    send(here, rows);
  }
  queue_.launch(load_, one_item_each(side.count), one_group(), rows, side.count, side.length,
                root ? 1 : 0, norms);
  side.source = std::move(kept);
}

std::vector<Pair> Search::run(std::span<const float> places, const Options& options,
                              const CancelledCheck& cancelled) {
  const Loaded &queries = queries_, &trains = trains_;
  const std::uint64_t row_bytes = bytes_of(trains.count, 1);
  const auto rows_held = static_cast<int>(std::clamp<std::uint64_t>(
      kBlockBytes / row_bytes / kTileSide * kTileSide, kTileSide, 1U << 20U));
  const int block = std::min(rows_held, tiles(queries.count) * kTileSide);
  const cl::Buffer& squares = reserve(squares_, static_cast<std::uint64_t>(block) * row_bytes);
  const cl::Buffer& train_places = reserve(places_, places.size_bytes());
  const cl::Buffer& found =
      reserve(pairs_, sizeof(Pair) * static_cast<std::uint64_t>(queries.count));
  const cl::Buffer& least = reserve(least_, row_bytes);
  const cl::Buffer& best = reserve(best_, row_bytes);
  queue_.write(train_places, places.size_bytes(), places.data());

  for (int first = 0; first < queries.count; first += block) {
    const int rows = std::min(block, queries.count - first);
    queue_.launch(distances_,
                  cl::NDRange(static_cast<cl::size_type>(tiles(rows)) *
                              static_cast<cl::size_type>(tiles(trains.count)) * kTileItems),
                  cl::NDRange(kTileItems), queries.rows.buffer, queries.norms.buffer, first, rows,
                  trains.rows.buffer, trains.norms.buffer, trains.count, trains.length, squares);
    queue_.launch(nearest_, groups_for(rows), one_group(), squares, trains.count, train_places,
                  options.elsewhere_px, queries.rows.buffer, trains.rows.buffer, first,
                  trains.length, found);
    if (options.mutual) {
      queue_.launch(nearest_queries_, one_item_each(trains.count), one_group(), squares, first,
                    rows, trains.count, least, best);
    }
  }
  for (const Loaded* side : {&queries_, &trains_}) {
    if (side->source != nullptr) side->source->await(cancelled);
  }
  std::vector<Pair> pairs(static_cast<std::size_t>(queries.count));
  queue_.read(found, sizeof(Pair) * pairs.size(), pairs.data(), cancelled);
  if (options.mutual) {
    best_queries_.resize(static_cast<std::size_t>(trains.count));
    queue_.read(best, row_bytes, best_queries_.data(), cancelled);
  }
  return pairs;
}

}  // namespace weft::sift_gpu
