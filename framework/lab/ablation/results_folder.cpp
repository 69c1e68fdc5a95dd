// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/results_folder.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <thread>
#include <utility>
#include <weft/core/output_folder.hpp>
#include <weft/core/version.hpp>

#include "lab/ablation/folder_check.hpp"
#include "lab/ablation/line_of_cell.hpp"
#include "lab/results/cell_line.hpp"
#include "lab/results/checked_document.hpp"
#include "lab/results/result_lines.hpp"
#include "pipeline/runs/source_revision.hpp"

namespace weft::lab {
namespace {

namespace fs = std::filesystem;

constexpr int kMostFiles = 1'000'000;
constexpr const char* kLockFile = ".lock";  ///< where a folder cannot be locked itself

Error io_error(const std::string& file, const std::string& message) {
  return {Errc::io, message, file};
}

/// Makes sure that what was written survives the machine's failure too.
Result<void> make_last(const std::string& path) {
  const std::error_code code = sync_path(path);
  if (!code) return {};
  return io_error(path, "cannot be written to disk (" + why_not_written(code) + ")");
}

/// The folder's descriptor, locked for this process and its children. Children of a process that
/// was killed may still be dying.
Result<int> lock_folder(const std::string& path) {
  int descriptor = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return io_error(path, "cannot be opened");
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EBADF) {
    // NFS locks what is open for writing alone.
    close(descriptor);
    const std::string file = path + "/" + kLockFile;
    descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0) return io_error(file, "cannot be created; is the folder writable?");
  }
  constexpr int kTries = 100;
  constexpr auto kPause = std::chrono::milliseconds(50);
  for (int i = 0; i < kTries; ++i) {
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
    if (errno != EWOULDBLOCK && errno != EINTR) {
      const std::error_code code(errno, std::generic_category());
      close(descriptor);
      return io_error(path, "cannot be locked (" + code.message() + ")");
    }
    std::this_thread::sleep_for(kPause);
  }
  close(descriptor);
  return Error{Errc::invalid_value, "is in use by another `weft ablate`", path};
}

/// Files that a process which was killed, or met a full disk, had begun to write under names that
/// begin with `stem`.
void remove_begun_files(const std::string& folder, const std::string& stem) {
  std::error_code code;
  std::vector<fs::path> begun;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(stem) && name.find(".part") != std::string::npos) {
      begun.push_back(entry.path());
    }
  }
  for (const fs::path& file : begun) fs::remove(file, code);
}

std::string manifest_text(const Grid& grid, bool accept_rebuilt) {
  const Measurement& measurement = grid.plan().measurement;
  nlohmann::ordered_json manifest{{"schema", kFolderSchema},
                                  {"weft", kVersion},
                                  {"git", host::source_revision()},
                                  {"plan", grid.plan().name},
                                  {"metrics",
                                   {{"alignment", to_string(measurement.options.alignment)},
                                    {"match_tolerance_px", measurement.options.match_tolerance_px},
                                    {"frames", measurement.frames}}},
                                  {"accept_rebuilt", accept_rebuilt}};
  return checked_document(std::move(manifest), 2);
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
  std::size_t done = 0;
  while (done < text.size()) {  // only a further write reports why one was short
    const ssize_t written = write(descriptor_, text.data() + done, text.size() - done);
    if (written <= 0) break;
    done += static_cast<std::size_t>(written);
  }
  if (done == text.size() && fsync(descriptor_) == 0) {
    size_ += static_cast<std::int64_t>(done);
    return {};
  }
  const std::error_code code(errno, std::generic_category());
  // Readers leave a line without its end out, so that it does no harm if this fails too.
  static_cast<void>(ftruncate(descriptor_, size_));
  return io_error(file_, "cannot be written (" + why_not_written(code) + ")");
}

ResultsFolder::ResultsFolder(ResultsFolder&& other) noexcept
    : path_(std::move(other.path_)),
      lock_(std::exchange(other.lock_, -1)),
      shared_(std::move(other.shared_)),
      rebuilt_(std::move(other.rebuilt_)) {}

ResultsFolder::~ResultsFolder() {
  if (lock_ >= 0) close(lock_);
}

Result<ResultsFolder> ResultsFolder::look(const std::string& path, const std::string& plan) {
  std::error_code code;
  if (fs::exists(path, code) && !fs::is_directory(path, code)) {
    return Error{Errc::invalid_value, "is no folder; choose another with --out", path};
  }
  auto legal = check_results_folder(path, plan);
  if (!legal) return legal.error();
  ResultsFolder folder(fs::absolute(path).string(), -1);
  folder.rebuilt_ = *std::move(legal);
  return folder;
}

Result<ResultsFolder> ResultsFolder::open(const std::string& path, const std::string& plan) {
  const std::string absolute = fs::absolute(path).string();
  std::error_code code = make_folders(absolute);
  if (code) return io_error(path, "cannot be made a folder; choose another with --out");
  auto legal = check_results_folder(path, plan);
  if (!legal) return legal.error();
  const auto lock = lock_folder(path);
  if (!lock) return lock.error();
  ResultsFolder folder(absolute, *lock);
  folder.rebuilt_ = *std::move(legal);
  // The folder may have files of the user too.
  for (const char* own : {"manifest.json.", "plan.json.", "index.sqlite."}) {
    remove_begun_files(path, own);
  }
  for (const char* inner : {"results", "cells"}) {
    if (!code) code = make_folders(absolute + "/" + inner);
  }
  if (code || access((path + "/results").c_str(), W_OK) != 0 || access(path.c_str(), W_OK) != 0) {
    return io_error(path, "cannot be written; choose another folder with --out");
  }
  return folder;
}

Result<ResultsFolder> ResultsFolder::join(const std::string& path, const std::string& plan,
                                          SharedWriter writer) {
  std::error_code code;
  if (!fs::is_directory(path + "/results", code)) {
    return Error{Errc::not_found, "is no results folder here; do all machines share it?", path};
  }
  if (auto legal = check_results_folder(path, plan); !legal) return legal.error();
  if (access((path + "/results").c_str(), W_OK) != 0) return io_error(path, "cannot be written");
  ResultsFolder folder(fs::absolute(path).string(), -1);
  folder.shared_ = std::move(writer);
  return folder;
}

std::string ResultsFolder::log_file() const { return shared_ ? shared_->log : path_ + "/log.txt"; }

Result<void> ResultsFolder::describe(const Grid& grid, const std::string& command,
                                     bool accept_rebuilt) const {
  auto manifest = write_whole(manifest_text(grid, accept_rebuilt), path_ + "/manifest.json");
  if (!manifest) return manifest;
  return write_whole(to_json(grid.record(command)), path_ + "/plan.json");
}

Result<void> ResultsFolder::withdraw(const std::vector<Damage>& lines) const {
  if (lines.empty()) return {};
  // The withdrawn line is on the disk: another line at its place would be withdrawn with it.
  for (const Damage& line : lines) {
    if (auto lasting = make_last(path_ + "/results/" + line.file); !lasting) return lasting;
  }
  if (auto lasting = make_last(path_ + "/results"); !lasting) return lasting;
  auto writer = lines_file("withdrawn");
  if (!writer) return writer.error();
  for (const Damage& line : lines) {
    auto written = writer->append(withdrawal_line(line.file, line.line, line.what));
    if (!written) return written;
  }
  return {};
}

Result<LineWriter> ResultsFolder::writer(bool timed) const {
  const std::string kind = timed ? "alone" : "cached";
  return lines_file(shared_ ? kind + "-" + shared_->name : kind);
}

Result<LineWriter> ResultsFolder::lines_file(const std::string& kind) const {
  for (int number = 1; number < kMostFiles; ++number) {
    const std::string file = fmt::format("{}/results/{}-{:06}.jsonl", path_, kind, number);
    constexpr int kFlags = O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC;
    const int descriptor = ::open(file.c_str(), kFlags, 0666);
    if (descriptor >= 0) {
      LineWriter lines(file, descriptor);
      if (auto lasting = make_last(path_ + "/results"); !lasting) return lasting.error();
      return lines;
    }
    if (errno != EEXIST) return io_error(file, "cannot be created; is the disk full?");
  }
  return io_error(path_ + "/results", "holds too many files");
}

/// Where files of a cell are written: in its folder, or where another writer of the same cell does
/// not write into them.
Result<std::string> ResultsFolder::begin_files(const std::string& folder) const {
  if (!shared_) {
    remove_begun_files(folder, "");
    return folder;
  }
  const std::string work = shared_->work + "/" + std::to_string(getpid());
  std::error_code code;
  fs::create_directories(work, code);
  if (code) return io_error(work, "cannot be created; is the disk full?");
  return work;
}

Result<void> ResultsFolder::keep(const Cell& cell, const CellResult& result, bool timed,
                                 const Measurement& measurement, LineWriter& lines) const {
  const std::string folder = path_ + "/cells/" + cell.identity.key;
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) return io_error(folder, "cannot be created; is the disk full?");
  const auto work = begin_files(folder);
  if (!work) return work.error();
  const auto path_of = [&](const std::string& name) { return *work + "/" + name; };
  // All of them are written to the disk before the line is.
  const auto write_now = [&](const std::string& bytes, const std::string& name) {
    return write_whole(bytes, path_of(name), Durability::unsynced);
  };
  std::vector<std::string> names{"pipeline.yaml"};
  if (auto written = write_now(result.pipeline, names.back()); !written) return written;
  if (!result.shapes.empty()) {
    names.emplace_back("shapes.npz");
    auto written = host::write_npz(path_of(names.back()), result.shapes, Durability::unsynced);
    if (!written) return written;
  }
  for (const auto& [name, bytes] : result.pictures) {
    names.push_back(name);
    if (auto written = write_now(bytes, name); !written) return written;
  }
  std::vector<CellFile> files;
  for (const std::string& name : names) {
    if (auto lasting = make_last(path_of(name)); !lasting) return lasting;
    auto file = cell_file(*work, name);
    if (!file) return file.error();
    files.push_back(*std::move(file));
    if (shared_) fs::rename(path_of(name), folder + "/" + name, code);
    if (code) return io_error(folder, "cannot take " + name + " (" + code.message() + ")");
  }
  for (const std::string& each : {folder, path_ + "/cells"}) {
    if (auto lasting = make_last(each); !lasting) return lasting;
  }
  return lines.append(line_of_cell(cell, result, timed, measurement, files));
}

}  // namespace weft::lab
