/* SPDX-License-Identifier: Apache-2.0
 * A detector in C99 with a parameter of every type and all extensions. It reports its parameters,
 * and the frame selects what it does. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <weft/abi.h>

#define COUNT(list) (sizeof(list) / sizeof *(list))

static const double number = 0.5, numbers[] = {0.5, 0.25}, swept[] = {0.25, 0.5, 1.0};
static const int64_t integer = 9007199254740993, integers[] = {INT64_MIN, INT64_MAX};
static const uint8_t flag = 1;
static const char *const word = "first", *const text = "a text", *const input = "auto",
                         *const output = "every.txt", *const nested = "detectors/kept.small",
                         *const texts[] = {"one", "two"}, *const words[] = {"first", "second"};

/* The defaults, in the order of weft_value_type; then lists. */
static const weft_value values[] = {
    {"number", WEFT_VALUE_F64, 0, 1, &number, {0, 0}},
    {"integer", WEFT_VALUE_I64, 0, 1, &integer, {0, 0}},
    {"flag", WEFT_VALUE_BOOL, 0, 1, &flag, {0, 0}},
    {"word", WEFT_VALUE_CHOICE, 0, 1, &word, {0, 0}},
    {"text", WEFT_VALUE_TEXT, 0, 1, &text, {0, 0}},
    {"input", WEFT_VALUE_INPUT_PATH, 0, 1, &input, {0, 0}},
    {"output", WEFT_VALUE_OUTPUT_PATH, 0, 1, &output, {0, 0}},
    {"nested", WEFT_VALUE_COMPONENT, 0, 1, &nested, {0, 0}},
    {"labels", WEFT_VALUE_LABELS, 0, 0, NULL, {0, 0}},
    {"numbers", WEFT_VALUE_F64, 1, COUNT(numbers), numbers, {0, 0}},
    {"integers", WEFT_VALUE_I64, 1, COUNT(integers), integers, {0, 0}},
    {"texts", WEFT_VALUE_TEXT, 1, COUNT(texts), texts, {0, 0}}};

struct instance {
  char values[1024]; /* in words */
  uint64_t nested;
  double number;
  int flag;
};

static int32_t fail(weft_error* error, int32_t status, int32_t code, const char* message) {
  error->code = code;
  snprintf(error->message, sizeof(error->message), "%s", message);
  return status;
}

static int32_t describe(const weft_describe* sink, weft_error* error) {
  (void)error;
  for (size_t i = 0; i < COUNT(values); ++i) {
    weft_parameter parameter = {.struct_size = sizeof parameter,
                                .default_value = values[i],
                                .unit = "",
                                .help = "a value",
                                .minimum = -8,
                                .maximum = 8,
                                .integer_minimum = INT64_MIN,
                                .integer_maximum = INT64_MAX,
                                .role = "",
                                .was = ""};
    if (values[i].data == &integer) parameter.integer_maximum = integer;
    if (values[i].data == &nested) parameter.role = "detectors";
    if (values[i].data == texts) parameter.was = "words";
    if (values[i].data == &word) parameter.choices = words, parameter.choice_count = COUNT(words);
    if (values[i].data == &input) parameter.choices = &input, parameter.choice_count = 1;
    sink->parameter(sink->context, &parameter);
  }
  sink->record(sink->context, "image/1");
  sink->record(sink->context, "region/1");
  sink->record(sink->context, "keypoints/1");
  return WEFT_OK;
}

/* One element of a value in words; of a path its last part. */
static void add(char* to, size_t room, const weft_value* value, uint64_t i) {
  const char* word_of = NULL;
  switch (value->type) {
    case WEFT_VALUE_F64:
      snprintf(to, room, " %g", ((const double*)value->data)[i]);
      return;
    case WEFT_VALUE_I64:
      snprintf(to, room, " %lld", (long long)((const int64_t*)value->data)[i]);
      return;
    case WEFT_VALUE_BOOL:
      snprintf(to, room, " %d", ((const uint8_t*)value->data)[i]);
      return;
    case WEFT_VALUE_COMPONENT:
      snprintf(to, room, " %s", ((const uint64_t*)value->data)[i] != 0 ? "nested" : "none");
      return;
    default:
      word_of = ((const char* const*)value->data)[i];
      if (strrchr(word_of, '/') != NULL) word_of = strrchr(word_of, '/') + 1;
      snprintf(to, room, " '%s'", word_of);
  }
}

static int32_t create(const weft_create* with, void** self, weft_error* error) {
  struct instance* made = calloc(1, sizeof *made);
  if (made == NULL) return fail(error, WEFT_ERROR, WEFT_CODE_NO_MEMORY, "out of memory");
  made->number = number;
  made->flag = flag;
  for (size_t k = 0; k < COUNT(values); ++k) {
    const weft_value* value = &values[k];
    for (uint64_t i = 0; i < with->count; ++i) {
      if (strcmp(with->values[i].name, value->name) == 0) value = &with->values[i];
    }
    size_t length = strlen(made->values);
    snprintf(made->values + length, sizeof(made->values) - length, "%s%s", k > 0 ? "; " : "",
             value->name);
    for (uint64_t i = 0; i < value->count && value != &values[7]; ++i) {
      length = strlen(made->values);
      add(made->values + length, sizeof(made->values) - length, value, i);
    }
    if (value == &values[k]) continue;
    if (k == 0) made->number = *(const double*)value->data;
    if (k == 2) made->flag = *(const uint8_t*)value->data;
    if (k == 7) made->nested = *(const uint64_t*)value->data;
  }
  *self = made;
  return WEFT_OK;
}

static int32_t prepare(void* self, const weft_call* call, const weft_record* inputs, uint64_t count,
                       weft_error* error) {
  return (void)self, (void)call, (void)inputs, (void)count, (void)error, WEFT_OK;
}

/* The number of requests that the host refuses, of those that a host of 1.x must refuse. */
static int refusals(const weft_call* call, weft_error* error) {
  const int64_t shape[] = {1, 1};
  weft_output wrong = {
      sizeof wrong,  WEFT_F32, "keypoints", "keypoints/1", "binary_descriptors", shape, 2, 0, 0, 0,
      WEFT_NO_FRAME, 1};
  weft_invocation other = {sizeof other, 0, 1000000, NULL, 0, 0, 0, NULL, 0};
  int count = 0;
  count += call->host->adopt(call, &wrong) == 0;
  count += call->host->alloc(call, &wrong) == NULL;
  count += weft_alloc(call, "shape", "shape/1", "vertices_m", WEFT_F64, 2, shape) == NULL;
  count += weft_alloc(call, "keypoints", "keypoints/2", "xy_px", WEFT_F64, 2, shape) == NULL;
  count += weft_alloc(call, "keypoints", "keypoints/1", "x.kept", WEFT_U8, 2, shape) == NULL;
  count += weft_alloc(call, "keypoints", "keypoints/1", "a b", WEFT_U8, 2, shape) == NULL;
  count += call->host->invoke(call, &other, error) == WEFT_ERROR;
  count += call->host->get_extension(call->host, call->context, "kept.unknown/1") == NULL;
  memset(error->where, 0, sizeof(error->where));
  memset(error->message, 0, sizeof(error->message));
  error->code = 0;
  return count;
}

/* Arrays of a vendor with every element type. */
static int32_t add_vendor_arrays(const weft_call* call, const char* described, int refused) {
  static const int32_t bytes[] = {0, 1, 1, 2, 2, 4, 8, 4, 8, 2, 4, 8};
  char name[32];
  for (int32_t dtype = WEFT_U8; dtype <= WEFT_U64; ++dtype) {
    const int64_t shape[] = {1, 2};
    snprintf(name, sizeof name, "x.kept.type_%d", (int)dtype);
    void* elements = weft_alloc(call, "keypoints", "keypoints/1", name, dtype, 2, shape);
    if (elements == NULL) return 0;
    memset(elements, 0, 2 * (size_t)bytes[dtype]);
  }
  const int64_t length = (int64_t)strlen(described);
  char* to = weft_alloc(call, "keypoints", "keypoints/1", "x.kept.values", WEFT_U8, 1, &length);
  int32_t* count =
      weft_alloc(call, "keypoints", "keypoints/1", "x.kept.refusals", WEFT_I32, 0, NULL);
  if (to == NULL || count == NULL) return 0;
  memcpy(to, described, (size_t)length);
  *count = refused;
  return 1;
}

/* Passes on an answer; its descriptors move to the memory of this library. */
static int32_t pass_on(const weft_call* call, const weft_record* record) {
  for (uint64_t i = 0; i < record->count; ++i) {
    const weft_array* array = &record->arrays[i];
    const int is_remote = strcmp(array->name, "descriptors") == 0;
    const int64_t rows = array->ndim > 0 ? array->shape[0] : 1;
    const int64_t columns = array->ndim > 1 ? array->shape[1] : 1;
    size_t size = array->dtype == WEFT_F64 ? 8 : array->dtype == WEFT_U8 ? 1 : 4;
    size *= (size_t)columns;
    char* to = is_remote ? malloc((size_t)rows * size + sizeof(int64_t))
                         : weft_alloc(call, "keypoints", "keypoints/1", array->name, array->dtype,
                                      array->ndim, array->shape);
    if (to == NULL) return 0;
    if (is_remote) { /* the count of references, then the contents */
      const int64_t one = 1;
      weft_output at = {sizeof at,
                        array->dtype,
                        "keypoints",
                        "keypoints/1",
                        array->name,
                        array->shape,
                        array->ndim,
                        0,
                        0,
                        0,
                        WEFT_NO_FRAME,
                        (uint64_t)(uintptr_t)to};
      memcpy(to, &one, sizeof one);
      to += sizeof one;
      for (int64_t k = 0; k < rows; ++k) {
        memcpy(to + (size_t)k * size, (const char*)array->data + k * array->stride[0], size);
      }
      if (call->host->adopt(call, &at) == 0) return 0;
      continue;
    }
    for (int64_t k = 0; k < rows; ++k) {
      const int64_t at = array->ndim > 0 ? k * array->stride[0] : 0;
      memcpy(to + (size_t)k * size, (const char*)array->data + at, size);
    }
  }
  return 1;
}

static int32_t process(void* self, const weft_call* call, const weft_record* inputs, uint64_t count,
                       weft_error* error) {
  struct instance* own = self;
  weft_invocation asked = {sizeof asked, 0, own->nested, inputs, count, call->frame, 0, NULL, 0};
  if (call->method != 0) return fail(error, WEFT_ERROR, WEFT_CODE_UNSUPPORTED, "has one method");
  if (call->frame == 2) return fail(error, WEFT_NO_RESULT, 0, "no result in frame 2");
  if (call->frame == 3) return fail(error, WEFT_ERROR, WEFT_CODE_IO, "error in frame 3");
  if (call->frame == 4 || call->host->cancelled(call)) {
    return fail(error, WEFT_CANCELLED, WEFT_CODE_CANCELLED, "cancelled");
  }
  call->host->log(call, 0, "begins");
  const int refused = refusals(call, error);
  const int32_t status = call->host->invoke(call, &asked, error);
  if (status != WEFT_OK) return status;
  if (asked.output_count != 1 || !pass_on(call, &asked.outputs[0]) ||
      !add_vendor_arrays(call, own->values, refused)) {
    return fail(error, WEFT_ERROR, WEFT_CODE_NO_MEMORY, "no room");
  }
  return call->frame == 1 ? fail(error, WEFT_DEGENERATE, 0, "degenerate in frame 1") : WEFT_OK;
}

static void retain(uint64_t handle) {
  __atomic_add_fetch((int64_t*)(uintptr_t)handle, 1, __ATOMIC_SEQ_CST);
}
static void release(uint64_t handle) {
  int64_t* block = (int64_t*)(uintptr_t)handle;
  if (__atomic_sub_fetch(block, 1, __ATOMIC_SEQ_CST) == 0) free(block);
}
static int32_t download(const weft_call* call, uint64_t handle, void* to, uint64_t bytes,
                        weft_error* error) {
  (void)call, (void)error;
  memcpy(to, (const int64_t*)(uintptr_t)handle + 1, bytes);
  return WEFT_OK;
}
static int32_t list(void* context, void (*device)(void* context, const char* text),
                    weft_error* error) {
  (void)error;
  device(context, "a device");
  device(context, "another device");
  return WEFT_OK;
}
static int32_t check(void* self, void* context,
                     void (*mistake)(void* context, const char* parameter, const char* message),
                     weft_error* error) {
  const struct instance* own = self;
  (void)error;
  if (own->number > 4.0) mistake(context, "number", "exceeds 4");
  if (!own->flag) mistake(context, "flag", "warning: is false");
  return WEFT_OK;
}
static int32_t take_change_requests(void* self, void* context,
                                    void (*request)(void* context, uint64_t number,
                                                    const char* text),
                                    weft_error* error) {
  (void)self, (void)error;
  request(context, 7, "pause");
  request(context, 8, "stop");
  return WEFT_OK;
}
static int32_t answer(void* self, uint64_t request, uint64_t frame, const char* refusal,
                      weft_error* error) {
  (void)self;
  if (request == 7 && frame == 3 && strcmp(refusal, "no") == 0) return WEFT_OK;
  return fail(error, WEFT_ERROR, WEFT_CODE_INVALID_VALUE, "another answer");
}

static const void* get_extension(const weft_component* component, const char* name) {
  static const weft_device_memory memory = {sizeof memory, 0, retain, release, download};
  static const weft_devices devices = {sizeof devices, 0, list};
  static const weft_check checks = {sizeof checks, 0, check};
  static const weft_sweep sweep = {sizeof sweep, 0, "number", swept, COUNT(swept)};
  static const weft_isolation isolation = {sizeof isolation, 0};
  static const weft_steering steering = {sizeof steering, 0, take_change_requests, answer};
  (void)component;
  if (strcmp(name, WEFT_DEVICE_MEMORY) == 0) return &memory;
  if (strcmp(name, WEFT_DEVICES) == 0) return &devices;
  if (strcmp(name, WEFT_CHECK) == 0) return &checks;
  if (strcmp(name, WEFT_SWEEP) == 0) return &sweep;
  if (strcmp(name, WEFT_ISOLATION) == 0) return &isolation;
  return strcmp(name, WEFT_STEERING) == 0 ? &steering : NULL;
}

static const weft_component component = {.struct_size = sizeof component,
                                         .id = "detectors/kept.every_c",
                                         .version = "1.0.0",
                                         .summary = "Has every parameter and extension, in C.",
                                         .reference = "",
                                         .licence = "Apache-2.0",
                                         .determinism = "exact",
                                         .needs = "",
                                         .reads = "region",
                                         .produces = "",
                                         .methods = 1,
                                         .describe = describe,
                                         .create = create,
                                         .prepare = prepare,
                                         .process = process,
                                         .destroy = free,
                                         .get_extension = get_extension};
static const weft_component* const components[] = {&component};
const weft_library_table weft_library = {.magic = WEFT_ABI_MAGIC,
                                         .abi_major = WEFT_ABI_MAJOR,
                                         .sdk_minor = WEFT_ABI_MINOR,
                                         .struct_size = sizeof(weft_library_table),
                                         .count = 1,
                                         .abi = WEFT_ABI_NAME,
                                         .components = components,
                                         .isa = "",
                                         .compiler = "cc"};
