// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/results/damage.hpp"

/// The texts of a results folder; docs/results.md describes them.
namespace weft::lab {

inline constexpr const char* kFolderSchema = "weft.results/1";
inline constexpr const char* kLineSchema = "weft.cell/2";
inline constexpr const char* kUncheckedLineSchema = "weft.cell/1";
inline constexpr const char* kWithdrawalSchema = "weft.withdrawn/1";
inline constexpr std::size_t kKeyDigits = 32;

/// True if a text is the key of a cell, so that it can name a folder.
bool is_key(const std::string& text);

/// An object as a line, with the check of its text as the last member, without its line break.
/// Text that is no UTF-8 is replaced.
std::string checked_line(const nlohmann::ordered_json& object);

/// The line that withdraws another one.
std::string withdrawal_line(const std::string& file, int number, const std::string& reason);

/// A line as JSON that may be trusted.
struct TrustedLine {
  nlohmann::json object;
  bool checked = false;  ///< it had a check; those of older programs have none
};

/// The parts of a line that are needed; the reader may omit the rest to save time.
struct LineParts {
  bool metrics = true;
  bool frames = false;  ///< the list of frames of the metrics
};

/// Fails with incompatible where the line is whole and of another schema, with invalid_data where
/// it is damaged.
Result<TrustedLine> trusted_line(const std::string& text, const LineParts& parts);

/// Why the cell of a line failed; empty where it is done. A cell in which more frames had an error
/// than max_failed has failed, also where an older program called it done.
std::string failure_of(const nlohmann::json& line);

/// "29 of 39 frames had an error, more than max_failed (0)".
std::string too_many_failed(std::int64_t failed, std::int64_t frames, int max_failed);

/// The files in the folder of its cell that a line lists.
std::vector<CellFile> files_of_line(const nlohmann::json& line);

}  // namespace weft::lab
