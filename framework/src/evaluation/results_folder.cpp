// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>
#include <weft/core/whole_file.hpp>
#include <weft/evaluation/results_folder.hpp>

#include "cell_line.hpp"

namespace weft::evaluation {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kMostFiles = 1'000'000;

Error io_error(const std::string& file, const std::string& message) {
  return {Errc::io, message, file};
}

/// Makes sure that what was written survives the machine's failure too.
Result<void> make_last(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && fsync(descriptor) == 0;
  if (descriptor >= 0) close(descriptor);
  if (!synced) return io_error(path, "cannot be written to disk; is the disk full?");
  return {};
}

/// A new folder, or one in which a process was killed before it had written the manifest.
bool is_fresh(const std::string& path) {
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(path, code)) {
    const bool empty_folder = entry.is_directory(code) && fs::is_empty(entry.path(), code);
    if (entry.path().extension() != ".part" && !empty_folder) return false;
  }
  return true;
}

Result<void> check_schema(const std::string& path) {
  const std::string file = path + "/manifest.json";
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    if (is_fresh(path)) return {};
    return Error{Errc::invalid_value,
                 "is neither empty nor a results folder; choose another with --out", path};
  }
  const json manifest = json::parse(stream, nullptr, false);
  const std::string schema =
      manifest.is_object() ? manifest.value("schema", std::string()) : std::string();
  if (schema == kFolderSchema) return {};
  return Error{Errc::invalid_value,
               "has the schema '" + schema + "', this program writes '" + kFolderSchema +
                   "'; choose another folder with --out",
               file};
}

/// The folder's descriptor, locked for this process and its children. Children of a process that
/// was killed may still be dying.
Result<int> lock_folder(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return io_error(path, "cannot be opened");
  constexpr int kTries = 100;
  constexpr auto kPause = std::chrono::milliseconds(50);
  for (int i = 0; i < kTries; ++i) {
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
    std::this_thread::sleep_for(kPause);
  }
  close(descriptor);
  return Error{Errc::invalid_value, "is in use by another `weft ablate`", path};
}

std::vector<std::string> line_files(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    if (entry.path().extension() == ".jsonl") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

Result<void> read_lines(const std::string& file, std::map<std::string, StoredCell>& cells) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return io_error(file, "cannot be read");
  std::string text;
  std::uint64_t offset = 0;
  for (int number = 1; std::getline(stream, text); ++number) {
    if (stream.eof()) return {};  // cut off
    auto cell = parse_cell_line(text);
    if (!cell) {
      return Error{cell.error().code, cell.error().message, file + ":" + std::to_string(number)};
    }
    cell->file = fs::path(file).filename().string();
    cell->offset = offset;
    offset += text.size() + 1;
    std::string key = cell->key;
    cells.emplace(std::move(key), *std::move(cell));
  }
  if (stream.bad()) return io_error(file, "cannot be read to its end");
  return {};
}

}  // namespace

LineWriter::LineWriter(LineWriter&& other) noexcept
    : file_(std::move(other.file_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      size_(other.size_) {}

LineWriter::~LineWriter() {
  if (descriptor_ >= 0) close(descriptor_);
}

Result<void> LineWriter::append(const std::string& line) {
  const std::string text = line + "\n";
  const ssize_t written = write(descriptor_, text.data(), text.size());
  const bool whole = written == static_cast<ssize_t>(text.size());
  if (whole && fsync(descriptor_) == 0) {
    size_ += written;
    return {};
  }
  // Readers leave a line without its end out, so that it does no harm if this fails too.
  static_cast<void>(ftruncate(descriptor_, size_));
  return io_error(file_, "cannot be written; is the disk full?");
}

ResultsFolder::ResultsFolder(ResultsFolder&& other) noexcept
    : path_(std::move(other.path_)), lock_(std::exchange(other.lock_, -1)) {}

ResultsFolder::~ResultsFolder() {
  if (lock_ >= 0) close(lock_);
}

Result<ResultsFolder> ResultsFolder::open(const std::string& path) {
  std::error_code code;
  fs::create_directories(path, code);
  if (code || !fs::is_directory(path, code)) {
    return io_error(path, "cannot be made a folder; choose another with --out");
  }
  if (auto legal = check_schema(path); !legal) return legal.error();
  const auto lock = lock_folder(path);
  if (!lock) return lock.error();
  ResultsFolder folder(fs::absolute(path).string(), *lock);
  for (const char* inner : {"results", "cells"}) fs::create_directories(path + "/" + inner, code);
  if (code || access((path + "/results").c_str(), W_OK) != 0 || access(path.c_str(), W_OK) != 0) {
    return io_error(path, "cannot be written; choose another folder with --out");
  }
  return folder;
}

Result<void> ResultsFolder::describe(const Grid& grid, const std::string& command,
                                     bool accept_rebuilt) const {
  auto manifest = write_whole(manifest_text(grid, accept_rebuilt), path_ + "/manifest.json");
  if (!manifest) return manifest;
  return write_whole(plan_text(grid, command), path_ + "/plan.json");
}

Result<std::map<std::string, StoredCell>> ResultsFolder::read() const {
  std::map<std::string, StoredCell> cells;
  for (const std::string& file : line_files(path_ + "/results")) {
    if (auto read = read_lines(file, cells); !read) return read.error();
  }
  return cells;
}

Result<LineWriter> ResultsFolder::writer(bool timed) const {
  for (int number = 1; number < kMostFiles; ++number) {
    const std::string file =
        fmt::format("{}/results/{}-{:06}.jsonl", path_, timed ? "alone" : "cached", number);
    constexpr int kFlags = O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC;
    const int descriptor = ::open(file.c_str(), kFlags, 0666);
    if (descriptor >= 0) return LineWriter(file, descriptor);
    if (errno != EEXIST) return io_error(file, "cannot be created; is the disk full?");
  }
  return io_error(path_ + "/results", "holds too many files");
}

Result<void> ResultsFolder::keep(const Cell& cell, const CellResult& result, bool timed,
                                 const Measurement& measurement, LineWriter& lines) const {
  const std::string folder = path_ + "/cells/" + cell.identity.key;
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) return io_error(folder, "cannot be created; is the disk full?");
  std::vector<std::string> files{folder + "/pipeline.yaml"};
  if (auto written = write_whole(result.pipeline, files.back()); !written) return written;
  if (!result.shapes.empty()) {
    files.push_back(folder + "/shapes.npz");
    if (auto written = host::write_npz(files.back(), result.shapes); !written) return written;
  }
  for (const auto& [name, bytes] : result.pictures) {
    files.push_back(folder + "/" + name);
    if (auto written = write_whole(bytes, files.back()); !written) return written;
  }
  files.insert(files.end(), {folder, path_ + "/cells"});
  for (const std::string& file : files) {
    if (auto lasting = make_last(file); !lasting) return lasting;
  }
  return lines.append(cell_line(cell, result, timed, measurement));
}

}  // namespace weft::evaluation
