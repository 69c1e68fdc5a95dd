/* SPDX-License-Identifier: Apache-2.0 */

/* An octave of the pyramid: layers [layers,height,width] from `offset`. */
typedef struct Octave {
  wide offset;
  int width, height;
} Octave;

/* A refined extremum, or a keypoint once it has its angle. */
typedef struct Spot {
  float x, y;      /* px of its octave */
  float scale;     /* sigma, px of its octave */
  float angle;     /* rad, clockwise from +x */
  float response;  /* |D|, grey levels 0 to 1 */
  int octave, layer;
  int reserved;
} Spot;

#define BORDER 5
#define LARGEST_STEPS 5

/* Difference of neighbouring blurs at a pixel of layer `layer`. */
FUNCTION float difference(GLOBAL const float* octave, wide plane, int width, int x, int y, int layer) {
  GLOBAL const float* at = octave + layer * plane + (wide)y * width + x;
  return at[plane] - at[0];
}

/* No neighbour in place and scale is larger (of a positive value; smaller of a negative one). */
FUNCTION int is_extremum(GLOBAL const float* octave, wide plane, int width, int x, int y, int layer,
                         float value) {
  float sign = value > 0.0f ? 1.0f : -1.0f;
  for (int l = layer - 1; l <= layer + 1; ++l)
    for (int v = y - 1; v <= y + 1; ++v)
      for (int u = x - 1; u <= x + 1; ++u)
        if (sign * difference(octave, plane, width, u, v, l) > sign * value) return 0;
  return 1;
}

/* Derivatives of the difference in x, y and layer, grey levels 0 to 1. */
typedef struct Taylor {
  float value, dx, dy, ds, dxx, dyy, dss, dxy, dxs, dys;
} Taylor;

FUNCTION Taylor expand(GLOBAL const float* octave, wide plane, int width, int x, int y, int layer) {
  float d[3][3][3];
  for (int l = 0; l < 3; ++l)
    for (int v = 0; v < 3; ++v)
      for (int u = 0; u < 3; ++u)
        d[l][v][u] =
            difference(octave, plane, width, x + u - 1, y + v - 1, layer + l - 1) / 255.0f;
  Taylor t;
  t.value = d[1][1][1];
  t.dx = 0.5f * (d[1][1][2] - d[1][1][0]);
  t.dy = 0.5f * (d[1][2][1] - d[1][0][1]);
  t.ds = 0.5f * (d[2][1][1] - d[0][1][1]);
  t.dxx = d[1][1][2] + d[1][1][0] - 2.0f * t.value;
  t.dyy = d[1][2][1] + d[1][0][1] - 2.0f * t.value;
  t.dss = d[2][1][1] + d[0][1][1] - 2.0f * t.value;
  t.dxy = 0.25f * (d[1][2][2] - d[1][2][0] - d[1][0][2] + d[1][0][0]);
  t.dxs = 0.25f * (d[2][1][2] - d[2][1][0] - d[0][1][2] + d[0][1][0]);
  t.dys = 0.25f * (d[2][2][1] - d[2][0][1] - d[0][2][1] + d[0][0][1]);
  return t;
}

/* Where the expansion is stationary, -H^-1 g, by Cramer's rule; zero where H is singular. */
FUNCTION void stationary(Taylor t, float* x, float* y, float* s) {
  float cxx = t.dyy * t.dss - t.dys * t.dys;
  float cxy = t.dxs * t.dys - t.dxy * t.dss;
  float cxs = t.dxy * t.dys - t.dyy * t.dxs;
  float determinant = t.dxx * cxx + t.dxy * cxy + t.dxs * cxs;
  *x = *y = *s = 0.0f;
  if (determinant == 0.0f) return;
  float cyy = t.dxx * t.dss - t.dxs * t.dxs;
  float cys = t.dxy * t.dxs - t.dxx * t.dys;
  float css = t.dxx * t.dyy - t.dxy * t.dxy;
  *x = -(cxx * t.dx + cxy * t.dy + cxs * t.ds) / determinant;
  *y = -(cxy * t.dx + cyy * t.dy + cys * t.ds) / determinant;
  *s = -(cxs * t.dx + cys * t.dy + css * t.ds) / determinant;
}

/* Where an extremum lies, once it is refined: at (x + dx, y + dy, layer + ds). */
typedef struct Extremum {
  int x, y, layer;
  float dx, dy, ds;
  Taylor taylor;
} Extremum;

FUNCTION int is_within(Extremum at, float x, float y, float s) {
  return fabs(at.dx) < x && fabs(at.dy) < y && fabs(at.ds) < s;
}

/* Goes to the pixel and layer nearest to where the differences are stationary; 0 if there is none
 * inside the octave. */
FUNCTION int refine(GLOBAL const float* octave, int width, int height, int layers, Extremum* at) {
  for (int step = 0; step < LARGEST_STEPS; ++step) {
    at->taylor = expand(octave, (wide)width * height, width, at->x, at->y, at->layer);
    stationary(at->taylor, &at->dx, &at->dy, &at->ds);
    if (is_within(*at, 0.5f, 0.5f, 0.5f)) return 1;
    if (!is_within(*at, width, height, layers + 1)) return 0;
    at->x += (int)rint(at->dx);
    at->y += (int)rint(at->dy);
    at->layer += (int)rint(at->ds);
    if (at->layer < 1 || at->layer > layers || at->x < BORDER || at->x >= width - BORDER ||
        at->y < BORDER || at->y >= height - BORDER)
      return 0;
  }
  return 0;
}

FUNCTION int is_on_edge(Taylor t, float edge) {
  float trace = t.dxx + t.dyy, determinant = t.dxx * t.dyy - t.dxy * t.dxy;
  return determinant <= 0.0f || trace * trace * edge >= (edge + 1.0f) * (edge + 1.0f) * determinant;
}

/* Extrema of one octave, refined and tested (Lowe 2004, sections 3 and 4), appended to `spots` in no
 * order; `count` goes on counting beyond `capacity`. */
KERNEL void extrema(GLOBAL const float* pyramid, wide offset, int width, int height, int octave,
                    int layers, float sigma, float contrast, float edge, GLOBAL Spot* spots,
                    GLOBAL int* count, int capacity) {
  int x = GLOBAL_ID(0) + BORDER, y = GLOBAL_ID(1) + BORDER;
  if (x >= width - BORDER || y >= height - BORDER) return;
  GLOBAL const float* from = pyramid + offset;
  wide plane = (wide)width * height;
  float weakest = floor(0.5f * contrast / layers * 255.0f);
  for (int layer = 1; layer <= layers; ++layer) {
    float value = difference(from, plane, width, x, y, layer);
    if (!(fabs(value) > weakest)) continue;
    if (!is_extremum(from, plane, width, x, y, layer, value)) continue;
    Extremum at;
    at.x = x;
    at.y = y;
    at.layer = layer;
    if (!refine(from, width, height, layers, &at)) continue;
    Taylor t = at.taylor;
    float response = fabs(t.value + 0.5f * (t.dx * at.dx + t.dy * at.dy + t.ds * at.ds));
    if (response * layers < contrast || is_on_edge(t, edge)) continue;

    int place = NEXT(count);
    if (place >= capacity) continue;
    Spot spot;
    spot.x = at.x + at.dx;
    spot.y = at.y + at.dy;
    spot.scale = sigma * exp2((at.layer + at.ds) / layers);
    spot.angle = 0.0f;
    spot.response = response;
    spot.octave = octave;
    spot.layer = at.layer;
    spot.reserved = 0;
    spots[place] = spot;
  }
}
