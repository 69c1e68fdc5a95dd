// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels.hpp"
#include "pyramid.hpp"
#include "rows.hpp"

namespace weft::sift_fast {

/// A few rows of one layer to be made, or to be searched for extrema.
struct Task {
  enum class Kind : std::uint8_t { load, blur, search };
  Kind kind = Kind::load;
  int octave = 0, layer = 0;
  RowRange rows;
  /// Tasks [first_needed, end_needed) of `tasks_by_layer` must be done before.
  int first_needed = 0, end_needed = 0;
  int id = 0;  ///< its place in tasks_by_layer
};

/// All tasks of an image, in an order in which each comes after those that it needs, and soon after
/// them: what it reads is still in the cache. One thread takes them as they stand; several take the
/// next one each, and seldom have to wait.
class Schedule {
 public:
  /// Rows of a task: few, so that the next layer follows soon; more where their neighbours must be
  /// looked at twice.
  static constexpr int kRowsOfLayer = 4, kRowsOfSearch = 16;

  void make(const Pyramid& pyramid, const Blurs& blurs);

  std::span<const Task> tasks() const { return ordered_; }
  int count() const { return static_cast<int>(ordered_.size()); }

 private:
  /// Tasks of one layer, of the image or of the search of one octave.
  struct Layer {
    Task::Kind kind = Task::Kind::load;
    int octave = 0, layer = 0;
    int height = 0;
    int first_id = 0;  ///< first of its tasks, top to bottom
    int source = -1;   ///< the layer that it is made from; -1 for none
    int reach = 0;     ///< rows of the source above and below
    int halving = 0;   ///< 1 where a row comes from twice its number, -1 from half of it
    int emitted = 0;

    int rows() const { return kind == Task::Kind::search ? kRowsOfSearch : kRowsOfLayer; }
    int blocks() const { return (height + rows() - 1) / rows(); }
  };

  void add_layer(Task::Kind kind, int octave, int layer, int height, int source, int reach,
                 int halving);
  Task task(const Layer& of) const;
  bool emit(Layer& of);

  std::vector<Layer> layers_;
  std::vector<Task> ordered_;
};

}  // namespace weft::sift_fast
