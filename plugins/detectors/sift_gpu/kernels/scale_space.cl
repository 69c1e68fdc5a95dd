/* SPDX-License-Identifier: Apache-2.0 */

/* Grey level 0 to 255 of a pixel of one channel, or of blue, green and red weighted as OpenCV does. */
FUNCTION float grey_at(GLOBAL const uchar* image, int x, int y, int width, int channels) {
  GLOBAL const uchar* pixel = image + ((wide)y * width + x) * channels;
  if (channels == 1) return pixel[0];
  return (pixel[0] * 3735 + pixel[1] * 19235 + pixel[2] * 9798 + (1 << 14)) >> 15;
}

/* Two samples around the centre of pixel `i` of an image enlarged twice, and the second one's weight. */
FUNCTION float doubled(int i, int length, int* first, int* second) {
  int below = (i - 1) >> 1;
  *first = below < 0 ? 0 : below;
  *second = below + 1 < length ? below + 1 : length - 1;
  return (i & 1) ? 0.25f : 0.75f;
}

/* The image [height,width,channels] in floats, enlarged twice with pixel edges aligned if `twice`. */
KERNEL void grey_levels(GLOBAL const uchar* image, int width, int height, int channels, int twice,
                        GLOBAL float* to, wide to_offset) {
  int x = GLOBAL_ID(0), y = GLOBAL_ID(1);
  if (x >= width << twice || y >= height << twice) return;
  wide place = to_offset + (wide)y * (width << twice) + x;
  if (!twice) {
    to[place] = grey_at(image, x, y, width, channels);
    return;
  }
  int x0, x1, y0, y1;
  float wx = doubled(x, width, &x0, &x1), wy = doubled(y, height, &y0, &y1);
  float upper = (1.0f - wx) * grey_at(image, x0, y0, width, channels) +
                wx * grey_at(image, x1, y0, width, channels);
  float lower = (1.0f - wx) * grey_at(image, x0, y1, width, channels) +
                wx * grey_at(image, x1, y1, width, channels);
  to[place] = (1.0f - wy) * upper + wy * lower;
}

/* Mirrors an index at the centres of the first and last pixel until it lies inside. */
FUNCTION int mirrored(int i, int length) {
  if (length == 1) return 0;
  while (i < 0 || i >= length) i = i < 0 ? -i : 2 * length - 2 - i;
  return i;
}

/* Rows of `from` convolved with a symmetric kernel; taps[0] is its middle. */
KERNEL void blur_rows(GLOBAL const float* from, wide from_offset, int width, int height,
                      GLOBAL const float* taps, int taps_offset, int radius, GLOBAL float* to) {
  int x = GLOBAL_ID(0), y = GLOBAL_ID(1);
  if (x >= width || y >= height) return;
  GLOBAL const float* row = from + from_offset + (wide)y * width;
  GLOBAL const float* tap = taps + taps_offset;
  float sum = tap[0] * row[x];
  if (x >= radius && x + radius < width) {
    for (int i = 1; i <= radius; ++i) sum += tap[i] * (row[x - i] + row[x + i]);
  } else {
    for (int i = 1; i <= radius; ++i)
      sum += tap[i] * (row[mirrored(x - i, width)] + row[mirrored(x + i, width)]);
  }
  to[(wide)y * width + x] = sum;
}

/* Columns likewise. */
KERNEL void blur_columns(GLOBAL const float* from, int width, int height, GLOBAL const float* taps,
                         int taps_offset, int radius, GLOBAL float* to, wide to_offset) {
  int x = GLOBAL_ID(0), y = GLOBAL_ID(1);
  if (x >= width || y >= height) return;
  GLOBAL const float* tap = taps + taps_offset;
  GLOBAL const float* column = from + x;
  float sum = tap[0] * column[(wide)y * width];
  if (y >= radius && y + radius < height) {
    for (int i = 1; i <= radius; ++i)
      sum += tap[i] * (column[(wide)(y - i) * width] + column[(wide)(y + i) * width]);
  } else {
    for (int i = 1; i <= radius; ++i)
      sum += tap[i] * (column[(wide)mirrored(y - i, height) * width] +
                       column[(wide)mirrored(y + i, height) * width]);
  }
  to[to_offset + (wide)y * width + x] = sum;
}

/* Every second pixel of every second row, as the first layer of the next octave. */
KERNEL void halve(GLOBAL float* pyramid, wide from_offset, int from_width, wide to_offset, int width,
                  int height) {
  int x = GLOBAL_ID(0), y = GLOBAL_ID(1);
  if (x >= width || y >= height) return;
  pyramid[to_offset + (wide)y * width + x] =
      pyramid[from_offset + (wide)(2 * y) * from_width + 2 * x];
}
