// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "host/calling/execution_context.hpp"
#include "host/loading/component_spec.hpp"

namespace weft::misbehaving {

namespace fs = std::filesystem;

inline const std::string kFolder = WEFT_MISBEHAVING_FOLDER;

inline std::string library(const std::string& name) { return kFolder + "/" + name + ".so"; }

inline std::string read_file(const fs::path& file) {
  std::ostringstream content;
  content << std::ifstream(file, std::ios::binary).rdbuf();
  return content.str();
}

inline void write_file(const fs::path& file, const std::string& content) {
  fs::remove(file);  // overwriting in place may wait for the disk
  std::ofstream(file, std::ios::binary | std::ios::trunc) << content;
}

/// A folder of the running test's own, gone with it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "weft_test_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const fs::path& path() const { return path_; }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

  /// Copies a library of this folder and its manifest here.
  void adopt(const std::string& name, const std::string& new_name = {}) const {
    const std::string target = new_name.empty() ? name : new_name;
    for (const char* ending : {".so", ".plugin.yaml"}) {
      fs::copy_file(kFolder + "/" + name + ending, path_ / (target + ending));
    }
  }

 private:
  fs::path path_;
};

inline host::Registry scan(const std::string& folder = kFolder) {
  return host::Registry::scan({{folder, "test"}});
}

/// The refusal of a file, which must be there.
inline host::Refusal refusal_of(const host::Registry& registry, const std::string& file_name) {
  for (const host::Refusal& refusal : registry.refusals()) {
    if (fs::path(refusal.file).filename() == file_name) return refusal;
  }
  ADD_FAILURE() << file_name << " was not refused";
  return {};
}

/// A component as a pipeline resolves it; the problems as "line:column: message".
struct Resolved {
  std::optional<host::ComponentSpec> spec;
  std::vector<std::string> problems;

  std::string problem() const { return problems.empty() ? "" : problems.front(); }
};

inline Resolved resolve(const host::Registry& registry, const std::string& id,
                        const std::string& params = "{}",
                        const host::PathRules& paths = host::PathRules::of_process({"/"}, "/tmp")) {
  Resolved result;
  const auto document = yaml::parse("use: " + id + "\nparams: " + params + "\n", "test.yaml");
  if (!document) throw std::runtime_error(document.error().message);
  std::vector<yaml::Problem> problems = document->problems;
  result.spec = host::resolve_component(registry, *document->root.find("use"),
                                        document->root.find("params"), paths, problems);
  for (const yaml::Problem& problem : problems) {
    result.problems.push_back(std::to_string(problem.at.line) + ":" +
                              std::to_string(problem.at.column) + ": " + problem.message);
  }
  return result;
}

/// `count` matches on a line, all kept, without a template.
inline Correspondences make_matches(std::int64_t count) {
  Correspondences matches;
  matches.template_px = Array<double>({count, 2}, 0.0);
  matches.image_px = Array<double>({count, 2}, 0.0);
  matches.face = Array<std::int32_t>({count}, 0);
  matches.barycentrics = Array<double>({count, 3}, 0.0);
  matches.kept = Array<std::uint8_t>({count}, 0);
  matches.score = Array<double>({count}, 0.0);
  for (std::int64_t i = 0; i < count; ++i) {
    matches.template_px(i, 0) = 10.0 + static_cast<double>(i);
    matches.kept(i) = 1;
    matches.score(i) = 1.0;
  }
  return matches;
}

/// One filter of this folder in a separate execution context.
class Subject {
 public:
  Subject(const host::Registry& registry, const std::string& id, const std::string& params = "{}")
      : context_(1, {}), resolved_(resolve(registry, id, params)) {
    if (!resolved_.spec) throw std::runtime_error(resolved_.problem());
    created_ = context_.instantiate(*resolved_.spec, "filters");
  }

  const Result<host::Instance*>& created() const { return created_; }
  host::ExecutionContext& context() { return context_; }

  /// Filters `count` matches.
  host::Outcome filter(std::int64_t count = 5) {
    const Correspondences matches = make_matches(count);
    const RecordView<Correspondences> view("correspondences", matches);
    const weft_record inputs[] = {view.raw()};
    return context_.call(**created_, 0, inputs, 0);
  }

 private:
  host::ExecutionContext context_;
  Resolved resolved_;
  Result<host::Instance*> created_ = Error{};
};

}  // namespace weft::misbehaving
