// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "yaml/yaml.hpp"

namespace weft {

/// How the data at a path are read.
struct DataLayout {
  std::string kind;     ///< "sequence", "frames", "frames with depth", "matches" or "video"
  std::string folder;   ///< where relative paths of `source` stand; absolute
  yaml::Node source;    ///< {use, params} of the source that reads them
  std::string texture;  ///< [] path of the template's texture, or empty
  yaml::Node templ;     ///< {use, params} of the template that a YAML file names, or null
};

/// Ids of the sources that read files; set by the program.
struct FileSources {
  std::string images, matches, video;
};

/// Recognises, in this order:
/// - a sequence: a folder with sequence.yaml, or a YAML file, whose `source` is taken;
/// - images: a folder of them, or one with frames/, rgb/, color/ or colour/. Truth is gt/*.npz or
///   gt/*.csv, depth images are in depth/, the texture is template/texture.png or texture.png;
/// - matches: a folder with matches/*.npz or matches/*.csv and no images, or such a file;
/// - a video: any other file.
///
/// The camera file of images, matches and videos is `camera`, if it is given, else camera.yaml,
/// camera.yml, camera.json or K.json beside them; "auto" is one that the source assumes. Fails with
/// not_found and the list of expected files.
Result<DataLayout> find_data_layout(const std::string& path, const FileSources& sources,
                                    const std::string& camera = {});

}  // namespace weft
