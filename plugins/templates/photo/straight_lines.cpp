// SPDX-License-Identifier: Apache-2.0
#include "straight_lines.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <tuple>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::photo {
namespace {

struct Segment {
  Eigen::Vector2d from, to;

  double length_px() const { return (to - from).norm(); }
};

/// True if the pixel at a place is not 0; false beside the mask.
bool is_set(const cv::Mat& mask, const Eigen::Vector2d& place) {
  const auto x = std::lround(place.x()), y = std::lround(place.y());
  return x >= 0 && y >= 0 && x < mask.cols && y < mask.rows &&
         mask.at<std::uint8_t>(static_cast<int>(y), static_cast<int>(x)) != 0;
}

/// From the longest to the shortest.
std::vector<Segment> find_segments(const cv::Mat& picture, const cv::Mat& inner) {
  constexpr double kLocal_px = 8.0, kGain = 4.0, kLeast_px = 8.0;
  const auto detector = cv::createLineSegmentDetector();
  std::vector<cv::Mat> channels;
  cv::split(picture, channels);
  std::vector<Segment> segments;
  for (const cv::Mat& channel : channels) {
    ask_to_go_on();
    cv::Mat local, raised;
    cv::GaussianBlur(channel, local, {}, kLocal_px);
    cv::addWeighted(channel, kGain, local, -kGain, 128.0, raised);
    std::vector<cv::Vec4f> found;
    detector->detect(raised, found);
    for (const cv::Vec4f& ends : found) {
      const Segment segment{{ends[0], ends[1]}, {ends[2], ends[3]}};
      const Eigen::Vector2d middle = 0.5 * (segment.from + segment.to);
      if (segment.length_px() >= kLeast_px && is_set(inner, middle)) segments.push_back(segment);
    }
  }
  std::sort(segments.begin(), segments.end(), [](const Segment& a, const Segment& b) {
    return std::tuple(-a.length_px(), a.from.x(), a.from.y(), a.to.x(), a.to.y()) <
           std::tuple(-b.length_px(), b.from.x(), b.from.y(), b.to.x(), b.to.y());
  });
  return segments;
}

/// The line with the least squares of distances from all points of the segments.
StraightLine fitted(const std::vector<const Segment*>& segments) {
  double length = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Segment* each : segments) {
    length += each->length_px();
    sum += each->length_px() * 0.5 * (each->from + each->to);
  }
  StraightLine line;
  line.point = sum / length;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Segment* each : segments) {
    const Eigen::Vector2d off = 0.5 * (each->from + each->to) - line.point;
    const Eigen::Vector2d way = each->to - each->from;
    spread += each->length_px() * (off * off.transpose() + way * way.transpose() / 12.0);
  }
  line.direction = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvectors().col(1);
  return line;
}

bool lies_on(const Segment& segment, const StraightLine& line) {
  constexpr double kBeside_px = 2.5, kLeastCosine = 0.985;  // ten degrees
  const Eigen::Vector2d normal(-line.direction.y(), line.direction.x());
  const auto is_near = [&](const Eigen::Vector2d& place) {
    return std::abs((place - line.point).dot(normal)) <= kBeside_px;
  };
  return is_near(segment.from) && is_near(segment.to) &&
         std::abs((segment.to - segment.from).dot(line.direction)) >=
             kLeastCosine * segment.length_px();
}

/// Sets the stretches to those of the segments; short gaps between them are no gaps.
void set_stretches(StraightLine& line, const std::vector<const Segment*>& segments) {
  constexpr double kGap_px = 4.0;
  std::vector<Eigen::Vector2d> all;
  for (const Segment* each : segments) {
    const auto [begin, end] = std::minmax({line.along(each->from), line.along(each->to)});
    all.emplace_back(begin, end);
  }
  std::sort(all.begin(), all.end(),
            [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() < b.x(); });
  for (const Eigen::Vector2d& each : all) {
    if (!line.stretches.empty() && each.x() <= line.stretches.back().y() + kGap_px) {
      line.stretches.back().y() = std::max(line.stretches.back().y(), each.y());
    } else {
      line.stretches.push_back(each);
    }
  }
}

/// Which of the four ranges of 45 degrees a direction is in, either way along it.
std::size_t eighth_turn(const Eigen::Vector2d& direction) {
  const double turn_rad = std::atan2(direction.y(), direction.x()) + M_PI;  // 0 to 2 pi
  return static_cast<std::size_t>(turn_rad / (0.25 * M_PI)) % 4;
}

/// The line through a segment and all others that lie on it, which are taken out of `left`.
StraightLine joined(const Segment& seed, std::vector<const Segment*>& left) {
  constexpr int kRounds = 4;
  std::vector<const Segment*> members{&seed};
  StraightLine line = fitted(members);
  for (int round = 0; round < kRounds; ++round) {
    worked(static_cast<std::int64_t>(left.size()));
    members = {&seed};
    for (const Segment* each : left) {
      if (each != &seed && lies_on(*each, line)) members.push_back(each);
    }
    line = fitted(members);
  }
  set_stretches(line, members);
  std::erase_if(left, [&](const Segment* each) {
    return std::find(members.begin(), members.end(), each) != members.end();
  });
  return line;
}

}  // namespace

double StraightLine::weight_px() const {
  double squares = 0.0;
  for (const Eigen::Vector2d& each : stretches) squares += std::pow(each.y() - each.x(), 2);
  return std::sqrt(squares);
}

double StraightLine::covered(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  const auto [begin, end] = std::minmax({along(from), along(to)});
  double length = 0.0;
  for (const Eigen::Vector2d& each : stretches) {
    length += std::max(0.0, std::min(end, each.y()) - std::max(begin, each.x()));
  }
  return length / std::max(end - begin, 1e-9);
}

std::vector<StraightLine> straight_lines(const cv::Mat& picture, const cv::Mat& seen,
                                         std::size_t most) {
  constexpr double kLeastSeed_px = 20.0;
  constexpr std::size_t kMostSeeds = 400;
  cv::Mat inner;  // the border of the visible part is an edge, too
  const cv::Mat square = cv::getStructuringElement(cv::MORPH_RECT, {9, 9});
  cv::erode(seen, inner, square);
  const std::vector<Segment> segments = find_segments(picture, inner);
  std::vector<const Segment*> left;
  left.reserve(segments.size());
  for (const Segment& each : segments) left.push_back(&each);
  std::vector<StraightLine> lines;
  while (!left.empty() && lines.size() < kMostSeeds && left.front()->length_px() >= kLeastSeed_px) {
    lines.push_back(joined(*left.front(), left));
  }
  std::stable_sort(lines.begin(), lines.end(), [](const StraightLine& a, const StraightLine& b) {
    return a.weight_px() > b.weight_px();
  });
  std::array<std::size_t, 4> alike{};  // by direction
  std::erase_if(lines, [&](const StraightLine& line) {
    return ++alike[eighth_turn(line.direction)] > most / 2;
  });
  if (lines.size() > most) lines.resize(most);
  return lines;
}

}  // namespace weft::photo
