/* SPDX-License-Identifier: Apache-2.0 */

#define CELLS 4
#define DIRECTIONS 8
#define CELL_SIGMAS 3.0f
#define LARGEST_PART 0.2f

/* The sum over a group's items, each of which brings one value; the same for all orders of work. */
FUNCTION float sum_of_group(LOCAL_POINTER float* parts, float mine) {
  BARRIER();
  parts[LOCAL_ID] = mine;
  BARRIER();
  float sum = 0.0f;
  for (int i = 0; i < GROUP; ++i) sum += parts[i];
  return sum;
}

/* A group's items add the gradients around a spot to 4x4 cells of `cell` px and 8 directions, in parts
 * of `unit`, each shared out among neighbouring cells and directions. */
FUNCTION void add_gradients(GLOBAL const float* layer, Octave octave, Spot spot, float cell, float unit,
                            LOCAL_POINTER int* sums) {
  int centre_x = (int)rint(spot.x), centre_y = (int)rint(spot.y);
  float across = cos(spot.angle) / cell, down = sin(spot.angle) / cell;
  int radius = (int)rint(cell * 1.41421356f * (CELLS + 1) * 0.5f);
  int diagonal = (int)sqrt((float)octave.width * octave.width + (float)octave.height * octave.height);
  radius = radius < diagonal ? radius : diagonal;
  int side = 2 * radius + 1;
  for (int n = LOCAL_ID; n < side * side; n += GROUP) {
    int i = n / side - radius, j = n % side - radius;
    int x = centre_x + j, y = centre_y + i;
    if (!has_gradient(octave, x, y)) continue;
    float column = j * across + i * down, row = i * across - j * down;
    float u = column + 0.5f * CELLS - 0.5f, v = row + 0.5f * CELLS - 0.5f;
    if (!(u > -1.0f && u < CELLS && v > -1.0f && v < CELLS)) continue;

    float angle;
    float weight = gradient(layer, octave.width, x, y, &angle) *
                   exp(-(column * column + row * row) / (0.5f * CELLS * CELLS)) * unit;
    float direction = (spot.angle - angle) * (DIRECTIONS / (2.0f * PI));
    int u0 = (int)floor(u), v0 = (int)floor(v), d0 = (int)floor(direction);
    float uf = u - u0, vf = v - v0, df = direction - d0;
    for (int corner = 0; corner < 4; ++corner) {
      int uc = u0 + (corner & 1), vc = v0 + (corner >> 1);
      if (uc < 0 || uc >= CELLS || vc < 0 || vc >= CELLS) continue;
      float part = weight * ((corner & 1) ? uf : 1.0f - uf) * ((corner >> 1) ? vf : 1.0f - vf);
      LOCAL_POINTER int* bins = sums + (vc * CELLS + uc) * DIRECTIONS;
      ADD_LOCAL(&bins[d0 & (DIRECTIONS - 1)], (int)rint(part * (1.0f - df)));
      ADD_LOCAL(&bins[(d0 + 1) & (DIRECTIONS - 1)], (int)rint(part * df));
    }
  }
  BARRIER();
}

/* One group for each keypoint: its gradients in 4x4 cells of 8 directions, weighted, normalised, cut
 * off at 0.2, normalised to 512 and rounded (Lowe 2004, section 6). */
KERNEL void descriptions(GLOBAL const float* pyramid, GLOBAL const Octave* octaves,
                         GLOBAL const Spot* keypoints, GLOBAL uchar* descriptors) {
  LOCAL int sums[LENGTH];
  LOCAL float parts[GROUP];
  Spot spot = keypoints[GROUP_ID];
  Octave octave = octaves[spot.octave];
  float cell = CELL_SIGMAS * spot.scale;
  float unit = LARGEST_SUM / (LARGEST_GRADIENT * (cell + 1.0f) * (cell + 1.0f));
  clear(sums, LENGTH);
  add_gradients(layer_of(pyramid, octave, spot), octave, spot, cell, unit, sums);

  float squares = 0.0f;
  for (int bin = LOCAL_ID; bin < LENGTH; bin += GROUP) {
    float value = sums[bin] / unit;
    squares += value * value;
  }
  float largest = LARGEST_PART * sqrt(sum_of_group(parts, squares));
  squares = 0.0f;
  for (int bin = LOCAL_ID; bin < LENGTH; bin += GROUP) {
    float value = fmin(sums[bin] / unit, largest);
    squares += value * value;
  }
  float scale = 512.0f / fmax(sqrt(sum_of_group(parts, squares)), 1e-7f);
  GLOBAL uchar* to = descriptors + (wide)GROUP_ID * LENGTH;
  for (int bin = LOCAL_ID; bin < LENGTH; bin += GROUP) {
    to[bin] = TO_BYTE(fmin(sums[bin] / unit, largest) * scale);
  }
}
