// SPDX-License-Identifier: Apache-2.0
#include "cli/plugins/plugins_new.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <vector>
#include <weft/core/quote.hpp>
#include <weft/core/shell_word.hpp>
#include <weft/core/suggest.hpp>
#include <weft/core/whole_file.hpp>

#include "cli/output/new_file.hpp"
#include "cli/output/program_root.hpp"
#include "cli/plugins/scaffold.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string role, name, vendor, folder;
  std::string language = "c++";
};

Result<PluginName> checked(const Options& options) {
  const std::vector<std::string> known = scaffold_languages();
  if (std::find(known.begin(), known.end(), options.language) == known.end()) {
    const std::string all = fmt::format("; there are: {}", fmt::join(known, ", "));
    return Error{Errc::unsupported, "plugins in " + quote(options.language) +
                                        " cannot be made yet" +
                                        did_you_mean(options.language, known, all)};
  }
  return plugin_name(options.role, options.name, options.vendor);
}

Result<void> write_files(const std::map<std::string, std::string>& files, const fs::path& folder) {
  for (const auto& [path, content] : files) {
    std::error_code code;
    fs::create_directories((folder / path).parent_path(), code);
    if (code) return Error{Errc::io, "cannot be created: " + code.message(), folder.string()};
    if (auto written = write_whole(content, folder / path); !written) return written;
  }
  return {};
}

/// How CMake finds this Weft: nothing where it looks by itself.
std::string where_weft_is() {
  const fs::path root = program_root();
  std::error_code code;
  const std::string here = shell_word(root.string());
  if (fs::exists(root / "weftConfig.cmake", code)) return " -Dweft_DIR=" + here;
  if (root == "/usr" || root == "/usr/local") return "";
  return " -DCMAKE_PREFIX_PATH=" + here;
}

void make_plugin(const Options& options, Context& context) {
  const auto fail = [&](const Error& error, int exit_code) {
    print_error(error);
    context.exit_code = exit_code;
  };
  const auto plugin = checked(options);
  if (!plugin) return fail(plugin.error(), kBadConfiguration);
  const auto files =
      scaffold_files(*plugin, options.language, program_root() / "share/weft/scaffold");
  if (!files) {
    const bool unknown = files.error().code == Errc::unsupported;
    return fail(files.error(), unknown ? kBadConfiguration : kInputOutput);
  }
  const std::string folder = options.folder.empty() ? plugin->name : options.folder;
  if (auto made = make_new_folder(folder); !made) return fail(made.error(), kInputOutput);
  if (auto written = write_files(*files, folder); !written) {
    return fail(written.error(), kInputOutput);
  }
  for (const auto& [path, content] : *files) fmt::print("{}\n", (fs::path(folder) / path).string());
  const std::string build = shell_word((fs::path(folder) / "build").string());
  fmt::print(
      "\n{} is there. Build it, run its tests and its pipeline:\n  cmake -S {} -B {}{}\n"
      "  cmake --build {} --target check\n",
      plugin->id(), shell_word(folder), build, where_weft_is(), build);
}

}  // namespace

void add_new_plugin(CLI::App& plugins, Context& context) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = plugins.add_subcommand(
      "new", "Begin a plugin: a folder with one that works, its tests, page and pipeline");
  command->footer(
      "Exit codes:\n"
      "  0  made\n"
      "  2  the role, the name or the language is none\n"
      "  3  the folder is not empty or cannot be written");
  command
      ->add_option("ROLE", options->role,
                   "source, template, detector, matcher, filter, warp, pass, solver, stage or sink")
      ->type_name("")
      ->required();
  command->add_option("NAME", options->name, "Of the plugin: a to z, 0 to 9 and _")
      ->type_name("")
      ->required();
  command->add_option("--language", options->language, "Of its source: c++ (default), c or python")
      ->option_text("LANGUAGE");
  command->add_option("--out", options->folder, "Its folder, new or empty (default: NAME)")
      ->option_text("FOLDER");
  command
      ->add_option("--vendor", options->vendor,
                   "Yours, so that its id is role/VENDOR.NAME and no other is like it")
      ->option_text("VENDOR");
  command->callback([&context, options] { make_plugin(*options, context); });
}

}  // namespace weft::cli
