// SPDX-License-Identifier: Apache-2.0
#include "backdrop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/core/stop_check.hpp>

#include "common/scene/random_stream.hpp"
#include "common/scene/value_noise.hpp"

namespace weft::frex {
namespace {

using scene::Colour;
using scene::random_stream;

constexpr std::uint64_t kBackdropStream = 3;

Picture blank(const Camera& camera) {
  Picture picture{static_cast<int>(camera.width_px), static_cast<int>(camera.height_px)};
  picture.pixels.resize(to_index(camera.width_px * camera.height_px), Colour::Zero());
  return picture;
}

cv::Mat view_of(Picture& picture) {
  return {picture.height, picture.width, CV_32FC4, picture.pixels.data()};
}

cv::Scalar to_scalar(const Colour& colour) { return {colour[0], colour[1], colour[2], 0.0}; }

Colour muted_colour(Rng& rng) {
  const double grey = rng.uniform(35.0, 225.0), tint = 38.0;
  Colour colour = Colour::Zero();
  for (int k = 0; k < 3; ++k) {
    colour[k] = static_cast<float>(std::clamp(grey + rng.uniform(-tint, tint), 0.0, 250.0));
  }
  return colour;
}

/// Wood in warm light: soft clouds and a little grain along x.
void paint_table(Picture& picture, Rng& rng) {
  const double size = picture.height;
  const scene::ValueNoise clouds(picture.width, size, 0.45 * size, rng);
  const scene::ValueNoise grain(0.12 * picture.width, size, 0.02 * size, rng);
  const Colour wood(96.0F, 128.0F, 156.0F, 0.0F);
  for (int y = 0; y < picture.height; ++y) {
    ask_to_go_on();
    for (int x = 0; x < picture.width; ++x) {
      const double light = 1.0 + 0.16 * clouds(x, y) + 0.05 * grain(0.12 * x, y) - 0.12 * y / size;
      picture.pixels[to_index(y) * to_index(picture.width) + to_index(x)] =
          static_cast<float>(light) * wood;
    }
  }
}

/// A thing on the table in its own axes, scaled, turned and moved.
class Placement {
 public:
  Placement(const Picture& picture, Rng& rng)
      : x_(rng.uniform(0.0, picture.width)),
        y_(rng.uniform(0.0, picture.height)),
        unit_px_(picture.height / 480.0),
        turn_rad_(rng.uniform(0.0, 2.0 * M_PI)) {}

  /// Fixed-point pixels with kShift binary digits.
  static constexpr int kShift = 4;
  cv::Point at(double x, double y) const {
    const double c = std::cos(turn_rad_), s = std::sin(turn_rad_), scale = 1 << kShift;
    return {static_cast<int>(std::lround(scale * (x_ + unit_px_ * (c * x - s * y)))),
            static_cast<int>(std::lround(scale * (y_ + unit_px_ * (s * x + c * y))))};
  }
  int px(double length) const {
    return std::max(1, static_cast<int>(std::lround(length * unit_px_)));
  }
  int fixed(double length) const {
    return static_cast<int>(std::lround(length * unit_px_ * (1 << kShift)));
  }

 private:
  double x_, y_, unit_px_, turn_rad_;
};

void draw_box(cv::Mat& image, const Placement& on, double x0, double y0, double x1, double y1,
              const Colour& colour) {
  const std::array<cv::Point, 4> corners{on.at(x0, y0), on.at(x1, y0), on.at(x1, y1),
                                         on.at(x0, y1)};
  cv::fillConvexPoly(image, corners.data(), 4, to_scalar(colour), cv::LINE_AA, Placement::kShift);
}

/// A page or a book cover with lines of words.
void draw_page(cv::Mat& image, const Placement& on, Rng& rng) {
  const double width = rng.uniform(50.0, 150.0), height = rng.uniform(50.0, 120.0);
  const Colour paper = muted_colour(rng);
  const Colour ink = paper.mean() > 90.0F ? Colour(0.25F * paper) : Colour(255.0F - paper);
  draw_box(image, on, 3.0, 3.0, width + 3.0, height + 3.0, Colour::Constant(30.0F));
  draw_box(image, on, 0.0, 0.0, width, height, paper);
  const double line = rng.uniform(5.0, 11.0);
  double y = line;
  while (y + line < height) {
    double x = 8.0;
    while (x < width - 10.0) {
      const double word = std::min(rng.uniform(0.8, 5.0) * line, width - 6.0 - x);
      if (rng.below(8) != 0) draw_box(image, on, x, y, x + word, y + 0.6 * line, ink);
      x += word + 0.8 * line;
    }
    y += 1.7 * line;
  }
}

void draw_pen(cv::Mat& image, const Placement& on, Rng& rng) {
  const double length = rng.uniform(60.0, 140.0), radius = rng.uniform(2.0, 5.0);
  const Colour body = muted_colour(rng), cap = muted_colour(rng);
  draw_box(image, on, 2.0, -radius + 2.0, length + 2.0, radius + 2.0, Colour::Constant(35.0F));
  draw_box(image, on, 0.0, -radius, length, radius, body);
  draw_box(image, on, 0.0, -radius, 0.3 * length, radius, cap);
  draw_box(image, on, 0.32 * length, -0.5 * radius, 0.95 * length, -0.1 * radius,
           Colour(0.5F * body + 120.0F));
}

void draw_coin(cv::Mat& image, const Placement& on, Rng& rng) {
  const double radius = rng.uniform(6.0, 18.0);
  const Colour metal = muted_colour(rng);
  const auto disc = [&](double offset, double size, const Colour& colour) {
    cv::circle(image, on.at(offset, offset), on.fixed(size), to_scalar(colour), cv::FILLED,
               cv::LINE_AA, Placement::kShift);
  };
  disc(1.5, radius, Colour::Constant(35.0F));
  disc(0.0, radius, metal);
  disc(0.0, 0.8 * radius, 0.8F * metal);
  for (int k = 0; k < 5; ++k) {
    const double x = rng.uniform(-0.5, 0.4) * radius, y = rng.uniform(-0.5, 0.4) * radius;
    draw_box(image, on, x, y, x + 0.3 * radius, y + 0.15 * radius, Colour(0.4F * metal));
  }
}

/// A copy of the texture on a wall: centre, size of a texel and rotation.
struct Poster {
  double x, y, pitch_px, cosine, sine;
};

void hang(Picture& wall, const scene::MipTexture& print, const Poster& poster, float light) {
  const double half_u = 0.5 * print.width(), half_v = 0.5 * print.height();
  const double reach = poster.pitch_px * std::hypot(half_u, half_v) + 1.0;
  const auto from = [](double value) { return std::max(0, static_cast<int>(value)); };
  for (int y = from(poster.y - reach); y < std::min<double>(wall.height, poster.y + reach); ++y) {
    ask_to_go_on();
    for (int x = from(poster.x - reach); x < std::min<double>(wall.width, poster.x + reach); ++x) {
      const double dx = (x - poster.x) / poster.pitch_px, dy = (y - poster.y) / poster.pitch_px;
      const double u = poster.cosine * dx + poster.sine * dy;
      const double v = -poster.sine * dx + poster.cosine * dy;
      // Covered by distance to the border, in px of the image.
      const double inside = poster.pitch_px * std::min(half_u - std::abs(u), half_v - std::abs(v));
      const auto coverage = static_cast<float>(std::clamp(inside + 0.5, 0.0, 1.0));
      if (coverage <= 0.0F) continue;
      const Colour paper = light * print.sample(static_cast<float>(u + half_u - 0.5),
                                                static_cast<float>(v + half_v - 0.5),
                                                static_cast<float>(1.0 / poster.pitch_px));
      Colour& pixel = wall.pixels[to_index(y) * to_index(wall.width) + to_index(x)];
      pixel += coverage * (paper - pixel);
    }
  }
}

}  // namespace

Picture plain_backdrop(const Camera& camera, std::uint64_t seed) {
  Rng rng = random_stream(seed, kBackdropStream);
  Picture picture = blank(camera);
  paint_table(picture, rng);
  return picture;
}

Picture cluttered_backdrop(const Camera& camera, std::uint64_t seed) {
  Rng rng = random_stream(seed, kBackdropStream);
  Picture picture = blank(camera);
  paint_table(picture, rng);
  cv::Mat image = view_of(picture);
  constexpr int kThings = 150;
  for (int k = 0; k < kThings; ++k) {
    const Placement on(picture, rng);
    const std::uint32_t kind = rng.below(4);
    if (kind < 2) draw_page(image, on, rng);
    if (kind == 2) draw_pen(image, on, rng);
    if (kind == 3) draw_coin(image, on, rng);
  }
  cv::GaussianBlur(image, image, {5, 5}, 0.6);
  return picture;
}

Picture look_alike_backdrop(const Camera& camera, const scene::MipTexture& print, double pitch_px,
                            std::uint64_t seed) {
  Rng rng = random_stream(seed, kBackdropStream);
  Picture wall = blank(camera);
  const scene::ValueNoise clouds(wall.width, wall.height, 0.5 * wall.height, rng);
  for (int y = 0; y < wall.height; ++y) {
    ask_to_go_on();
    for (int x = 0; x < wall.width; ++x) {
      const auto light = static_cast<float>(1.0 + 0.1 * clouds(x, y));
      wall.pixels[to_index(y) * to_index(wall.width) + to_index(x)] =
          light * Colour(168.0F, 172.0F, 176.0F, 0.0F);
    }
  }
  const double step_x = 1.12 * pitch_px * print.width(), step_y = 1.16 * pitch_px * print.height();
  const int most_x = static_cast<int>(0.5 * wall.width / step_x) + 1;
  const int most_y = static_cast<int>(0.5 * wall.height / step_y) + 1;
  for (int j = -most_y; j <= most_y; ++j) {
    for (int i = -most_x; i <= most_x; ++i) {
      const double turn = rng.uniform(-0.06, 0.06), size = pitch_px * rng.uniform(0.92, 1.04);
      const double x = 0.5 * wall.width + (i + 0.5 * (j % 2 == 0 ? 0 : 1)) * step_x;
      const double y = 0.5 * wall.height + j * step_y;
      const Poster poster{x + rng.uniform(-4.0, 4.0), y + rng.uniform(-4.0, 4.0), size,
                          std::cos(turn), std::sin(turn)};
      hang(wall, print, poster, static_cast<float>(rng.uniform(0.75, 1.0)));
    }
  }
  return wall;
}

Picture picture_backdrop(const Camera& camera, const scene::MipTexture& picture) {
  Picture wall = blank(camera);
  const double texels = std::min(static_cast<double>(picture.width()) / wall.width,
                                 static_cast<double>(picture.height()) / wall.height);
  const double u0 = 0.5 * (picture.width() - 1 - texels * (wall.width - 1));
  const double v0 = 0.5 * (picture.height() - 1 - texels * (wall.height - 1));
  std::size_t index = 0;
  for (int y = 0; y < wall.height; ++y) {
    ask_to_go_on();
    for (int x = 0; x < wall.width; ++x) {
      wall.pixels[index++] =
          picture.sample(static_cast<float>(u0 + texels * x), static_cast<float>(v0 + texels * y),
                         static_cast<float>(texels));
    }
  }
  return wall;
}

}  // namespace weft::frex
