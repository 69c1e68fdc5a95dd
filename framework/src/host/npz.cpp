// SPDX-License-Identifier: Apache-2.0
#include <zip.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <sstream>
#include <weft/host/npz.hpp>

namespace weft::host {
namespace {

constexpr const char* kTypeMember = "record_type";
constexpr std::array<const char*, 9> kDescriptors{"",    "|u1", "|i1", "<u2", "<i2",
                                                  "<i4", "<i8", "<f4", "<f8"};

std::string npy_header(const weft_array& array) {
  std::string shape = "(";
  for (int axis = 0; axis < array.ndim; ++axis) {
    shape += std::to_string(array.shape[axis]) + (axis + 1 < array.ndim ? ", " : "");
  }
  shape += array.ndim == 1 ? ",)" : ")";
  std::string header = std::string("{'descr': '") +
                       kDescriptors[static_cast<std::size_t>(array.dtype)] +
                       "', 'fortran_order': False, 'shape': " + shape + ", }";
  constexpr std::size_t kPreamble = 10;
  while ((kPreamble + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::string result("\x93NUMPY\x01\x00", 8);
  result += static_cast<char>(header.size() & 0xFFU);
  result += static_cast<char>(header.size() >> 8U);
  return result + header;
}

/// The array in NumPy's format; rows may be padded in memory, never in the file.
std::string to_npy(const weft_array& array) {
  std::string bytes = npy_header(array);
  std::int64_t row_bytes = dtype_size(array.dtype);
  for (int axis = 1; axis < array.ndim; ++axis) row_bytes *= array.shape[axis];
  const std::int64_t rows = array.ndim > 0 ? array.shape[0] : 1;
  for (std::int64_t i = 0; i < rows; ++i) {
    const std::int64_t offset = array.ndim > 0 ? i * array.stride[0] : 0;
    bytes.append(static_cast<const char*>(array.data) + offset,
                 static_cast<std::size_t>(row_bytes));
  }
  return bytes;
}

struct NpyHeader {
  std::int32_t dtype = 0;
  std::vector<std::int64_t> shape;
  std::size_t data_offset = 0;
};

Result<NpyHeader> parse_npy(const std::string& bytes) {
  const Error damaged{Errc::invalid_data, "is no array in NumPy's format 1.0", {}};
  if (bytes.size() < 10 || bytes.compare(0, 7, "\x93NUMPY\x01", 7) != 0) return damaged;
  const auto byte = [&](std::size_t i) {
    return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i]));
  };
  NpyHeader header;
  header.data_offset = 10 + byte(8) + 256 * byte(9);
  if (header.data_offset > bytes.size()) return damaged;
  const std::string text = bytes.substr(10, header.data_offset - 10);
  if (text.find("'fortran_order': False") == std::string::npos) return damaged;
  for (std::size_t i = 1; i < kDescriptors.size(); ++i) {
    if (text.find("'" + std::string(kDescriptors[i]) + "'") != std::string::npos) {
      header.dtype = static_cast<std::int32_t>(i);
    }
  }
  const std::size_t open = text.find('('), close = text.find(')');
  if (header.dtype == 0 || open == std::string::npos || close == std::string::npos) return damaged;
  std::istringstream list(text.substr(open + 1, close - open - 1));
  std::uint64_t expected = static_cast<std::uint64_t>(dtype_size(header.dtype));
  for (std::string word; std::getline(list, word, ',');) {
    if (word.find_first_of("0123456789") == std::string::npos) continue;
    std::int64_t length = 0;
    if (!(std::istringstream(word) >> length) || length < 0) return damaged;
    header.shape.push_back(length);
    if (length > 0 && expected > bytes.size() / static_cast<std::uint64_t>(length)) return damaged;
    expected *= static_cast<std::uint64_t>(length);
  }
  if (header.shape.size() > WEFT_MAX_DIMENSIONS) return damaged;
  if (expected != bytes.size() - header.data_offset) return damaged;
  return header;
}

struct ZipCloser {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
using Archive = std::unique_ptr<zip_t, ZipCloser>;

Error zip_failure(const std::string& file, const std::string& what) {
  return {Errc::io, what, file};
}

struct Member {
  std::string slot, array, bytes;
};

/// The whole member at `index`. It is read to its end, where its checksum is compared, and in
/// pieces, because the size that a damaged file states may be anything.
Result<Member> read_member(zip_t* archive, zip_uint64_t index, const std::string& file) {
  const char* name = zip_get_name(archive, index, 0);
  const std::string path = name != nullptr ? name : "";
  const std::size_t slash = path.rfind('/');
  const Error damaged = zip_failure(file, "is damaged at the member '" + path + "'");
  if (slash == std::string::npos || !path.ends_with(".npy")) return damaged;
  const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> stream(zip_fopen_index(archive, index, 0),
                                                                 &zip_fclose);
  if (!stream) return damaged;
  Member member{path.substr(0, slash), path.substr(slash + 1, path.size() - slash - 5), {}};
  std::array<char, 1U << 16U> piece;
  zip_int64_t got = 0;
  while ((got = zip_fread(stream.get(), piece.data(), piece.size())) > 0) {
    member.bytes.append(piece.data(), static_cast<std::size_t>(got));
  }
  if (got < 0) return damaged;
  return member;
}

/// The records of a file while its members are read.
struct Assembly {
  std::vector<std::pair<std::string, std::shared_ptr<Record>>> records{};
  std::map<std::string, std::shared_ptr<Record>> by_slot{};

  Result<void> add(const Member& member, const std::string& file) {
    const std::string name = member.slot + "/" + member.array;
    const auto header = parse_npy(member.bytes);
    if (!header) return Error{Errc::invalid_data, name + " " + header.error().message, file};
    const char* data = member.bytes.data() + header->data_offset;
    const std::size_t size = member.bytes.size() - header->data_offset;
    if (member.array == kTypeMember) {
      const auto record = std::make_shared<Record>(std::string(data, size));
      if (!by_slot.emplace(member.slot, record).second) {
        return zip_failure(file, "has the slot '" + member.slot + "' twice");
      }
      records.emplace_back(member.slot, record);
      return {};
    }
    const auto found = by_slot.find(member.slot);
    if (found == by_slot.end()) {
      return zip_failure(file, "lacks the type of '" + member.slot + "'; was it written by Weft?");
    }
    const auto axes = static_cast<std::int32_t>(header->shape.size());
    void* target = found->second->allocate(member.array, header->dtype, axes, header->shape.data());
    if (target == nullptr) return zip_failure(file, name + " has an illegal name or size");
    std::memcpy(target, data, size);
    return {};
  }
};

}  // namespace

Result<void> write_npz(const std::string& file, const NamedRecords& records) {
  if (records.empty()) return Error{Errc::invalid_value, "there are no records to write", file};
  std::vector<std::pair<std::string, std::string>> members;
  for (const auto& [slot, record] : records) {
    weft_array type{};
    type.dtype = WEFT_U8;
    type.ndim = 1;
    type.shape[0] = static_cast<std::int64_t>(record->type().size());
    type.stride[0] = 1;
    type.data = const_cast<char*>(record->type().data());
    members.emplace_back(slot + "/" + kTypeMember + ".npy", to_npy(type));
    const weft_record view = record->view(slot.c_str());
    for (std::uint64_t i = 0; i < view.count; ++i) {
      members.emplace_back(slot + "/" + view.arrays[i].name + ".npy", to_npy(view.arrays[i]));
    }
  }
  const std::string temporary = file + ".part";
  int code = 0;
  Archive archive(zip_open(temporary.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code));
  if (!archive) return zip_failure(temporary, "cannot be created; is the folder writable?");
  for (const auto& [name, bytes] : members) {
    zip_source_t* source = zip_source_buffer(archive.get(), bytes.data(), bytes.size(), 0);
    const zip_int64_t index = zip_file_add(archive.get(), name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      zip_source_free(source);
      return zip_failure(file, "cannot hold the member " + name);
    }
    const auto entry = static_cast<zip_uint64_t>(index);
    zip_set_file_compression(archive.get(), entry, ZIP_CM_STORE, 0);
    zip_file_set_dostime(archive.get(), entry, 0, 33, 0);  // 1980-01-01: no hidden time
  }
  if (zip_close(archive.get()) != 0) {
    return zip_failure(file, std::string("cannot be written: ") + zip_strerror(archive.get()));
  }
  static_cast<void>(archive.release());
  std::error_code failure;
  std::filesystem::rename(temporary, file, failure);
  if (failure) return zip_failure(file, "cannot be renamed into place: " + failure.message());
  return {};
}

Result<NamedRecords> read_npz(const std::string& file, NpzCheck check) {
  int code = 0;
  const Archive archive(zip_open(file.c_str(), ZIP_RDONLY, &code));
  if (!archive) return zip_failure(file, "cannot be read as an npz file");
  Assembly assembly;
  const zip_int64_t count = zip_get_num_entries(archive.get(), 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const auto member = read_member(archive.get(), static_cast<zip_uint64_t>(i), file);
    if (!member) return member.error();
    if (auto added = assembly.add(*member, file); !added) return added.error();
  }
  NamedRecords result;
  for (auto& [slot, record] : assembly.records) {
    if (check == NpzCheck::catalogue) {
      if (auto valid = validate(record->view(slot.c_str())); !valid) {
        return Error{valid.error().code, "slot '" + slot + "': " + valid.error().message, file};
      }
    }
    result.emplace_back(slot, std::move(record));
  }
  return result;
}

}  // namespace weft::host
