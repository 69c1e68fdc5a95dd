// SPDX-License-Identifier: Apache-2.0
// Archives of records: refused with their name, or written and read again as the same records. An
// input is an archive, or a list of members, so that no checksum hides the fuzzed bytes. A member
// is a byte with the length of its name, the name, two bytes with a length, and its bytes.
#include <zip.h>

#include <cstring>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "common/clouds/cloud_file.hpp"
#include "common/truth_archive.hpp"
#include "fuzzing.hpp"
#include "host/records/npz.hpp"

namespace {

using namespace weft;
using fuzzing::require;

using Members = std::vector<std::pair<std::string, std::string_view>>;

Members members_of(std::string_view list) {
  const auto take = [&](std::size_t count) {
    const std::string_view taken = list.substr(0, count);
    list.remove_prefix(taken.size());
    return taken;
  };
  const auto number = [&](std::size_t bytes) {
    std::size_t value = 0;
    for (const char byte : take(bytes)) value = 256 * value + static_cast<unsigned char>(byte);
    return value;
  };
  Members members;
  while (!list.empty() && members.size() < 64) {
    const std::string name(take(number(1)));
    members.emplace_back(name, take(number(2)));
  }
  return members;
}

/// The bytes of an archive with these members; it omits names that libzip refuses.
std::string packed(const Members& members) {
  zip_source_t* store = zip_source_buffer_create(nullptr, 0, 0, nullptr);
  zip_source_keep(store);
  zip_t* archive = zip_open_from_source(store, ZIP_TRUNCATE, nullptr);
  require(archive != nullptr, "an archive");
  for (const auto& [name, bytes] : members) {
    zip_source_t* source = zip_source_buffer(archive, bytes.data(), bytes.size(), 0);
    const zip_int64_t index = zip_file_add(archive, name.c_str(), source, 0);
    if (index < 0) {
      zip_source_free(source);
    } else {
      zip_set_file_compression(archive, static_cast<zip_uint64_t>(index), ZIP_CM_STORE, 0);
    }
  }
  require(zip_close(archive) == 0, "a closed archive");
  std::string bytes;
  if (zip_source_open(store) == 0) {
    char piece[4096];
    for (zip_int64_t got = 0; (got = zip_source_read(store, piece, sizeof piece)) > 0;) {
      bytes.append(piece, static_cast<std::size_t>(got));
    }
    zip_source_close(store);
  }
  zip_source_free(store);
  return bytes;
}

void require_same(const host::NamedRecords& a, const host::NamedRecords& b) {
  require(a.size() == b.size(), "as many records");
  for (std::size_t i = 0; i < a.size(); ++i) {
    require(a[i].first == b[i].first && a[i].second->type() == b[i].second->type(),
            "the same slots and types", a[i].first);
    const weft_record x = a[i].second->view("a"), y = b[i].second->view("b");
    require(x.count == y.count, "as many arrays", a[i].first);
    for (std::uint64_t k = 0; k < x.count; ++k) {
      const weft_array &p = x.arrays[k], &q = y.arrays[k];
      const std::int64_t bytes = host::array_bytes(p.dtype, p.ndim, p.shape);
      require(std::string_view(p.name) == q.name && p.dtype == q.dtype && p.ndim == q.ndim &&
                  bytes == host::array_bytes(q.dtype, q.ndim, q.shape),
              "the same arrays", p.name);
      require(std::memcmp(p.data, q.data, static_cast<std::size_t>(bytes)) == 0, "the same values",
              p.name);
    }
  }
}

void require_same_written(const host::NamedRecords& records) {
  namespace fs = std::filesystem;
  std::string folder = fs::temp_directory_path() / "weft-npz-XXXXXX";
  require(::mkdtemp(folder.data()) != nullptr, "a folder for what is written");
  const std::string file = folder + "/records.npz";
  const auto written = host::write_npz(file, records);
  require(static_cast<bool>(written), "what was read can be written");
  const auto again = host::read_npz(file);
  require(static_cast<bool>(again), "what is written can be read");
  require_same(records, *again);
  fs::remove_all(folder);
}

void require_reported(const Error& error, const std::string& path) {
  require(!error.message.empty(), "a message");
  require(error.where == path || error.message.starts_with(path + ": "), "the file",
          error.where + " " + error.message);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzzing::text_of(data, size);
  const fuzzing::InputFile input(text.starts_with("PK") ? std::string(text)
                                                        : packed(members_of(text)));
  const auto any = host::read_npz(input.path(), host::NpzCheck::none);
  const auto records = host::read_npz(input.path());
  require(any || !records, "what the catalogue allows can be read");
  if (!any) require_reported(any.error(), input.path());
  if (!records) require_reported(records.error(), input.path());
  if (records && !records->empty()) require_same_written(*records);
  const auto truth = sources::TruthArchive::read(input.path());
  if (!truth) {
    require_reported(truth.error(), input.path());
  } else if (const auto typed = truth->truth(); !typed) {
    require_reported(typed.error(), input.path());
  }
  const auto cloud = sources::read_npz_cloud(input.path(), 0.001);
  if (!cloud) {
    require_reported(cloud.error(), input.path());
  } else if (*cloud) {
    require(!(**cloud).points_m.empty(), "a point");
    for (const auto& point : (**cloud).points_m) {
      require(!sources::mistake_in_point(point), "points before the camera");
    }
  }
  return 0;
}
