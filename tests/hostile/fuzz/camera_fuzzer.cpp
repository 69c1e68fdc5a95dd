// SPDX-License-Identifier: Apache-2.0
// Camera files: refused at a place inside the file, or a camera that another file describes alike.
#include <cmath>
#include <sstream>
#include <weft/geometry/camera_check.hpp>

#include "common/cameras/camera_file.hpp"
#include "fuzzing.hpp"

namespace {

using namespace weft;
using cameras::CameraFile;
using cameras::Distortion;
using fuzzing::require;

std::string printed(const CameraFile& file) {
  std::ostringstream text;
  text.precision(17);
  const Camera& camera = file.camera;
  text << "{fx: " << camera.fx << ", fy: " << camera.fy << ", cx: " << camera.cx
       << ", cy: " << camera.cy << ", width: " << camera.width_px
       << ", height: " << camera.height_px
       << ", distortion: {model: " << (file.model == Distortion::fisheye ? "fisheye" : "brown")
       << ", coefficients: [";
  for (std::size_t i = 0; i < file.coefficients.size(); ++i) {
    text << (i > 0 ? ", " : "") << file.coefficients[i];
  }
  text << "]}}\n";
  return text.str();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzzing::text_of(data, size);
  const fuzzing::InputFile input(text);
  const auto file = cameras::read_camera_file(input.path());
  if (!file) {
    const Error& error = file.error();
    require(error.code == Errc::syntax || error.code == Errc::invalid_data, "a code of mistakes",
            error.message);
    const auto sentence = fuzzing::require_place(error.message, input.path(), text);
    require(sentence.starts_with(": ") && sentence.size() > 2, "a sentence", error.message);
    return 0;
  }
  require(!camera_mistake(file->camera), "a camera that can be");
  const std::size_t count = file->coefficients.size();
  if (file->model == Distortion::fisheye) require(count == 4, "four coefficients");
  if (file->model == Distortion::brown) require(count == 5 || count == 8, "five or eight");
  for (const double k : file->coefficients) require(std::isfinite(k), "finite coefficients");
  const std::string second = printed(*file);
  const fuzzing::InputFile copy(second);
  const auto again = cameras::read_camera_file(copy.path());
  require(static_cast<bool>(again), "what is printed can be read", second);
  require(again->model == file->model, "the same model", second);
  require(again->coefficients == file->coefficients, "the same coefficients", second);
  require(again->camera.fx == file->camera.fx && again->camera.fy == file->camera.fy &&
              again->camera.cx == file->camera.cx && again->camera.cy == file->camera.cy &&
              again->camera.width_px == file->camera.width_px &&
              again->camera.height_px == file->camera.height_px,
          "the same camera", second);
  return 0;
}
