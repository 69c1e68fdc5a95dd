// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <weft/core/whole_file.hpp>

#include "cli/calibrate/program/program.hpp"
#include "cli/output/new_file.hpp"
#include "cli/output/outcome.hpp"
#include "lab/calibration/board.hpp"
#include "lab/calibration/board_recognition.hpp"
#include "lab/calibration/camera_text.hpp"
#include "lab/calibration/frame_reader.hpp"
#include "lab/calibration/refusal.hpp"
#include "lab/calibration/residual_picture.hpp"

namespace weft::cli {
namespace {

namespace cal = calibration;

struct CameraOptions {
  BoardOptions board;
  std::vector<std::string> files;
  std::optional<int> camera;
  int distortion = 4;
  std::string out;
  bool overwrite = false;
};

// A signal handler can reach nothing but objects with static storage.
std::atomic<bool> enough{false};

/// Views of a camera that shows one frame after the other, until nothing is missing or the user
/// ends it.
Result<void> watch(cal::FrameReader& reader, cal::ViewCollection& collection) {
  constexpr std::size_t kEnoughViews = 20;
  std::signal(SIGINT, [](int) { enough = true; });
  fmt::print("Show the board in all parts of the image, turned to all sides; Ctrl-C ends it.\n");
  std::string asked;
  while (!enough) {
    const auto frame = reader.next();
    if (!frame) return frame.error();
    if (!*frame) return Error{Errc::io, "the camera gives no more frames: is it still connected?"};
    const auto kept = collection.add_if_new(**frame);
    if (!kept) return kept.error();
    if (!*kept && !asked.empty()) continue;
    const auto missing = cal::coverage_of(collection.views(), collection.size()).missing();
    if (missing.empty() && collection.views().size() >= kEnoughViews) return {};
    asked = missing.empty() ? "more views that are unlike these" : missing.front();
    fmt::print("{} views; {}\n", collection.views().size(), asked);
    std::fflush(stdout);
  }
  return {};
}

Result<void> read_all(cal::FrameReader& reader, cal::ViewCollection& collection) {
  for (int turned = 0;;) {
    const auto frame = reader.next();
    if (!frame) return frame.error();
    if (!*frame && turned > 0) {
      fmt::print("{} images have an orientation; all are read as the sensor stores them\n", turned);
    }
    if (!*frame) return {};
    turned += (*frame)->orientation == 1 ? 0 : 1;
    if (auto added = collection.add(**frame); !added) return added;
  }
}

Result<void> collect(const CameraOptions& options, cal::ViewCollection& collection) {
  auto reader = options.camera ? cal::open_camera(*options.camera) : cal::open_files(options.files);
  if (!reader) return reader.error();
  return options.camera ? watch(**reader, collection) : read_all(**reader, collection);
}

/// The path of the image of the residuals, beside the camera file.
std::string picture_path(const std::string& out) {
  const std::filesystem::path path(out);
  return (path.parent_path() / (path.stem().string() + "_residuals.png")).string();
}

Result<void> check_options(const CameraOptions& options) {
  if (options.files.empty() == !options.camera) {
    return Error{Errc::invalid_value, "give images, a video or --camera N, one of them"};
  }
  if (options.out.empty()) {
    return Error{Errc::invalid_value, "is missing: give the path of the camera file to write",
                 "--out"};
  }
  for (const int known : {0, 4, 5, 8}) {
    if (options.distortion != known) continue;
    for (const std::string& file : {options.out, picture_path(options.out)}) {
      if (auto fresh = check_new_file(file, options.overwrite); !fresh) return fresh;
    }
    return {};
  }
  return Error{Errc::invalid_value,
               fmt::format("is {}: 0 is none, 4 are k1 k2 p1 p2, 5 and k3, 8 and k4 k5 k6",
                           options.distortion),
               "--distortion"};
}

Result<void> write_files(const cal::Calibration& calibration, const std::string& out) {
  const auto picture = cal::residual_picture(calibration);
  if (!picture) return picture.error();
  if (auto written = write_whole(*picture, picture_path(out)); !written) return written;
  return write_whole(cal::camera_text(calibration), out);
}

Result<void> calibrate(const CameraOptions& options) {
  if (auto checked = check_options(options); !checked) return checked;
  const auto board = board_of(options.board);
  if (!board) return board.error();
  cal::ViewCollection collection(*board);
  if (auto collected = collect(options, collection); !collected) return collected;
  const auto calibration =
      cal::calibrate(collection.views(), collection.size(), options.distortion);
  fmt::print("{} of {} images show the board\n{}", collection.views().size(), collection.frames(),
             without_text(collection.without()));
  if (!calibration) {
    if (!collection.views().empty()) {
      fmt::print("{}", coverage_text(cal::coverage_of(collection.views(), collection.size())));
    }
    if (collection.views().empty()) {
      if (const auto other = cal::other_board(*board, collection.unexplained())) {
        return no_result(*other);
      }
    }
    return calibration.error();
  }
  if (auto written = write_files(*calibration, options.out); !written) return written;
  fmt::print("{}{}{}\n{}\n", calibration_text(*calibration), coverage_text(calibration->coverage),
             options.out, picture_path(options.out));
  return {};
}

}  // namespace

std::function<int()> add_camera_options(CLI::App& app) {
  const auto options = std::make_shared<CameraOptions>();
  app.add_option("FILES", options->files, "Images of the board, or one video")->type_name("");
  app.add_option("--camera", options->camera, "Take the images from the camera /dev/videoN")
      ->option_text("N")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--out", options->out,
                 "The camera file; the image of residuals is written beside it")
      ->option_text("FILE");
  add_board_options(app, options->board);
  app.add_option("--distortion", options->distortion,
                 "Numbers of the lens: 0, 4 (k1 k2 p1 p2), 5 (and k3) or 8 (and k4 k5 k6)")
      ->option_text("COUNT [4]");
  add_overwrite(app, options->overwrite);
  return [options] {
    const auto done = calibrate(*options);
    if (done) return kDone;
    print_error(done.error());
    return exit_code_of(done.error());
  };
}

}  // namespace weft::cli
