// SPDX-License-Identifier: Apache-2.0
#include "lab/results/result_lines.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <utility>

#include "host/records/content_hash.hpp"
#include "lab/metrics/runs/json_file.hpp"
#include "lab/results/cell_line.hpp"

namespace weft::lab {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Files of lines, in the order in which they count.
std::vector<std::string> files_of_lines(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    if (entry.path().extension() == ".jsonl") files.push_back(entry.path().filename().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

bool is_of_withdrawals(const std::string& file) { return file.starts_with("withdrawn-"); }

/// The key in a line that cannot be trusted, if it looks like one.
std::string likely_key(const std::string& text) {
  constexpr std::string_view kName = "\"key\":\"";
  const std::size_t at = text.find(kName);
  const std::string key = at == std::string::npos ? "" : text.substr(at + kName.size(), kKeyDigits);
  return is_key(key) ? key : "";
}

class LinesReader {
 public:
  LinesReader(std::string folder, const LineParts& parts, const TakeLine& take)
      : folder_(std::move(folder)), parts_(parts), take_(take) {}

  Result<LineFaults> read() {
    const std::vector<std::string> files = files_of_lines(folder_);
    const TakeLine withdraw = [this](const LinePlace&, const json& line) {
      withdrawn_.emplace(line.at("file"), line.at("line"));
      return Result<void>();
    };
    for (const bool withdrawals : {true, false}) {
      for (const std::string& file : files) {
        if (is_of_withdrawals(file) != withdrawals) continue;
        if (auto read = read_file(file, withdrawals ? withdraw : take_); !read) return read.error();
      }
    }
    return std::move(faults_);
  }

 private:
  Result<void> read_file(const std::string& name, const TakeLine& take) {
    const std::string path = folder_ + "/" + name;
    std::ifstream stream(path, std::ios::binary);
    if (!stream) return Error{Errc::io, "cannot be read", path};
    std::string text;
    LinePlace place{name};
    while (std::getline(stream, text)) {
      if (stream.eof()) return {};  // cut off
      ++place.number;
      const std::string where = path + ":" + std::to_string(place.number);
      if (withdrawn_.count({name, place.number}) == 0) {
        const auto read = read_line(text, place, take);
        if (!read && read.error().code != Errc::invalid_data) {
          return Error{read.error().code, read.error().message, where};
        }
        if (!read) {
          faults_.damaged.push_back(
              {where, read.error().message, likely_key(text), place.file, place.number});
        }
      }
      place.offset += text.size() + 1;
    }
    if (stream.bad()) return Error{Errc::io, "cannot be read to its end", path};
    return {};
  }

  Result<void> read_line(const std::string& text, const LinePlace& place, const TakeLine& take) {
    const auto line = trusted_line(text, parts_);
    if (!line) return line.error();
    try {
      if (auto taken = take(place, line->object); !taken) return taken;
    } catch (const json::exception& mistake) {
      return Error{Errc::invalid_data, reason_of(mistake)};
    }
    faults_.unchecked += line->checked ? 0 : 1;
    return {};
  }

  std::string folder_;
  LineParts parts_;
  const TakeLine& take_;
  std::set<std::pair<std::string, int>> withdrawn_;  ///< file and line
  LineFaults faults_;
};

std::string bytes_of(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

Result<LineFaults> read_result_lines(const std::string& folder, const LineParts& parts,
                                     const TakeLine& take) {
  return LinesReader(folder + "/results", parts, take).read();
}

std::string fault_of_files(const std::string& folder, const std::vector<CellFile>& files,
                           bool content) {
  std::error_code code;
  if (files.empty()) {
    return fs::exists(folder + "/pipeline.yaml", code) ? "" : "pipeline.yaml is missing";
  }
  for (const CellFile& file : files) {
    const std::string path = folder + "/" + file.name;
    const auto size = fs::file_size(path, code);
    if (code) return file.name + " is missing";
    if (size != file.bytes) {
      return file.name + " has " + std::to_string(size) + " bytes instead of " +
             std::to_string(file.bytes);
    }
    if (content && host::content_hash(bytes_of(path)) != file.hash) {
      return file.name + " was changed after it was written";
    }
  }
  return {};
}

Result<CellFile> cell_file(const std::string& folder, const std::string& name) {
  std::ifstream stream(folder + "/" + name, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad() || !stream.is_open()) {
    return Error{Errc::io, "cannot be read again", folder + "/" + name};
  }
  return CellFile{name, bytes.size(), host::content_hash(bytes)};
}

}  // namespace weft::lab
