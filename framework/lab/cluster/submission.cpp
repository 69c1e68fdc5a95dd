// SPDX-License-Identifier: Apache-2.0
#include "lab/cluster/submission.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <weft/core/output_folder.hpp>

#include "host/records/content_hash.hpp"
#include "lab/metrics/runs/json_file.hpp"

namespace weft::cluster {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kSchema = "weft.submission/1";
constexpr int kMostSubmissions = 1'000'000;

/// Jobs of other results folders have other names.
std::string job_name(const std::string& results, const std::string& number) {
  return "weft-" + host::content_hash(results).substr(0, 8) + "-" + number;
}

Result<std::string> next_folder(const std::string& folder) {
  std::error_code code = make_folders(folder);
  for (int number = 1; !code && number < kMostSubmissions; ++number) {
    std::string next = fmt::format("{}/{:06}", folder, number);
    if (fs::create_directory(next, code)) {
      if (code = sync_path(folder); !code) return next;
    }
  }
  return Error{Errc::io, "cannot be written (" + code.message() + ")", folder};
}

std::string text_of(const json& object) {
  return object.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

Result<Submission> submission_in(const fs::path& folder) {
  const std::string file = folder / "order.json";
  const auto order = lab::read_json_object(file);
  if (!order) return order.error();
  if (lab::text_in(*order, "schema") != kSchema) {
    return Error{Errc::invalid_data, "has another schema than " + std::string(kSchema), file};
  }
  try {
    const json& equipment = order->at("equipment");
    return Submission{folder.string(),
                      folder.filename().string(),
                      order->at("job"),
                      order->at("tasks"),
                      order->at("processes"),
                      {equipment.at("weft"), equipment.at("processor"), equipment.at("builds")},
                      {}};
  } catch (const json::exception& mistake) {
    return Error{Errc::invalid_data, lab::reason_of(mistake), file};
  }
}

/// The submission of an unreadable order, from the name of its folder: Slurm still has its job.
Submission without_order(const fs::path& folder, const Error& fault) {
  const std::string number = folder.filename().string();
  return {folder.string(),
          number,
          job_name(folder.parent_path().string(), number),
          {},
          1,
          {},
          (folder / "order.json").string() + ": " +
              (fault.code == Errc::not_found ? "is missing" : fault.message) +
              "; the cells of its tasks are submitted again"};
}

}  // namespace

std::size_t cells_of(const Chunk& chunk) {
  std::size_t cells = 0;
  for (const Group& group : chunk) cells += group.size();
  return cells;
}

std::string Submission::log_of(int task) const {
  return folder + "/task_" + std::to_string(task) + ".txt";
}

std::string Submission::report_of(int task) const {
  return folder + "/task_" + std::to_string(task) + ".json";
}

std::string cluster_folder(const std::string& results) {
  return (fs::absolute(results).lexically_normal() / "slurm").string();
}

Result<Submission> create_submission(const std::string& results, std::vector<Chunk> tasks,
                                     int processes, const Equipment& equipment) {
  const std::string parent = cluster_folder(results);
  const auto folder = next_folder(parent);
  if (!folder) return folder.error();
  const std::string number = fs::path(*folder).filename().string();
  Submission submission{*folder,   number, job_name(parent, number), std::move(tasks), processes,
                        equipment, {}};
  const json order{{"schema", kSchema},
                   {"job", submission.job},
                   {"processes", processes},
                   {"tasks", submission.tasks},
                   {"equipment",
                    {{"weft", equipment.weft},
                     {"processor", equipment.processor},
                     {"builds", equipment.builds}}}};
  if (auto written = write_whole(text_of(order), *folder + "/order.json"); !written) {
    return written.error();
  }
  return submission;
}

Result<Submission> read_submission(const std::string& results, const std::string& number) {
  return submission_in(fs::path(cluster_folder(results)) / number);
}

Result<std::vector<Submission>> read_submissions(const std::string& results) {
  std::vector<fs::path> folders;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(cluster_folder(results), code)) {
    // A process that was killed before there was an order has not written a script either.
    const bool is_begun =
        fs::exists(entry.path() / "order.json", code) || fs::exists(entry.path() / "task.sh", code);
    if (is_begun) folders.push_back(entry.path());
  }
  std::sort(folders.begin(), folders.end());
  std::vector<Submission> all;
  for (const fs::path& folder : folders) {
    auto submission = submission_in(folder);
    const bool is_whole = static_cast<bool>(submission);
    all.push_back(is_whole ? *std::move(submission) : without_order(folder, submission.error()));
  }
  return all;
}

Result<void> write_report(const Submission& submission, int task, const TaskReport& report) {
  const json object{{"machine", report.machine},
                    {"seconds", report.seconds},
                    {"cells", report.cells},
                    {"left", report.left}};
  return write_whole(text_of(object), submission.report_of(task));
}

Result<TaskReport> read_report(const Submission& submission, int task) {
  const std::string file = submission.report_of(task);
  const auto object = lab::read_json_object(file);
  if (!object) return object.error();
  try {
    return TaskReport{object->at("machine"), object->at("seconds"), object->at("cells"),
                      object->at("left")};
  } catch (const json::exception& mistake) {
    return Error{Errc::invalid_data, lab::reason_of(mistake), file};
  }
}

}  // namespace weft::cluster
