// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/images/image_header.hpp>

#include "host/loading/registry.hpp"

namespace weft::cli {

/// The schema beside a pipeline that a command writes.
inline constexpr const char* kPipelineSchema = "pipeline.schema.json";

/// The first lines of such a pipeline; editors read in the first where the schema is.
std::string pipeline_head(const std::string& comment);

/// A file that is copied beside the pipeline, under this name.
struct Copy {
  std::string file, name;
};

/// The key `template` of a pipeline, and the files that it names.
struct TemplateKey {
  std::string text;
  std::vector<Copy> files;
};

/// Fails where a file is no image whose size is known.
Result<ImageHeader> picture_header(const std::string& path);

/// templates/rectangular of an image from edge to edge, with about this number of square cells
/// along its longer side. Fails if the file is no image.
Result<TemplateKey> flat_template(const std::string& picture, double width_m, int cells);

/// templates/photo of a photograph; `more` are further entries of its parameters, or empty.
TemplateKey photo_template_key(const std::string& photo, double width_m, const std::string& more);

/// templates/mesh of a folder that `weft template make` wrote.
TemplateKey mesh_template(const std::string& folder);

/// A path as a value inside { }.
std::string flow_quoted(const std::filesystem::path& path);

/// The numbers of "x,y x,y x,y x,y", however they are separated, as a list in YAML.
Result<std::string> corner_list(const std::string& corners);

/// Fails where a file is not there.
Result<void> check_are_there(const std::vector<Copy>& files);

/// Copies the files into a folder that is there, and writes the pipeline `name` and the schema
/// beside them.
Result<void> write_pipeline(const std::string& folder, const std::string& name,
                            const std::string& text, const std::vector<Copy>& files,
                            const host::Registry& registry);

}  // namespace weft::cli
