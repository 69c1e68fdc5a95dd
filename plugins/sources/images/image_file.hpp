// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

#include "common/cameras/calibrated_camera.hpp"

namespace weft::images {

/// A decoded image of 8 bits a channel, grey or BGR, without its alpha channel.
Result<image_files::Decoded> of_8_bits(image_files::Decoded image, const std::string& path);

/// Reads an image of the camera, of 8 bits a channel, upright: grey or BGR, without its alpha
/// channel. `damage` is what the decoder of a JPEG found wrong.
Result<image_files::Decoded> read_image_file(const std::string& path,
                                             const cameras::CalibratedCamera& camera);

/// The camera of the upright images of these files: of the first that can be read and has a size of
/// the camera. Fails where none has, where all have more than 8 bits a channel, and where
/// their orientations differ. Reads the first files only; no file is the camera as it is.
Result<cameras::CalibratedCamera> camera_of_files(const std::vector<std::string>& paths,
                                                  const cameras::CalibratedCamera& camera);

}  // namespace weft::images
