// SPDX-License-Identifier: Apache-2.0
#include "common/truth_archive.hpp"

#include <utility>
#include <vector>
#include <weft/data/codec.hpp>

#include "common/npz_file.hpp"

namespace weft::sources {
namespace {

constexpr const char* kSlot = "ground_truth";

bool is_truth(std::string_view name) { return name.starts_with("ground_truth/"); }

}  // namespace

TruthArchive::TruthArchive(std::string path, NpzRecord record)
    : path_(std::move(path)), record_(std::move(record)) {}

Result<TruthArchive> TruthArchive::read(const std::string& path) {
  auto files = read_npz_file(path, &is_truth);
  if (!files) return files.error();
  std::vector<NpzMember> members;
  for (ArchiveMember& file : *files) {
    auto member = NpzMember::of_path(file.name);
    if (!member || member->slot != kSlot) continue;
    member->bytes = std::move(file.bytes);
    members.push_back(*std::move(member));
  }
  if (members.empty()) {
    return Error{Errc::invalid_data,
                 path +
                     ": there is no record 'ground_truth', and no array 'points' of a cloud: "
                     "save one of the two"};
  }
  auto record = NpzRecord::create(std::move(members), kSlot);
  if (!record) return Error{record.error().code, path + ": " + record.error().message};
  return TruthArchive(path, *std::move(record));
}

Result<GroundTruth> TruthArchive::truth() const {
  auto truth = record_.with_view([](const auto& view) { return read_record<GroundTruth>(view); });
  if (!truth) return Error{truth.error().code, path_ + ": " + truth.error().message};
  return truth;
}

}  // namespace weft::sources
