// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/runs/run_registrations.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <weft/data/visibility.hpp>

namespace weft::lab {
namespace {

constexpr std::string_view kSlotEnd = ".registration";

std::string registration_file(const std::string& folder) { return folder + "/registration.npz"; }

/// The frame of a slot, "12.registration".
std::optional<std::uint64_t> frame_of_slot(const std::string& slot) {
  std::uint64_t frame = 0;
  const char* end = slot.data() + slot.size() - std::min(slot.size(), kSlotEnd.size());
  const auto read = std::from_chars(slot.data(), end, frame);
  const bool is_frame = slot.ends_with(kSlotEnd) && read.ec == std::errc() && read.ptr == end;
  return is_frame ? std::optional(frame) : std::nullopt;
}

}  // namespace

Result<void> write_registrations(const std::string& folder, const MeasuredFrames& frames) {
  host::NamedRecords records;
  for (const auto& [frame, record] : frames) {
    if (record != nullptr)
      records.emplace_back(std::to_string(frame) + std::string(kSlotEnd), record);
  }
  if (!records.empty()) return host::write_npz(registration_file(folder), records);
  std::error_code code;
  std::filesystem::remove(registration_file(folder), code);
  if (!code) return {};
  return Error{Errc::io, "cannot be removed: " + code.message(), registration_file(folder)};
}

Result<std::optional<MeasuredFrames>> read_registrations(const std::string& folder) {
  const std::string file = registration_file(folder);
  std::error_code code;
  if (!std::filesystem::exists(file, code)) return std::optional<MeasuredFrames>();
  const auto records = host::read_npz(file);
  if (!records) return records.error();
  MeasuredFrames frames;
  for (const auto& [slot, record] : *records) {
    const auto frame = frame_of_slot(slot);
    if (!frame || record->type() != Registration::kType) {
      return Error{Errc::invalid_data,
                   "is damaged: remove it, and measure again with `weft eval --flat-reference`",
                   file};
    }
    frames[*frame] = record;
  }
  return std::optional(std::move(frames));
}

}  // namespace weft::lab
