/* SPDX-License-Identifier: Apache-2.0 */

/* A group computes the distances of TILE queries and trains, an item of it BLOCK x BLOCK. */
#define TILE_ITEMS ((TILE / BLOCK) * (TILE / BLOCK))
#define DEPTH 16 /* elements of descriptors loaded at a time */

/* One item for each element. */
KERNEL void widen(GLOBAL const uchar* bytes, int count, GLOBAL float* numbers) {
  int i = GLOBAL_ID(0);
  if (i < count) numbers[i] = bytes[i];
}

/* One item for each descriptor [count,length], which is not negative if `root`: with `root` it becomes
 * sqrt(d / |d|_1) (Arandjelovic and Zisserman 2012); and its squared norm. */
KERNEL void load(GLOBAL float* descriptors, int count, int length, int root,
                        GLOBAL float* norms) {
  int row = GLOBAL_ID(0);
  if (row >= count) return;
  wide begin = (wide)row * length;
  float sum = 0.0f, norm = 0.0f;
  for (int i = 0; i < length; ++i) sum += descriptors[begin + i];
  for (int i = 0; i < length; ++i) {
    float value = descriptors[begin + i];
    if (root) value = sum > 0.0f ? sqrt(value / sum) : 0.0f;
    descriptors[begin + i] = value;
    norm += value * value;
  }
  norms[row] = norm;
}

/* Squared distances [rows,trains] of queries first, first + 1 ... from all trains, as
 * |a|^2 + |b|^2 - 2 a.b. One group for each tile, tiles of one row of tiles side by side. */
KERNEL void distances(GLOBAL const float* queries, GLOBAL const float* query_norms, int first,
                      int rows, GLOBAL const float* trains, GLOBAL const float* train_norms,
                      int train_count, int length, GLOBAL float* squares) {
  LOCAL float a[DEPTH][TILE];
  LOCAL float b[DEPTH][TILE];
  int tiles = (train_count + TILE - 1) / TILE;
  int top = GROUP_ID / tiles * TILE, left = GROUP_ID % tiles * TILE;
  int down = LOCAL_ID / (TILE / BLOCK) * BLOCK, across = LOCAL_ID % (TILE / BLOCK) * BLOCK;
  float products[BLOCK][BLOCK];
  for (int i = 0; i < BLOCK; ++i)
    for (int j = 0; j < BLOCK; ++j) products[i][j] = 0.0f;

  for (int start = 0; start < length; start += DEPTH) {
    BARRIER();
    for (int n = LOCAL_ID; n < DEPTH * TILE; n += TILE_ITEMS) {
      int k = n % DEPTH, which = n / DEPTH;
      int query = top + which, train = left + which;
      int inside = start + k < length;
      a[k][which] =
          inside && query < rows ? queries[(wide)(first + query) * length + start + k] : 0.0f;
      b[k][which] = inside && train < train_count ? trains[(wide)train * length + start + k] : 0.0f;
    }
    BARRIER();
    for (int k = 0; k < DEPTH; ++k)
      for (int i = 0; i < BLOCK; ++i)
        for (int j = 0; j < BLOCK; ++j) products[i][j] += a[k][down + i] * b[k][across + j];
  }
  for (int i = 0; i < BLOCK; ++i) {
    for (int j = 0; j < BLOCK; ++j) {
      int query = top + down + i, train = left + across + j;
      if (query >= rows || train >= train_count) continue;
      squares[(wide)query * train_count + train] =
          query_norms[first + query] + train_norms[train] - 2.0f * products[i][j];
    }
  }
}

/* Squared distance of two descriptors from their differences. */
FUNCTION float squared_distance(GLOBAL const float* a, GLOBAL const float* b, int length) {
  float sum = 0.0f;
  for (int i = 0; i < length; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

/* The smallest value of a group's items and its index, the lowest of equal ones; -1 if none has. */
FUNCTION int smallest_of_group(LOCAL_POINTER float* values, LOCAL_POINTER int* indices, float value,
                               int index) {
  BARRIER();
  values[LOCAL_ID] = value;
  indices[LOCAL_ID] = index;
  BARRIER();
  int best = -1;
  float least = 0.0f;
  for (int i = 0; i < GROUP; ++i) {
    if (indices[i] < 0) continue;
    if (best < 0 || values[i] < least || (values[i] == least && indices[i] < best)) {
      best = indices[i];
      least = values[i];
    }
  }
  return best;
}

/* What is found for a query: the nearest train and the nearest one elsewhere, -1 where there is
 * none, with their squared distances. */
typedef struct Pair {
  int best, second;
  float best_square, second_square;
} Pair;

/* One group for each query of a block of distances. `places` [trains,2] px; a second is farther than
 * `elsewhere_px` from the best, or any other where that is 0. */
KERNEL void nearest(GLOBAL const float* squares, int train_count, GLOBAL const float* places,
                    float elsewhere_px, GLOBAL const float* queries, GLOBAL const float* trains,
                    int first, int length, GLOBAL Pair* pairs) {
  LOCAL float values[GROUP];
  LOCAL int indices[GROUP];
  GLOBAL const float* row = squares + (wide)GROUP_ID * train_count;
  float least = 0.0f;
  int at = -1;
  for (int j = LOCAL_ID; j < train_count; j += GROUP) {
    if (at >= 0 && !(row[j] < least)) continue;
    least = row[j];
    at = j;
  }
  int best = smallest_of_group(values, indices, least, at);
  at = -1;
  for (int j = LOCAL_ID; j < train_count; j += GROUP) {
    if (at >= 0 && !(row[j] < least)) continue;
    float dx = places[2 * j] - places[2 * best], dy = places[2 * j + 1] - places[2 * best + 1];
    if (j == best || (elsewhere_px > 0.0f && dx * dx + dy * dy <= elsewhere_px * elsewhere_px))
      continue;
    least = row[j];
    at = j;
  }
  int second = smallest_of_group(values, indices, least, at);
  if (LOCAL_ID != 0) return;
  GLOBAL const float* query = queries + (wide)(first + GROUP_ID) * length;
  Pair pair;
  pair.best = best;
  pair.second = second;
  pair.best_square = squared_distance(query, trains + (wide)best * length, length);
  pair.second_square =
      second < 0 ? 0.0f : squared_distance(query, trains + (wide)second * length, length);
  pairs[first + GROUP_ID] = pair;
}

/* One item for each train: the nearest query so far, with block after block of distances. */
KERNEL void nearest_queries(GLOBAL const float* squares, int first, int rows, int train_count,
                            GLOBAL float* least, GLOBAL int* best) {
  int train = GLOBAL_ID(0);
  if (train >= train_count) return;
  float smallest = least[train];
  int at = first == 0 ? -1 : best[train];
  for (int i = 0; i < rows; ++i) {
    float square = squares[(wide)i * train_count + train];
    if (at >= 0 && !(square < smallest)) continue;
    smallest = square;
    at = first + i;
  }
  least[train] = smallest;
  best[train] = at;
}
