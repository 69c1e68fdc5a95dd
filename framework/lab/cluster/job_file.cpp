// SPDX-License-Identifier: Apache-2.0
#include "lab/cluster/job_file.hpp"

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <weft/core/whole_file.hpp>

#include "lab/metrics/runs/json_file.hpp"

namespace weft::cluster {
namespace {

std::string file_of(const Submission& submission) { return submission.folder + "/job.json"; }

}  // namespace

Result<void> write_job(const Submission& submission, const Job& job) {
  const nlohmann::json object{{"id", job.id}, {"cluster", job.cluster}};
  const auto handler = nlohmann::json::error_handler_t::replace;
  return write_whole(object.dump(1, ' ', false, handler) + "\n", file_of(submission));
}

Job read_job(const Submission& submission) {
  const auto object = lab::read_json_object(file_of(submission));
  if (!object) return {};
  return {lab::text_in(*object, "id"), lab::text_in(*object, "cluster")};
}

std::string clusters_in(const std::vector<std::string>& options) {
  const char* environment = std::getenv("SBATCH_CLUSTERS");
  std::string clusters = environment != nullptr ? environment : "";
  for (const std::string& option : options) {
    for (const std::string name : {"--clusters=", "--cluster=", "-M"}) {
      if (option.starts_with(name)) clusters = option.substr(name.size());
    }
  }
  return clusters;
}

}  // namespace weft::cluster
