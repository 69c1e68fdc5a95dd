// SPDX-License-Identifier: Apache-2.0
#include "chart_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::charts {
namespace {

/// The root of a vertex in a forest of connected vertices; shortens the way to it.
std::int32_t root_of(std::vector<std::int32_t>& parent, std::int32_t vertex) {
  while (parent[to_index(vertex)] != vertex) {
    parent[to_index(vertex)] = parent[to_index(parent[to_index(vertex)])];
    vertex = parent[to_index(vertex)];
  }
  return vertex;
}

/// The chosen rows of an array of up to three axes.
template <class T, class Index>
Array<T> rows_of(const Array<T>& values, const std::vector<Index>& rows) {
  const auto count = static_cast<std::int64_t>(rows.size());
  Array<T> chosen = values.ndim() == 1   ? Array<T>({count})
                    : values.ndim() == 2 ? Array<T>({count, values.dim(1)})
                                         : Array<T>({count, values.dim(1), values.dim(2)});
  for (std::int64_t i = 0; i < count; ++i) {
    std::copy_n(values.row(rows[to_index(i)]), values.row_elements(), chosen.row(i));
  }
  return chosen;
}

/// Replaces the arrays with one row per match by the chosen rows.
struct ChooseRows {
  template <class T>
  void operator()(Array<T>& member, const Field& field) const {
    if (member.present() && field.shape[0] == 'N') member = rows_of(member, rows);
  }
  template <class Other>
  void operator()(Other& /*member*/, const Field& /*field*/) const {}

  const std::vector<std::int64_t>& rows;
};

/// A part of an image without a copy.
Array<std::uint8_t> window_of(const Array<std::uint8_t>& image, std::int64_t left, std::int64_t top,
                              std::int64_t width, std::int64_t height) {
  Array<std::uint8_t>::Shape shape = image.shape();
  shape[0] = height;
  shape[1] = width;
  return Array<std::uint8_t>::borrow(image.row(top) + left * image.dim(2), image.ndim(), shape,
                                     image.row_stride());
}

/// The revision of one chart of a template; unknown where that of the template is.
std::uint64_t revision_of_chart(std::uint64_t revision, int chart) {
  if (revision == 0) return 0;
  std::uint64_t mixed =
      revision + 0x9E3779B97F4A7C15U * (static_cast<std::uint64_t>(chart) + 0x636861727473U);
  mixed = (mixed ^ (mixed >> 30U)) * 0xBF58476D1CE4E5B9U;
  mixed = (mixed ^ (mixed >> 27U)) * 0x94D049BB133111EBU;
  mixed ^= mixed >> 31U;
  return mixed != 0 ? mixed : 1;
}

}  // namespace

void ChartParts::update(const Template& templ) {
  if (revision_ != 0 && templ.revision == revision_) return;
  revision_ = 0;
  connect(templ);
  for (Chart& chart : charts_) find_window(templ, chart);
  revision_ = templ.revision;
}

void ChartParts::connect(const Template& templ) {
  const std::int64_t face_count = templ.faces.rows();
  std::vector<std::int32_t> parent(to_index(templ.vertices_m.rows()));
  std::iota(parent.begin(), parent.end(), 0);
  for (std::int64_t f = 0; f < face_count; ++f) {
    worked_in_loop(f, 4);
    const std::int32_t root = root_of(parent, templ.faces(f, 0));
    for (const std::int64_t k : {1, 2}) {
      parent[to_index(root_of(parent, templ.faces(f, k)))] = root;
    }
  }
  charts_.clear();
  chart_of_face_.assign(to_index(face_count), -1);
  face_in_chart_.assign(to_index(face_count), 0);
  vertex_in_chart_.assign(parent.size(), 0);
  std::vector<int> chart_of_root(parent.size(), -1);
  std::vector<std::uint8_t> has_face(parent.size(), 0);
  for (std::int32_t f = 0; f < face_count; ++f) {
    worked_in_loop(f, 4);
    int& chart = chart_of_root[to_index(root_of(parent, templ.faces(f, 0)))];
    if (chart < 0) {
      chart = count();
      charts_.emplace_back();
    }
    chart_of_face_[to_index(f)] = chart;
    face_in_chart_[to_index(f)] = static_cast<std::int32_t>(charts_[to_index(chart)].faces.size());
    charts_[to_index(chart)].faces.push_back(f);
    for (const std::int64_t k : {0, 1, 2}) has_face[to_index(templ.faces(f, k))] = 1;
  }
  for (std::int32_t v = 0; v < templ.vertices_m.rows(); ++v) {
    if (has_face[to_index(v)] == 0) continue;
    Chart& chart = charts_[to_index(chart_of_root[to_index(root_of(parent, v))])];
    vertex_in_chart_[to_index(v)] = static_cast<std::int32_t>(chart.vertices.size());
    chart.vertices.push_back(v);
  }
}

void ChartParts::find_window(const Template& templ, Chart& chart) {
  const auto range = [&](std::int64_t axis, std::int64_t length, std::int64_t& first,
                         std::int64_t& extent) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const std::int32_t v : chart.vertices) {
      low = std::min(low, templ.flat_px(v, axis));
      high = std::max(high, templ.flat_px(v, axis));
    }
    const auto last = static_cast<double>(length - 1);
    first = static_cast<std::int64_t>(std::clamp(std::floor(low), 0.0, last));
    extent = static_cast<std::int64_t>(std::clamp(std::ceil(high), 0.0, last)) - first + 1;
  };
  range(0, templ.texture.dim(1), chart.left, chart.width);
  range(1, templ.texture.dim(0), chart.top, chart.height);
}

Template ChartParts::template_of(const Template& templ, int index) const {
  const Chart& chart = charts_[to_index(index)];
  Template part;
  part.vertices_m = rows_of(templ.vertices_m, chart.vertices);
  part.flat_px = rows_of(templ.flat_px, chart.vertices);
  for (std::int64_t v = 0; v < part.flat_px.rows(); ++v) {
    part.flat_px(v, 0) -= static_cast<double>(chart.left);
    part.flat_px(v, 1) -= static_cast<double>(chart.top);
  }
  part.faces = rows_of(templ.faces, chart.faces);
  for (std::int64_t f = 0; f < part.faces.rows(); ++f) {
    for (const std::int64_t k : {0, 1, 2}) {
      part.faces(f, k) = vertex_in_chart_[to_index(part.faces(f, k))];
    }
  }
  part.m_per_px = templ.m_per_px;
  part.texture = window_of(templ.texture, chart.left, chart.top, chart.width, chart.height);
  part.mask = window_of(templ.mask, chart.left, chart.top, chart.width, chart.height);
  part.revision = revision_of_chart(templ.revision, index);
  return part;
}

Correspondences ChartParts::matches_of(const Correspondences& matches, int index,
                                       const std::vector<std::int64_t>& rows) const {
  const Chart& chart = charts_[to_index(index)];
  Correspondences part = matches;
  Correspondences::fields(part, ChooseRows{rows});
  for (std::int64_t i = 0; i < part.count(); ++i) {
    part.template_px(i, 0) -= static_cast<double>(chart.left);
    part.template_px(i, 1) -= static_cast<double>(chart.top);
    part.face(i) = face_in_chart_[to_index(part.face(i))];
  }
  part.template_xy_m = {};  // measured from the whole texture
  part.diag = {};
  part.others = {};  // further arrays have the rows of all matches
  return part;
}

FilterInput ChartParts::part(const FilterInput& in, int chart,
                             const std::vector<std::int64_t>& rows) const {
  FilterInput part{in.call};
  part.correspondences = matches_of(in.correspondences, chart, rows);
  part.templ = template_of(*in.templ, chart);
  part.camera = in.camera;
  if (!in.previous_shape || in.previous_shape->vertices_m.rows() != in.templ->vertices_m.rows()) {
    return part;
  }
  const std::vector<std::int32_t>& vertices = charts_[to_index(chart)].vertices;
  Shape shape;
  shape.vertices_m = rows_of(in.previous_shape->vertices_m, vertices);
  shape.source = rows_of(in.previous_shape->source, vertices);
  if (in.previous_shape->covariance_m2.present()) {
    shape.covariance_m2 = rows_of(in.previous_shape->covariance_m2, vertices);
  }
  shape.state = in.previous_shape->state;
  shape.age_frames = in.previous_shape->age_frames;
  shape.confidence = in.previous_shape->confidence;
  part.previous_shape = std::move(shape);
  return part;
}

}  // namespace weft::charts
