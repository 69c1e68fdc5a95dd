/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Histograms are kept in integers: sums of integers do not depend on the order in which the items of
 * a group add to them, so that the same image always gives the same answer.
 */

#define ANGLE_BINS 36
#define LARGEST_SUM 1073741824.0f
#define LARGEST_GRADIENT 361.0f

/* Gradient of a layer inside its border: its length, and its direction from +x towards +y in rad. */
FUNCTION float gradient(GLOBAL const float* layer, int width, int x, int y, float* angle) {
  GLOBAL const float* at = layer + (wide)y * width + x;
  float dx = at[1] - at[-1], dy = at[width] - at[-width];
  *angle = atan2(dy, dx);
  return sqrt(dx * dx + dy * dy);
}

/* A group's items set a histogram to zero. */
FUNCTION void clear(LOCAL_POINTER int* sums, int count) {
  for (int bin = LOCAL_ID; bin < count; bin += GROUP) sums[bin] = 0;
  BARRIER();
}

/* The layer in which a spot was found. */
FUNCTION GLOBAL const float* layer_of(GLOBAL const float* pyramid, Octave octave, Spot spot) {
  return pyramid + octave.offset + spot.layer * ((wide)octave.width * octave.height);
}

FUNCTION int has_gradient(Octave octave, int x, int y) {
  return x > 0 && x < octave.width - 1 && y > 0 && y < octave.height - 1;
}

/* A group's items add the gradients around a spot to a histogram of directions. */
FUNCTION void add_directions(GLOBAL const float* layer, Octave octave, Spot spot,
                             LOCAL_POINTER int* sums) {
  int centre_x = (int)rint(spot.x), centre_y = (int)rint(spot.y);
  float sigma = 1.5f * spot.scale;
  int radius = (int)rint(3.0f * sigma);
  int side = 2 * radius + 1;
  float unit = LARGEST_SUM / (LARGEST_GRADIENT * (2.0f * PI * sigma * sigma + 1.0f));
  for (int n = LOCAL_ID; n < side * side; n += GROUP) {
    int i = n / side - radius, j = n % side - radius;
    int x = centre_x + j, y = centre_y + i;
    if (!has_gradient(octave, x, y)) continue;
    float angle;
    float weight = gradient(layer, octave.width, x, y, &angle) *
                   exp(-(i * i + j * j) / (2.0f * sigma * sigma));
    int bin = (int)rint(angle * (ANGLE_BINS / (2.0f * PI)));
    ADD_LOCAL(&sums[bin < 0 ? bin + ANGLE_BINS : bin], (int)rint(weight * unit));
  }
  BARRIER();
}

/* A bin of the histogram and its neighbours, weighted 1 4 6 4 1. */
FUNCTION float smoothed(LOCAL_POINTER const int* sums, int bin) {
  int a = sums[(bin + ANGLE_BINS - 2) % ANGLE_BINS], b = sums[(bin + ANGLE_BINS - 1) % ANGLE_BINS];
  int c = sums[(bin + 1) % ANGLE_BINS], d = sums[(bin + 2) % ANGLE_BINS];
  return ((float)a + d) / 16.0f + ((float)b + c) / 4.0f + sums[bin] * 0.375f;
}

/* One group for each extremum: a keypoint for its strongest gradient direction and for each other
 * peak of at least 0.8 of that (Lowe 2004, section 5). */
KERNEL void orientations(GLOBAL const float* pyramid, GLOBAL const Octave* octaves,
                         GLOBAL const Spot* extrema, GLOBAL Spot* keypoints, GLOBAL int* count,
                         int capacity) {
  LOCAL int sums[ANGLE_BINS];
  LOCAL float smooth[ANGLE_BINS];
  Spot spot = extrema[GROUP_ID];
  Octave octave = octaves[spot.octave];
  clear(sums, ANGLE_BINS);
  add_directions(layer_of(pyramid, octave, spot), octave, spot, sums);
  for (int bin = LOCAL_ID; bin < ANGLE_BINS; bin += GROUP) smooth[bin] = smoothed(sums, bin);
  BARRIER();

  for (int bin = LOCAL_ID; bin < ANGLE_BINS; bin += GROUP) {
    float highest = 0.0f;
    for (int other = 0; other < ANGLE_BINS; ++other)
      highest = smooth[other] > highest ? smooth[other] : highest;
    float here = smooth[bin];
    float left = smooth[(bin + ANGLE_BINS - 1) % ANGLE_BINS];
    float right = smooth[(bin + 1) % ANGLE_BINS];
    if (!(here > left && here > right && here >= 0.8f * highest)) continue;
    int place = NEXT(count);
    if (place >= capacity) continue;
    float peak = bin + 0.5f * (left - right) / (left - 2.0f * here + right);
    spot.angle = peak * (2.0f * PI / ANGLE_BINS);
    if (spot.angle < 0.0f) spot.angle += 2.0f * PI;
    if (spot.angle >= 2.0f * PI) spot.angle -= 2.0f * PI;
    keypoints[place] = spot;
  }
}
