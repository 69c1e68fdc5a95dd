// SPDX-License-Identifier: Apache-2.0
// embed PIPELINE: reads images of 640 x 480 px, BGR, from standard input.
#include <iostream>
#include <weft/embedding/pipeline.hpp>

int main(int count, char** arguments) {
  if (count != 2) {
    std::cerr << "usage: embed PIPELINE <IMAGES, each 640 x 480 pixels of 3 bytes, BGR\n";
    return 2;
  }
  const weft::Camera camera{820.0, 820.0, 319.5, 239.5, 640, 480};
  auto pipeline = weft::Pipeline::load(arguments[1], camera, {.plugin_path = {WEFT_PLUGINS}});
  if (!pipeline) {
    std::cerr << pipeline.error().where << ": " << pipeline.error().message << '\n';
    return 2;
  }
  weft::Image image{weft::Array<std::uint8_t>({camera.height_px, camera.width_px, 3}), "camera"};
  auto* const bytes = reinterpret_cast<char*>(image.pixels.data());
  for (int n = 0; std::cin.read(bytes, image.pixels.size()); ++n) {
    const auto frame = pipeline->process(image, n / 30.0);
    if (frame) std::cout << frame->report << '\n';
  }
}
