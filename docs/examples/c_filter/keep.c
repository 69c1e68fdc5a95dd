/* SPDX-License-Identifier: Apache-2.0
 * A filter in C99 of weft/abi.h alone: it keeps matches that move about as the median match. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <weft/abi.h>

static const double usual_deviation_px = 100.0;
static const char *const output = "inlier_mask", *const output_type = "inlier_mask/1";

static int32_t say(weft_error* error, int32_t status, int32_t code, const char* message) {
  error->code = code;
  snprintf(error->message, sizeof(error->message), "%s", message);
  return status;
}

/* Called when the manifest is written: declares each parameter, which the host then checks. */
static int32_t describe(const weft_describe* sink, weft_error* error) {
  const weft_parameter parameter = {
      .struct_size = sizeof(weft_parameter),
      .default_value = {"max_deviation_px", WEFT_VALUE_F64, 0, 1, &usual_deviation_px, {0}},
      .unit = "px",
      .help = "maximum deviation of a kept match from the median motion, along x and y together",
      .minimum = 0.0,
      .maximum = 10000.0,
      .role = "",
      .was = ""};
  (void)error;
  sink->parameter(sink->context, &parameter);
  sink->record(sink->context, "correspondences/1");
  sink->record(sink->context, output_type);
  return WEFT_OK;
}

static int32_t create(const weft_create* with, void** self, weft_error* error) {
  double* max_deviation_px = malloc(sizeof(double));
  if (max_deviation_px == NULL) return say(error, WEFT_ERROR, WEFT_CODE_NO_MEMORY, "out of memory");
  *max_deviation_px = usual_deviation_px;
  for (uint64_t i = 0; i < with->count; ++i) {
    const weft_value* value = &with->values[i];
    if (strcmp(value->name, "max_deviation_px") != 0) continue;
    const double px = value->type == WEFT_VALUE_F64 ? *(const double*)value->data : -1.0;
    *max_deviation_px = px;
    if (px >= 0.0 && px <= 10000.0) continue;
    free(max_deviation_px);
    strcpy(error->subject, "max_deviation_px");
    return say(error, WEFT_ERROR, WEFT_CODE_INVALID_VALUE, "is no number from 0 to 10000");
  }
  *self = max_deviation_px;
  return WEFT_OK;
}

static int32_t prepare(void* self, const weft_call* call, const weft_record* inputs, uint64_t count,
                       weft_error* error) {
  return (void)self, (void)call, (void)inputs, (void)count, (void)error, WEFT_OK;
}

static const weft_array* array_of(const weft_record* record, const char* name, int32_t dtype) {
  for (uint64_t i = 0; i < record->count; ++i) {
    const weft_array* array = &record->arrays[i];
    if (strcmp(array->name, name) == 0) return array->dtype == dtype ? array : NULL;
  }
  return NULL;
}

/* Element (row, axis); rows of an input may be padded. */
static double element(const weft_array* array, int64_t row, int64_t axis) {
  const char* at = (const char*)array->data + row * array->stride[0] + axis * array->stride[1];
  return *(const double*)(const void*)at;
}

static int ascending(const void* a, const void* b) {
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

/* The lower median of the kept matches' motion along an axis; counts them. */
static double usual_motion(const weft_array* from, const weft_array* to, const uint8_t* kept,
                           int64_t axis, double* scratch, int64_t* left) {
  *left = 0;
  for (int64_t i = 0; i < from->shape[0]; ++i) {
    if (kept[i]) scratch[(*left)++] = element(to, i, axis) - element(from, i, axis);
  }
  qsort(scratch, (size_t)*left, sizeof(double), ascending);
  return *left > 0 ? scratch[(*left - 1) / 2] : 0.0;
}

static int32_t process(void* self, const weft_call* call, const weft_record* inputs, uint64_t count,
                       weft_error* error) {
  if (call->method != 0) return say(error, WEFT_ERROR, WEFT_CODE_UNSUPPORTED, "has one method");
  const double limit_px = *(const double*)self;
  const weft_array *from = NULL, *to = NULL, *marks = NULL;
  for (uint64_t i = 0; i < count; ++i) {
    if (strcmp(inputs[i].slot, "correspondences") != 0) continue;
    from = array_of(&inputs[i], "template_px", WEFT_F64);
    to = array_of(&inputs[i], "image_px", WEFT_F64);
    marks = array_of(&inputs[i], "kept", WEFT_U8);
  }
  if (!from || !to || !marks) return say(error, WEFT_ERROR, WEFT_CODE_INVALID_DATA, "no match");
  const uint8_t* before = marks->data;
  const int64_t n = marks->shape[0];
  uint8_t* kept = weft_alloc(call, output, output_type, "kept", WEFT_U8, 1, &n);
  double* score = weft_alloc(call, output, output_type, "score", WEFT_F64, 1, &n);
  if (!kept || !score) return say(error, WEFT_ERROR, WEFT_CODE_NO_MEMORY, "no room for the mask");
  int64_t left = 0, total = 0; /* the scores are the scratch of the medians until they are known */
  const double x_px = usual_motion(from, to, before, 0, score, &left);
  const double y_px = usual_motion(from, to, before, 1, score, &left);
  if (left == 0) return say(error, WEFT_NO_RESULT, 0, "no match is left to judge");
  for (int64_t i = 0; i < n; ++i) {
    const double x = element(to, i, 0) - element(from, i, 0) - x_px;
    const double y = element(to, i, 1) - element(from, i, 1) - y_px;
    const double squared = x * x + y * y;
    kept[i] = before[i] && squared <= limit_px * limit_px; /* rejected ones stay so */
    score[i] = before[i] ? 1.0 / (1.0 + squared) : 0.0;
    total += kept[i];
  }
  return total > 0 ? WEFT_OK
                   : say(error, WEFT_DEGENERATE, 0, "none moves as the median match does");
}

static const weft_component component = {
    .struct_size = sizeof(weft_component),
    .id = "filters/keep",
    .version = "1.0.0",
    .summary = "Keeps matches that move about as the median match does.",
    .reference = "",
    .licence = "Apache-2.0",
    .determinism = "exact",
    .needs = "",
    .reads = "",
    .produces = "",
    .methods = 1,
    .describe = describe,
    .create = create,
    .prepare = prepare,
    .process = process,
    .destroy = free};
static const weft_component* const components[] = {&component};
const weft_library_table weft_library = {
    .magic = WEFT_ABI_MAGIC,
    .abi_major = WEFT_ABI_MAJOR,
    .sdk_minor = WEFT_ABI_MINOR,
    .struct_size = sizeof(weft_library_table),
    .count = 1,
    .abi = WEFT_ABI_NAME,
    .components = components,
    .isa = "", /* instruction sets that -m options add to x86-64, such as "avx2 fma" */
    .compiler = "cc " __VERSION__};
