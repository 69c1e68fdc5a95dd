// SPDX-License-Identifier: Apache-2.0
#include "output_file.hpp"

#include <zip.h>

#include <cstdio>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <weft/core/index.hpp>
#include <weft/core/whole_file.hpp>

namespace weft::dataset {
namespace {

namespace fs = std::filesystem;

Error cannot_write(const fs::path& path, const std::string& reason) {
  return {Errc::io,
          path.string() + " cannot be written (" + reason +
              "): choose another 'path', or make it writable and free space",
          {}};
}

struct Discard {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};

Result<void> add(zip_t* archive, const NpzMember& member) {
  zip_source_t* source = zip_source_buffer(archive, member.bytes.data(), member.bytes.size(), 0);
  const zip_int64_t index = zip_file_add(archive, member.path().c_str(), source, ZIP_FL_ENC_UTF_8);
  if (index < 0) {
    zip_source_free(source);
    return Error{Errc::io, zip_strerror(archive)};
  }
  const auto entry = static_cast<zip_uint64_t>(index);
  zip_set_file_compression(archive, entry, ZIP_CM_STORE, 0);
  constexpr zip_uint16_t kFirstDay = 33;  // 1980-01-01: no hidden time
  zip_file_set_dostime(archive, entry, 0, kFirstDay, 0);
  return {};
}

}  // namespace

Result<void> write_png(const fs::path& path, const Array<std::uint8_t>& pixels) {
  const cv::Mat image(static_cast<int>(pixels.dim(0)), static_cast<int>(pixels.dim(1)),
                      pixels.ndim() == 2 ? CV_8UC1 : CV_8UC3,
                      const_cast<std::uint8_t*>(pixels.data()), to_index(pixels.row_stride()));
  std::vector<std::uint8_t> png;
  if (!cv::imencode(".png", image, png)) return cannot_write(path, "the image is no PNG");
  return write_whole({reinterpret_cast<const char*>(png.data()), png.size()}, path,
                     Durability::unsynced);
}

Result<void> write_npz(const fs::path& path, const std::vector<NpzMember>& members) {
  UnfinishedFile unfinished(path);
  if (const auto reason = unfinished.status()) return cannot_write(path, why_not_written(reason));
  int code = 0;
  std::unique_ptr<zip_t, Discard> archive(
      zip_open(unfinished.path().c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code));
  if (!archive) return cannot_write(path, "zip error " + std::to_string(code));
  for (const NpzMember& member : members) {
    if (auto added = add(archive.get(), member); !added) {
      return cannot_write(path, added.error().message);
    }
  }
  if (zip_close(archive.get()) != 0) {
    const std::error_code reason(zip_error_code_system(zip_get_error(archive.get())),
                                 std::generic_category());
    return cannot_write(path, reason ? why_not_written(reason) : zip_strerror(archive.get()));
  }
  static_cast<void>(archive.release());
  const std::error_code reason = unfinished.finish(Durability::unsynced);
  if (reason) return cannot_write(path, why_not_written(reason));
  return {};
}

}  // namespace weft::dataset
