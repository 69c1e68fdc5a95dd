// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host/loading/component_spec.hpp"
#include "host/loading/former_names.hpp"
#include "yaml/yaml.hpp"

namespace weft {

/// One text that a configuration is made from.
struct ConfigSource {
  std::string name;    ///< a file, or a setting as the command line gave it
  std::string folder;  ///< where its relative paths start
  bool is_setting = false;
  std::string option = "--set";  ///< that gave a setting
  bool is_generated = false;     ///< for the option: places in the text mean nothing
};

/// "file:line:column", "file" of a whole file, "--set a.b=c, column 5", or "--video FILE".
std::string place_in(const std::vector<ConfigSource>& sources, yaml::Position at);

/// Something merged into a pipeline from separate texts: keys of a pipeline that extends another
/// one, `without`, and `set`, a map of settings.
struct Patch {
  std::vector<ConfigSource> sources;  ///< the texts that positions in `node` are in
  yaml::Node node;
};

/// A stage or sink of an extended file that `without` omits.
struct LeftOut {
  std::string name;
  std::string use;
  yaml::Position at;  ///< position of the name in `without`
};

/// Components that get their own process if the pipeline does not specify it.
enum class Isolating {
  preferred,  ///< stages that prefer it
  automatic,  ///< and what does not come with the program, unless it keeps arrays on a device
  none,       ///< none at all
  all,        ///< all that can
};

/// Source or template of one file of a pipeline, with what the file inherits.
struct PartOfFile {
  int source = 0;   ///< index of the file
  std::string key;  ///< "source" or "template"
  yaml::Node node;
};

/// A pipeline as one document. Its root is null when a text could not be read to its end.
struct PipelineDocument {
  yaml::Node root;
  std::vector<ConfigSource> sources;  ///< the file, what it extends, settings
  std::vector<LeftOut> left_out;
  std::vector<PartOfFile> parts;               ///< without patches and settings
  std::vector<yaml::Problem> problems;         ///< [.] errors with their places
  std::vector<host::FormerName> former_names;  ///< that the texts use; the root has current ones
  bool unreadable = false;                     ///< the file itself is the error: no further ones
                                               ///< are reported
  bool unclear = false;        ///< a missing key may be in a text that could not be read
  bool unclear_names = false;  ///< an error makes it unknown which stages are omitted
  /// A program passes images in and takes the results, so that the settings of source and sinks are
  /// ignored.
  bool in_program = false;
  std::vector<std::string> given;  ///< inputs of the frames that it passes beside image and time
  Isolating isolating = Isolating::preferred;
};

/// Reads a pipeline file, merges it over the file that it `extends` (which may extend another), and
/// lays the patches over the result, then the settings.
///
/// Maps are merged key by key, all other values are replaced. Another `use` drops the `params` of
/// the plugin that it replaces. Stages and sinks are merged by name (see names_of_stages). One that
/// the extended file lacks is inserted behind the one listed before it. If it is listed first, it
/// is inserted before the one listed after it, else at the end. `without: [NAME, ...]` omits stages
/// or sinks of the extended file.
///
/// A setting is PATH=VALUE. PATH begins with a key of the file (`seed`), with `source` or
/// `template` or with the name of a stage or sink. Parameters follow, joined by dots:
/// `filters.alpha_s=0.2`, `filters.warp.robust=tukey`, `detectors.use=detectors/orb`. VALUE is
/// YAML. `without=NAME,NAME` omits stages or sinks.
///
/// Former names of parameters and components become current ones before texts are merged.
PipelineDocument read_document(const std::string& file, const std::vector<std::string>& settings,
                               const host::Registry& registry, const host::PathRules& paths,
                               const std::vector<Patch>& patches = {});

/// The two steps of read_document, for a file with many variants: the first reads the file with
/// those that it extends, the second merges the rest.
PipelineDocument read_base(const std::string& file, const host::Registry& registry,
                           const host::PathRules& paths);
PipelineDocument laid_over(PipelineDocument base, const std::vector<Patch>& patches,
                           const std::vector<std::string>& settings, const host::Registry& registry,
                           const host::PathRules& paths);

/// "'start' (...) is deprecated: use 'initial_guess'; to update the file: weft migrate FILE". The
/// name is in one of the sources.
yaml::Problem warning_of(const host::FormerName& name, const std::vector<ConfigSource>& sources);

/// The names of the stages in a list: `as`, else the role meant, numbered from the second stage
/// without a name on: "filters", "filters#2".
std::vector<std::string> names_of_stages(const yaml::Node& list);

}  // namespace weft
