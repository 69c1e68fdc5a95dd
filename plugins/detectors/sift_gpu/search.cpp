// SPDX-License-Identifier: Apache-2.0
#include "search.hpp"

#include <algorithm>
#include <cstring>
#include <weft/core/index.hpp>

namespace weft::sift_gpu {
namespace {

constexpr int kTileItems = (kTileSide / kTileBlock) * (kTileSide / kTileBlock);
constexpr std::uint64_t kBlockBytes = 64U
                                      << 20U;  // distances that are held at a time, if it can be

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

const cl::Buffer& Search::reserve(GrowingBuffer& place, std::uint64_t bytes) {
  if (place.bytes < bytes) {
    place.buffer = queue_.buffer(bytes + bytes / 4);
    place.bytes = bytes + bytes / 4;
  }
  return place.buffer;
}

void Search::send(const Array<float>& descriptors, const cl::Buffer& to) {
  const std::size_t row_bytes = sizeof(float) * to_index(descriptors.dim(1));
  queue_.write(to, to_index(descriptors.rows()) * row_bytes, [&](std::byte* at) {
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
    const std::span<float> numbers(here.data(), to_index(here.size()));
    const auto fetched = kept->download(std::as_writable_bytes(numbers), cancelled);
    if (!fetched) throw OutOfReach{fetched.error()};
    send(here, rows);
  }
  queue_.launch(load_, one_item_each(side.count), one_group(), rows, side.count, side.length,
                root ? 1 : 0, norms);
  side.source = std::move(kept);
}

void Search::launch_block(int first, int rows, const Options& options) {
  const Loaded &queries = queries_, &trains = trains_;
  queue_.launch(distances_,
                cl::NDRange(static_cast<cl::size_type>(tiles(rows)) *
                            static_cast<cl::size_type>(tiles(trains.count)) * kTileItems),
                cl::NDRange(kTileItems), queries.rows.buffer, queries.norms.buffer, first, rows,
                trains.rows.buffer, trains.norms.buffer, trains.count, trains.length,
                squares_.buffer);
  queue_.launch(nearest_, groups_for(rows), one_group(), squares_.buffer, trains.count,
                places_.buffer, options.elsewhere_px, queries.rows.buffer, trains.rows.buffer,
                first, trains.length, pairs_.buffer);
  if (options.mutual) {
    queue_.launch(nearest_queries_, one_item_each(trains.count), one_group(), squares_.buffer,
                  first, rows, trains.count, least_.buffer, best_.buffer);
  }
}

Search::Found Search::run(std::span<const float> places, const Options& options,
                          const CancelledCheck& cancelled) {
  const int queries = queries_.count, trains = trains_.count;
  const std::uint64_t row_bytes = bytes_of(trains, 1);
  const auto rows_in_memory = static_cast<int>(std::clamp<std::uint64_t>(
      kBlockBytes / row_bytes / kTileSide * kTileSide, kTileSide, 1U << 20U));
  const int block = std::min(rows_in_memory, tiles(queries) * kTileSide);
  Found found;
  found.pairs.resize(to_index(queries));
  if (options.mutual) found.best_queries.resize(to_index(trains));
  reserve(squares_, static_cast<std::uint64_t>(block) * row_bytes);
  reserve(pairs_, sizeof(Pair) * found.pairs.size());
  reserve(least_, row_bytes);
  reserve(best_, row_bytes);
  queue_.write(reserve(places_, places.size_bytes()), places.size_bytes(), places.data());
  for (int first = 0; first < queries; first += block) {
    launch_block(first, std::min(block, queries - first), options);
  }
  queue_.flush();
  for (const Loaded* side : {&queries_, &trains_}) {
    if (side->source != nullptr) side->source->await(cancelled);
  }
  queue_.read(pairs_.buffer, sizeof(Pair) * found.pairs.size(), found.pairs.data(), cancelled);
  queue_.read(best_.buffer, sizeof(std::int32_t) * found.best_queries.size(),
              found.best_queries.data(), cancelled);
  return found;
}

}  // namespace weft::sift_gpu
