// SPDX-License-Identifier: Apache-2.0
#include "shard.hpp"

#include <initializer_list>
#include <string>
#include <system_error>
#include <weft/core/index.hpp>
#include <weft/core/whole_file.hpp>
#include <weft/data/npy.hpp>

namespace weft::shards {
namespace {

namespace fs = std::filesystem;

/// Writes values row by row as an array of this shape.
template <class Value>
Result<void> write_array(const fs::path& path, const std::vector<Value>& values,
                         std::initializer_list<std::int64_t> shape) {
  weft_array array{};
  array.dtype = dtype_of<Value>();
  array.ndim = static_cast<std::int32_t>(shape.size());
  array.data = const_cast<Value*>(values.data());
  std::int64_t bytes = static_cast<std::int64_t>(sizeof(Value));
  std::size_t axis = shape.size();
  for (auto length = std::rbegin(shape); length != std::rend(shape); ++length) {
    --axis;
    array.shape[axis] = *length;
    array.stride[axis] = bytes;
    bytes *= *length;
  }
  return write_whole(to_npy(array), path, Durability::unsynced);
}

}  // namespace

void Shard::add(const std::vector<std::uint8_t>& image, const CellLabels& labels,
                const GridNodes::Places& places) {
  const auto append = [](auto& all, const auto& one) {
    all.insert(all.end(), one.begin(), one.end());
  };
  append(image_, image);
  append(uv_, labels.uv);
  append(depth_, labels.depth);
  append(mask_, labels.mask);
  append(vertices_m_, places.points_m);
  append(visible_, places.visible);
  ++count_;
}

Result<void> Shard::write(const fs::path& folder) const {
  const fs::path unfinished = folder.parent_path() / ("." + folder.filename().string() + ".part");
  const auto failure = [&](const std::error_code& code) {
    return Error{Errc::io,
                 folder.string() + " cannot be written (" + why_not_written(code) +
                     "): free space, or choose another 'path'",
                 {}};
  };
  std::error_code code;
  fs::create_directories(unfinished, code);
  if (code) return failure(code);
  const std::int64_t rows = format_.rows(), columns = format_.columns();
  Result<void> done = write_array(unfinished / "image.npy", image_,
                                  {count_, format_.height_px, format_.width_px, 3});
  if (done) done = write_array(unfinished / "uv.npy", uv_, {count_, rows, columns, 2});
  if (done) done = write_array(unfinished / "depth.npy", depth_, {count_, rows, columns});
  if (done) done = write_array(unfinished / "mask.npy", mask_, {count_, rows, columns});
  if (done) done = write_array(unfinished / "vertices_m.npy", vertices_m_, {count_, nodes_, 3});
  if (done) done = write_array(unfinished / "visible.npy", visible_, {count_, nodes_});
  if (!done) return done;
  fs::rename(unfinished, folder, code);
  if (code) return failure(code);
  return {};
}

void Shard::clear() { *this = Shard(format_, nodes_); }

}  // namespace weft::shards
