// SPDX-License-Identifier: Apache-2.0
// The library as a file, and what loading and describing it does to the process.
#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <weft/core/text_file.hpp>

#include "host/describe/build_id.hpp"
#include "host/describe/describe.hpp"
#include "kit/conformance/check_in_child.hpp"
#include "kit/conformance/groups.hpp"
#include "kit/conformance/probes/elf_facts.hpp"
#include "kit/conformance/probes/process_state.hpp"
#include "kit/conformance/probes/utf8_text.hpp"
#include "process/program.hpp"

namespace weft::conformance {
namespace {

constexpr std::uint64_t kMostManifestBytes = 16 << 20;  ///< maximum size of a manifest
constexpr double kLongLoading_ms = 100.0, kLongestLoading_ms = 300.0;

/// [ms] that loading takes, computing or waiting for anything but a processor.
double loading_ms(const std::string& library) {
  const auto seen = check_in_child("load/time", {}, std::chrono::seconds(60), [&](Notebook& notes) {
    notes.check("load/time", [&](Page& page) {
      const double queued_before_ms = queued_ms(gettid());
      const auto start = std::chrono::steady_clock::now();
      static_cast<void>(host::load_library(library));
      const std::chrono::duration<double, std::milli> took =
          std::chrono::steady_clock::now() - start;
      page.note(std::to_string(took.count() - (queued_ms(gettid()) - queued_before_ms)));
    });
  });
  const bool is_measured = !seen.empty() && seen.front().verdict == Verdict::holds;
  return is_measured ? std::stod(seen.front().seen)
                     : 0.0;  // another check reports libraries that cannot be loaded
}

/// Twice, for the first time what it needs may come from a disk.
void check_time(const std::string& library, Page& page) {
  double took_ms = loading_ms(library);
  if (took_ms > kLongLoading_ms) took_ms = std::min(took_ms, loading_ms(library));
  const std::string figure = fmt::format("{:.0f} ms", took_ms);
  page.expect(took_ms <= kLongestLoading_ms,
              figure + ": make what takes time when it is first needed");
  page.note(figure + (took_ms > kLongLoading_ms ? ", more than 100 ms" : ""));
}

/// The mode that this thread is left in, which the host would set back.
std::string mode_after_loading(const std::string& library) {
  dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  return floating_point_mode();
}

void check_symbol(const std::string& library, Page& page) {
  const auto facts = read_elf_facts(library);
  if (!facts) return page.fail(facts.error().message);
  const std::vector<std::string>& all = facts->exported;
  const bool alone = all.size() == 1 && all.front() == "weft_library";
  const std::size_t shown = std::min<std::size_t>(all.size(), 4);
  page.expect(
      alone,
      fmt::format("exports {} symbols ({}), not weft_library alone: link it with "
                  "the version script of weft_add_plugin",
                  all.size(),
                  fmt::join(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(shown), ", ")));
}

void check_static_tls(const std::string& library, Page& page) {
  const auto facts = read_elf_facts(library);
  if (!facts) return page.fail(facts.error().message);
  page.expect(!facts->has_static_tls,
              "its thread-local variables need room that a running program may not have left "
              "(DF_STATIC_TLS): compile it with -fPIC and without -ftls-model=initial-exec");
}

/// The error of a text of the table; empty if there is none.
std::string mistake_in(const char* text, const char* name) {
  if (text == nullptr)
    return fmt::format("its '{}' is null: give \"\" where there is nothing", name);
  return is_utf8(text) ? "" : fmt::format("its '{}' is no UTF-8", name);
}

void check_layout(const weft_library_table& table, Page& page) {
  const auto reserved = [](std::uint64_t word) { return word != 0; };
  page.expect(table.magic == WEFT_ABI_MAGIC, "its magic number is another one");
  page.expect(table.abi_major == WEFT_ABI_MAJOR, "its major version is another one");
  page.expect(table.struct_size >= sizeof(weft_library_table), "its table is shorter than 1.0");
  page.expect(table.sdk_minor > WEFT_ABI_MINOR ||
                  (std::none_of(std::begin(table.reserved), std::end(table.reserved), reserved) &&
                   table.reserved_half == 0),
              "a reserved field of its table is not 0");
  page.expect(table.needs_minor <= table.sdk_minor, "it needs a newer host than its SDK");
  for (const auto& [text, name] :
       {std::pair{table.isa, "isa"}, std::pair{table.compiler, "compiler"}}) {
    if (const std::string wrong = mistake_in(text, name); !wrong.empty()) page.fail(wrong);
  }
  for (std::uint32_t i = 0; i < table.count; ++i) {
    const weft_component& component = *table.components[i];
    page.expect(component.struct_size >= sizeof(weft_component), "a component is shorter than 1.0");
    const std::pair<const char*, const char*> texts[] = {{component.id, "id"},
                                                         {component.version, "version"},
                                                         {component.summary, "summary"},
                                                         {component.reference, "reference"},
                                                         {component.licence, "licence"},
                                                         {component.determinism, "determinism"},
                                                         {component.needs, "needs"},
                                                         {component.reads, "reads"},
                                                         {component.produces, "produces"}};
    for (const auto& [text, name] : texts) {
      if (const std::string wrong = mistake_in(text, name); !wrong.empty()) page.fail(wrong);
    }
  }
}

void check_processor(const weft_library_table& table, const host::Manifest& manifest, Page& page) {
  std::string words;
  for (const std::string& feature : manifest.isa) words += (words.empty() ? "" : " ") + feature;
  page.expect(table.isa != nullptr && words == table.isa,
              "the library and its manifest name other features: describe it again");
}

void check_manifest(const weft_library_table& table, const host::Manifest& manifest, Page& page) {
  const auto written = read_text_file(manifest.file, kMostManifestBytes);
  const auto build_id = host::read_build_id(manifest.library);
  if (!written || !build_id) return page.fail("manifest or library cannot be read");
  const auto said = host::describe_library(table, *build_id);
  if (!said) return page.fail(said.error().message);
  page.expect(*written == *said,
              "it differs from the library's own description: build the plugin again, or call weft "
              "plugins describe " +
                  manifest.library);
}

void check_strip(const host::Manifest& manifest, Page& page) {
  const testing::ScratchFolder folder;
  const std::string copy = (folder.path() / "stripped.so").string();
  const auto done = process::run_program({"strip", "--strip-all", "-o", copy, manifest.library});
  if (!done) return page.skip("there is no program 'strip' here");
  if (done->exit_code != 0) return page.fail("strip refuses it: " + done->err);
  const auto build_id = host::read_build_id(copy);
  if (!build_id) return page.fail("stripped, " + build_id.error().message);
  page.expect(*build_id == manifest.build_id,
              "stripped, it has another build-id: link it with -Wl,--build-id=sha1");
  const auto table = host::load_library(copy);
  if (!table) page.fail("stripped, " + table.error().message);
}

void check_opening(const weft_library_table& table, const host::Manifest& manifest, Page& page) {
  if (!forbid_opening()) return page.skip("this kernel does not report opened files");
  const auto said = host::describe_library(table, manifest.build_id);
  const std::string opened = forbidden_opening();
  page.expect(opened.empty(), "its constructor opens " + opened +
                                  ": open files in prepare(), or where they are first needed");
  if (!said && opened.empty()) page.fail(said.error().message);
}

}  // namespace

void check_load(const Setting& setting, Notebook& notebook) {
  const host::Manifest& manifest = *setting.candidate.installed()->library;
  const std::string& library = manifest.library;
  notebook.check("load/symbol", [&](Page& page) { check_symbol(library, page); });
  notebook.check("load/static_tls", [&](Page& page) { check_static_tls(library, page); });
  notebook.check("load/time", [&](Page& page) { check_time(library, page); });
  const std::int64_t printed = printed_bytes();
  const std::size_t threads = count_threads();
  notebook.check("load/floating_point", [&](Page& page) {
    const std::string before = floating_point_mode();
    page.expect(mode_after_loading(library) == before,
                "loading it changes it: link it without -ffast-math");
  });
  Result<const weft_library_table*> table = Error{};
  const auto load = [&] { table = host::load_library(library); };
  notebook.check("load/binds_now", [&](Page& page) {
    load();
    if (!table) page.fail(table.error().message);
  });
  if (!table) load();
  if (!table) return;
  notebook.check("load/silent", [&](Page& page) {
    page.expect(printed_bytes() == printed, "loading it prints: use weft_host.log in a call");
  });
  notebook.check("load/threads", [&](Page& page) {
    page.expect(count_threads() == threads,
                "loading it starts a thread: start threads in calls, and end them there");
  });
  notebook.check("load/layout", [&](Page& page) { check_layout(**table, page); });
  notebook.check("load/processor", [&](Page& page) { check_processor(**table, manifest, page); });
  notebook.check("load/manifest", [&](Page& page) { check_manifest(**table, manifest, page); });
  notebook.check("load/strip", [&](Page& page) { check_strip(manifest, page); });
  // The last one: from then on nothing can be opened.
  notebook.check("load/opens_nothing", [&](Page& page) { check_opening(**table, manifest, page); });
}

}  // namespace weft::conformance
