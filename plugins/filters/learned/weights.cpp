// SPDX-License-Identifier: Apache-2.0
#include <zip.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/npy.hpp>

#include "network.hpp"

// The assembler reads the file WEFT_LEARNED_WEIGHTS as it is.
__asm__(
    ".pushsection .rodata\n"
    ".globl weft_learned_weights\n"
    ".hidden weft_learned_weights\n"
    "weft_learned_weights:\n"
    ".incbin \"" WEFT_LEARNED_WEIGHTS
    "\"\n"
    ".globl weft_learned_weights_end\n"
    ".hidden weft_learned_weights_end\n"
    "weft_learned_weights_end:\n"
    ".byte 0\n"
    ".popsection\n");

#define WEFT_HIDDEN __attribute__((visibility("hidden")))
extern "C" {
extern const char weft_learned_weights[] WEFT_HIDDEN, weft_learned_weights_end[] WEFT_HIDDEN;
}

namespace weft::learned {
namespace {

constexpr int kFormat = 1;
constexpr std::size_t kMostBytes = 4U << 20U;  // limit for the file and for each array
constexpr zip_int64_t kMostMembers = 1000;
constexpr const char* kFix = ": write the file again with learning/filter/train.py";

struct Discard {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
struct Close {
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};

using Members = std::map<std::string, std::string>;  // bytes by name

/// The bytes of a member; false where its checksum or size is wrong.
bool read_member(zip_t* archive, zip_uint64_t index, std::string& bytes) {
  const std::unique_ptr<zip_file_t, Close> stream(zip_fopen_index(archive, index, 0));
  if (!stream) return false;
  std::array<char, 1U << 14U> piece;
  zip_int64_t got = 0;
  while ((got = zip_fread(stream.get(), piece.data(), piece.size())) > 0) {
    if (bytes.size() > kMostBytes) return false;
    bytes.append(piece.data(), to_index(got));
  }
  return got == 0;
}

Result<Members> members_of(std::string_view bytes, const std::string& name) {
  const auto fail = [&](const std::string& what) {
    return Error{Errc::invalid_data, name + ": " + what + kFix};
  };
  zip_error_t failure;
  zip_error_init(&failure);
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &failure);
  if (source == nullptr) return fail("cannot be read");
  const std::unique_ptr<zip_t, Discard> archive(zip_open_from_source(source, ZIP_RDONLY, &failure));
  if (!archive) {
    zip_source_free(source);
    return fail("is no complete npz file");
  }
  const zip_int64_t count = zip_get_num_entries(archive.get(), 0);
  if (count > kMostMembers) return fail("has too many members");
  Members members;
  for (zip_int64_t i = 0; i < count; ++i) {
    const auto index = static_cast<zip_uint64_t>(i);
    const char* member = zip_get_name(archive.get(), index, 0);
    if (member == nullptr) return fail("is damaged");
    if (!read_member(archive.get(), index, members[member])) {
      return fail("is damaged at " + std::string(member));
    }
  }
  return members;
}

std::string text_of(const std::vector<std::int64_t>& shape) {
  std::string text = "[";
  for (const std::int64_t length : shape) {
    text += (text.size() > 1 ? "," : "") + std::to_string(length);
  }
  return text + "]";
}

/// Reads arrays of given shapes; the first problem stays.
class Reader {
 public:
  Reader(const Members& members, const std::string& name) : members_(members), name_(name) {}

  template <class Matrix>
  void read(const std::string& array, Matrix& matrix, std::vector<std::int64_t> shape) {
    const char* data = find(array, WEFT_F32, shape);
    if (data == nullptr) return;
    using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    RowMajor values(matrix.rows(), matrix.cols());
    std::memcpy(values.data(), data, to_index(values.size()) * sizeof(float));
    if (!values.allFinite()) {
      refuse(array, "has a value that is not finite");
    } else {
      matrix = values;
    }
  }

  void read(const std::string& array, float& value) {
    Eigen::Matrix<float, 1, 1> one = Eigen::Matrix<float, 1, 1>::Zero();
    read(array, one, {1});
    value = one(0);
  }

  void expect_format() {
    const char* data = find("format", WEFT_I32, {1});
    std::int32_t format = 0;
    if (data == nullptr) return;
    std::memcpy(&format, data, sizeof(format));
    if (format != kFormat) {
      refuse("format", "is " + std::to_string(format) + ", not " + std::to_string(kFormat));
    }
  }

  void expect_count(std::size_t count) {
    if (members_.size() != count) {
      refuse("the archive", "has " + std::to_string(members_.size()) + " arrays, not " +
                                std::to_string(count) + ": it belongs to another network");
    }
  }

  const Result<void>& status() const { return status_; }

 private:
  const char* find(const std::string& array, std::int32_t dtype,
                   const std::vector<std::int64_t>& shape) {
    if (!status_) return nullptr;
    const auto member = members_.find(array + ".npy");
    if (member == members_.end()) return refuse(array, "is missing");
    const auto header = parse_npy(member->second);
    if (!header) return refuse(array, header.error().message);
    if (header->dtype != dtype || header->shape != shape) {
      return refuse(array, std::string("is ") + dtype_name(header->dtype) + " " +
                               text_of(header->shape) + ", not " + dtype_name(dtype) + " " +
                               text_of(shape));
    }
    return member->second.data() + header->data_offset;
  }

  const char* refuse(const std::string& array, const std::string& what) {
    if (status_) {
      status_ = Error{Errc::invalid_data, name_ + ": " + array + " " + what + kFix};
    }
    return nullptr;
  }

  const Members& members_;
  const std::string& name_;
  Result<void> status_;
};

void read_block(Reader& reader, const std::string& at, Block& block) {
  reader.read(at + "linear.weight", block.weight, {kChannels, kChannels});
  Eigen::Matrix<float, 1, kChannels> attention = Eigen::Matrix<float, 1, kChannels>::Zero();
  reader.read(at + "attention.weight", attention, {1, kChannels});
  block.attention = attention.transpose();
  reader.read(at + "attention.bias", block.attention_bias);
  reader.read(at + "gain", block.gain, {kChannels});
  reader.read(at + "shift", block.shift, {kChannels});
}

}  // namespace

Result<Weights> parse_weights(std::string_view archive, const std::string& name) {
  const auto members = members_of(archive, name);
  if (!members) return members.error();
  Weights weights;
  Reader reader(*members, name);
  reader.expect_format();
  reader.read("input.weight", weights.input, {kChannels, kInputs});
  reader.read("input.bias", weights.input_bias, {kChannels});
  for (std::size_t k = 0; k < kBlocks; ++k) {
    read_block(reader, "blocks." + std::to_string(k) + ".", weights.blocks[k]);
  }
  for (std::size_t k = 0; k < kStages; ++k) {
    const std::string at = "heads." + std::to_string(k);
    reader.read(at + ".weight", weights.heads[k], {2, kChannels});
    reader.read(at + ".bias", weights.head_biases[k], {2});
  }
  for (std::size_t k = 0; k + 1 < kStages; ++k) {
    const std::string at = "fits." + std::to_string(k);
    reader.read(at + ".weight", weights.fits[k], {kChannels, kFitInputs});
    reader.read(at + ".bias", weights.fit_biases[k], {kChannels});
  }
  reader.expect_count(3 + 5 * kBlocks + 2 * kStages + 2 * (kStages - 1));
  if (!reader.status()) return reader.status().error();
  return weights;
}

Result<Weights> read_weights(const std::string& path) {
  std::error_code code;
  const auto size = std::filesystem::file_size(path, code);
  if (code) return Error{Errc::io, path + ": cannot be read (" + code.message() + ")"};
  if (size > kMostBytes) return Error{Errc::invalid_data, path + ": is too large" + kFix};
  std::ifstream stream(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) return Error{Errc::io, path + ": cannot be read"};
  return parse_weights(bytes, path);
}

Result<Weights> built_in_weights() {
  return parse_weights({weft_learned_weights,
                        static_cast<std::size_t>(weft_learned_weights_end - weft_learned_weights)},
                       "the built-in weights");
}

}  // namespace weft::learned
