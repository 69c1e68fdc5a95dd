// SPDX-License-Identifier: Apache-2.0
#include "schedule.hpp"

#include <algorithm>
#include <weft/core/index.hpp>

namespace weft::sift_fast {

void Schedule::add_layer(Task::Kind kind, int octave, int layer, int height, int source, int reach,
                         int halving) {
  Layer next{kind, octave, layer, height, 0, source, reach, halving, 0};
  if (!layers_.empty()) next.first_id = layers_.back().first_id + layers_.back().blocks();
  layers_.push_back(next);
}

/// The next task of a layer.
Task Schedule::task(const Layer& of) const {
  Task next;
  next.kind = of.kind;
  next.octave = of.octave;
  next.layer = of.layer;
  next.rows = {of.emitted * of.rows(), std::min((of.emitted + 1) * of.rows(), of.height)};
  next.id = of.first_id + of.emitted;
  if (of.source < 0) return next;
  const Layer& source = layers_[to_index(of.source)];
  int first = next.rows.begin, last = next.rows.end - 1;
  if (of.halving > 0) first = 2 * first, last = 2 * last;
  if (of.halving < 0) first = first / 2, last = last / 2;
  // Outer rows are mirrored, and a reach beyond the whole height takes all rows.
  first -= of.reach;
  last += of.reach;
  if (first < 0) last = std::max(last, -first);
  if (last >= source.height) first = std::min(first, 2 * source.height - 2 - last);
  first = std::clamp(first, 0, source.height - 1);
  last = std::clamp(last, 0, source.height - 1);
  next.first_needed = source.first_id + first / source.rows();
  next.end_needed = source.first_id + last / source.rows() + 1;
  return next;
}

bool Schedule::emit(Layer& of) {
  if (of.emitted == of.blocks()) return false;
  const Task next = task(of);
  if (of.source >= 0) {
    const Layer& source = layers_[to_index(of.source)];
    if (next.end_needed > source.first_id + source.emitted) return false;
  }
  ordered_.push_back(next);
  ++of.emitted;
  return true;
}

void Schedule::make(const Pyramid& pyramid, const Blurs& blurs) {
  layers_.clear();
  ordered_.clear();
  if (pyramid.octaves() == 0) return;
  add_layer(Task::Kind::load, 0, 0, pyramid.image().height, -1, 0, 0);
  int from = 0;
  for (int o = 0; o < pyramid.octaves(); ++o) {
    const int height = pyramid.octave(o).height();
    const bool doubled = o == 0 && !blurs.doubling.empty();
    const auto reach = static_cast<int>(doubled ? blurs.doubling.size() / 2 : blurs.first.size());
    add_layer(Task::Kind::blur, o, 0, height, from, o == 0 ? reach : 0,
              o > 0 ? 1 : (doubled ? -1 : 0));
    for (int l = 1; l < blurs.layers; ++l) {
      add_layer(Task::Kind::blur, o, l, height, static_cast<int>(layers_.size()) - 1,
                static_cast<int>(blurs.steps[to_index(l)].size()) - 1, 0);
    }
    // The last layer is made from all others, of at least the rows that the search needs.
    add_layer(Task::Kind::search, o, 0, height, static_cast<int>(layers_.size()) - 1, 1, 0);
    from = static_cast<int>(layers_.size()) - 4;
  }
  // From the end on, so that what a task needs is seldom the one just before.
  for (bool any = true; any;) {
    any = false;
    for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
      any = emit(*layer) || any;
    }
  }
}

}  // namespace weft::sift_fast
