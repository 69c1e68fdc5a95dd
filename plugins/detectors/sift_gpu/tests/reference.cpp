// SPDX-License-Identifier: Apache-2.0
#include "reference.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>

namespace weft::sift_gpu::reference {
namespace {

constexpr int kBorder = 5;
constexpr int kMostSteps = 5;
constexpr double kCameraBlurPx = 0.5;

/// The place of sample i of a signal that is mirrored at its outermost samples, and so periodic.
int mirrored(int i, int length) {
  const int period = std::max(1, 2 * length - 2);
  const int place = ((i % period) + period) % period;
  return std::min(place, period - place);
}

/// Radius of a Gaussian of about four sigmas to each side.
int radius_of(double sigma_px) {
  return (static_cast<int>(std::lrint(8.0 * sigma_px + 1.0)) | 1) / 2;
}

Plane blurred(const Plane& image, double sigma_px) {
  const Eigen::VectorXd weights = gaussian(sigma_px, radius_of(sigma_px));
  return convolved(image, weights, weights);
}

/// Differences of neighbouring layers, grey levels 0 to 1, with their derivatives by (x, y, layer).
class Differences {
 public:
  explicit Differences(const std::vector<Plane>& layers) {
    for (std::size_t i = 1; i < layers.size(); ++i) {
      planes_.push_back((layers[i] - layers[i - 1]) / 255.0);
    }
  }

  double operator()(const Eigen::Vector3i& at) const {
    return planes_[to_index(at.z())](at.y(), at.x());
  }

  bool is_extremum(const Eigen::Vector3i& at) const {
    const double value = (*this)(at);
    bool largest = true, smallest = true;
    for (int l = -1; l <= 1; ++l) {
      const auto& plane = planes_[to_index(at.z() + l)];
      const auto around = plane.block<3, 3>(at.y() - 1, at.x() - 1);
      largest = largest && around.maxCoeff() <= value;
      smallest = smallest && around.minCoeff() >= value;
    }
    return value > 0.0 ? largest : smallest;
  }

  Eigen::Vector3d gradient(const Eigen::Vector3i& at) const {
    Eigen::Vector3d g;
    for (int a = 0; a < 3; ++a) {
      g[a] = ((*this)(at + Eigen::Vector3i::Unit(a)) - (*this)(at - Eigen::Vector3i::Unit(a))) / 2;
    }
    return g;
  }

  Eigen::Matrix3d hessian(const Eigen::Vector3i& at) const {
    Eigen::Matrix3d h;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        const Eigen::Vector3i i = Eigen::Vector3i::Unit(a), j = Eigen::Vector3i::Unit(b);
        h(a, b) = a == b ? (*this)(at + i) - 2.0 * (*this)(at) + (*this)(at - i)
                         : ((*this)(at + i + j) - (*this)(at + i - j) - (*this)(at - i + j) +
                            (*this)(at - i - j)) /
                               4.0;
      }
    }
    return h;
  }

 private:
  std::vector<Plane> planes_;
};

/// Lowe's section 4: moves to where the expansion is stationary, and requires contrast and a second
/// large curvature. Empty if it fails.
std::vector<Extremum> refined(const Differences& d, Eigen::Vector3i at, Eigen::Vector3i size,
                              const Settings& settings) {
  for (int step = 0; step < kMostSteps; ++step) {
    const Eigen::Vector3d g = d.gradient(at);
    const Eigen::Matrix3d h = d.hessian(at);
    const Eigen::FullPivLU<Eigen::Matrix3d> solver(h);
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // a flat direction has no better place
    if (solver.isInvertible()) offset = solver.solve(-g);
    if ((offset.array().abs() < 0.5).all()) {
      const double response = std::abs(d(at) + 0.5 * g.dot(offset));
      const double trace = h(0, 0) + h(1, 1), determinant = h.topLeftCorner<2, 2>().determinant();
      const double r = settings.edge_threshold;
      if (response < settings.contrast_threshold / settings.octave_layers || determinant <= 0.0 ||
          trace * trace / determinant >= (r + 1.0) * (r + 1.0) / r) {
        return {};
      }
      const Eigen::Vector3d place = at.cast<double>() + offset;
      const double scale = settings.sigma_px * std::exp2(place.z() / settings.octave_layers);
      return {{place.x(), place.y(), scale, response, at.z()}};
    }
    if (!((offset.array().abs() < 1e6).all())) return {};
    at += offset.array().rint().cast<int>().matrix();
    if ((at.array() < Eigen::Array3i(kBorder, kBorder, 1)).any() ||
        (at.array() >= size.array() - Eigen::Array3i(kBorder, kBorder, 1)).any()) {
      return {};
    }
  }
  return {};
}

}  // namespace

Plane plane_of(const float* values, int width, int height) {
  using Floats = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const Floats>(values, height, width).cast<double>();
}

std::vector<float> floats_of(const Plane& plane) {
  std::vector<float> values;
  for (const double value : plane.reshaped<Eigen::RowMajor>()) {
    values.push_back(static_cast<float>(value));
  }
  return values;
}

Plane rounded(const Plane& plane) { return plane.cast<float>().cast<double>(); }

Plane doubled(const Plane& image) {
  Plane result(2 * image.rows(), 2 * image.cols());
  const auto last_x = static_cast<int>(image.cols()) - 1;
  const auto last_y = static_cast<int>(image.rows()) - 1;
  for (int y = 0; y < result.rows(); ++y) {
    for (int x = 0; x < result.cols(); ++x) {
      const double u = std::clamp((x + 0.5) / 2.0 - 0.5, 0.0, static_cast<double>(last_x));
      const double v = std::clamp((y + 0.5) / 2.0 - 0.5, 0.0, static_cast<double>(last_y));
      double sum = 0.0;
      for (int j = static_cast<int>(v); j <= std::min(static_cast<int>(v) + 1, last_y); ++j) {
        for (int i = static_cast<int>(u); i <= std::min(static_cast<int>(u) + 1, last_x); ++i) {
          sum += share(u - i) * share(v - j) * image(j, i);
        }
      }
      result(y, x) = sum;
    }
  }
  return result;
}

Plane halved(const Plane& image) {
  Plane result(image.rows() / 2, image.cols() / 2);
  for (Eigen::Index y = 0; y < result.rows(); ++y) {
    for (Eigen::Index x = 0; x < result.cols(); ++x) result(y, x) = image(2 * y, 2 * x);
  }
  return result;
}

Eigen::VectorXd gaussian(double sigma_px, int radius) {
  const Eigen::ArrayXd i = Eigen::ArrayXd::LinSpaced(2 * radius + 1, -radius, radius);
  const Eigen::ArrayXd weights = (-0.5 * (i / sigma_px).square()).exp();
  return weights / weights.sum();
}

Plane convolved(const Plane& image, const Eigen::VectorXd& column, const Eigen::VectorXd& row) {
  const auto width = static_cast<int>(image.cols()), height = static_cast<int>(image.rows());
  const auto across = static_cast<int>(row.size()) / 2, down = static_cast<int>(column.size()) / 2;
  Plane extended(height + 2 * down, width + 2 * across);
  for (int y = 0; y < extended.rows(); ++y) {
    for (int x = 0; x < extended.cols(); ++x) {
      extended(y, x) = image(mirrored(y - down, height), mirrored(x - across, width));
    }
  }
  Plane sum = Plane::Zero(height, width);
  for (int i = 0; i < column.size(); ++i) {
    for (int j = 0; j < row.size(); ++j) {
      sum += column[i] * row[j] * extended.block(i, j, height, width);
    }
  }
  return sum;
}

std::vector<std::vector<Plane>> pyramid(const Plane& image, const Settings& settings) {
  std::vector<std::vector<Plane>> octaves;
  Plane first = settings.upsample ? doubled(image) : image;
  const double had_px = settings.upsample ? 2.0 * kCameraBlurPx : kCameraBlurPx;
  const double wanted = settings.sigma_px * settings.sigma_px - had_px * had_px;
  first = blurred(first, std::sqrt(std::max(wanted, 0.01)));
  const long count =
      std::lrint(std::log2(static_cast<double>(std::min(first.rows(), first.cols()))) - 1.0);
  for (long o = 0; o < count; ++o) {
    std::vector<Plane>& layers = octaves.emplace_back();
    layers.push_back(first);
    for (int l = 1; l < settings.octave_layers + 3; ++l) {
      const double before = settings.sigma_px * std::exp2((l - 1.0) / settings.octave_layers);
      const double after = settings.sigma_px * std::exp2(1.0 * l / settings.octave_layers);
      layers.push_back(blurred(layers.back(), std::sqrt(after * after - before * before)));
    }
    first = halved(layers[to_index(settings.octave_layers)]);
  }
  return octaves;
}

std::vector<Extremum> extrema(const std::vector<Plane>& layers, const Settings& settings) {
  const Differences d(layers);
  const Eigen::Vector3i size(static_cast<int>(layers.front().cols()),
                             static_cast<int>(layers.front().rows()), settings.octave_layers + 2);
  const double weakest =
      std::floor(255.0 * 0.5 * settings.contrast_threshold / settings.octave_layers) / 255.0;
  std::vector<Extremum> found;
  for (int layer = 1; layer <= settings.octave_layers; ++layer) {
    for (int y = kBorder; y < size.y() - kBorder; ++y) {
      for (int x = kBorder; x < size.x() - kBorder; ++x) {
        const Eigen::Vector3i at(x, y, layer);
        if (std::abs(d(at)) <= weakest || !d.is_extremum(at)) continue;
        const std::vector<Extremum> one = refined(d, at, size, settings);
        found.insert(found.end(), one.begin(), one.end());
      }
    }
  }
  return found;
}

}  // namespace weft::sift_gpu::reference
