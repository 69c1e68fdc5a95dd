/* SPDX-License-Identifier: Apache-2.0
 * A library as a header 1.99 would make it. It has longer structs, flags and arrays unknown to 1.0,
 * a later optional input and output, and components that only a later host can use. The first
 * component needs none of these. With NEEDS it needs a host of 1.99. With VERSION_2 it supports
 * only the second version of a record, with BOTH also the first one.
 */
#include <stddef.h>
#include <string.h>
#include <weft/abi.h>

#define SDK_MINOR 99
#ifdef NEEDS
#define NEEDS_MINOR 99
#else
#define NEEDS_MINOR 0
#endif

#if defined(VERSION_2)
#define ID "filters/kept.version2"
#elif defined(BOTH)
#define ID "filters/kept.both"
#elif defined(NEEDS)
#define ID "filters/kept.needs"
#else
#define ID "filters/kept.newer"
#endif

static int instance;
static const double limit = 0.5;

/* A struct of 1.99 is longer than that of 1.0. */
static const struct {
  weft_parameter known;
  double unknown;
} parameter = {{sizeof parameter,
                1u << 15,
                {"limit", WEFT_VALUE_F64, 0, 1, &limit, {1, 2}},
                "px",
                "a limit",
                0,
                1,
                0,
                0,
                NULL,
                0,
                "",
                "",
                0,
                7},
               3.0};

/* Has the next value of weft_value_type. */
static int32_t describe_unknown_type(const weft_describe* sink, weft_error* error) {
  weft_parameter unknown = parameter.known;
  (void)error;
  unknown.default_value.type = 99;
  sink->parameter(sink->context, &unknown);
  sink->record(sink->context, "correspondences/1");
  sink->record(sink->context, "inlier_mask/1");
  return WEFT_OK;
}

static int32_t describe(const weft_describe* sink, weft_error* error) {
  (void)error;
  sink->parameter(sink->context, &parameter.known);
#ifndef VERSION_2
  sink->record(sink->context, "correspondences/1");
  sink->record(sink->context, "inlier_mask/1");
#endif
#if defined(VERSION_2) || defined(BOTH)
  sink->record(sink->context, "correspondences/2");
  sink->record(sink->context, "inlier_mask/2");
#endif
  sink->record(sink->context, "later_depth/1");
  return WEFT_OK;
}

static int32_t create(const weft_create* with, void** self, weft_error* error) {
  (void)with;
  (void)error;
  *self = &instance;
  return WEFT_OK;
}

static int32_t prepare(void* self, const weft_call* call, const weft_record* inputs, uint64_t count,
                       weft_error* error) {
  (void)self;
  (void)call;
  (void)inputs;
  (void)count;
  (void)error;
  return WEFT_OK;
}

/* Keeps all; allocates an array and a record unknown to 1.0, and continues if refused. */
static int32_t process(void* self, const weft_call* call, const weft_record* inputs, uint64_t count,
                       weft_error* error) {
  const int64_t* length = NULL;
  (void)self;
  (void)error;
  for (uint64_t i = 0; i < count; ++i) {
    for (uint64_t j = 0; j < inputs[i].count; ++j) {
      if (strcmp(inputs[i].arrays[j].name, "kept") == 0) length = inputs[i].arrays[j].shape;
    }
  }
  if (length == NULL) return WEFT_ERROR;
  uint8_t* kept = weft_alloc(call, "inlier_mask", "inlier_mask/1", "kept", WEFT_U8, 1, length);
  double* score = weft_alloc(call, "inlier_mask", "inlier_mask/1", "score", WEFT_F64, 1, length);
  if (kept == NULL || score == NULL) return WEFT_ERROR;
  const void* depth_m =
      weft_alloc(call, "later_depth", "later_depth/1", "depth_m", WEFT_F32, 1, length);
  for (int64_t i = 0; i < length[0]; ++i) {
    kept[i] = 1;
    score[i] = depth_m == NULL ? 0.5 : 0.25;
  }
  return WEFT_OK;
}

static void destroy(void* self) { (void)self; }
static const void* get_extension(const weft_component* component, const char* name) {
  (void)component;
  return strcmp(name, "weft.later/1") == 0 ? &instance : NULL;
}

static const struct {
  weft_component known;
  const char* unknown;
} component = {{sizeof component, 1u << 15, ID, "1.0.0", "Comes from a later version.", "",
                "Apache-2.0", "exact", "", "later_depth", "later_depth", 1, describe, create,
                prepare, process, destroy, get_extension},
               "?"};

/* Has a role that came later. */
static const weft_component later = {sizeof later,
                                     0,
                                     "tracks/kept.later",
                                     "1.0.0",
                                     "Has a role that came later.",
                                     "",
                                     "Apache-2.0",
                                     "exact",
                                     "",
                                     "",
                                     "",
                                     1,
                                     describe,
                                     create,
                                     prepare,
                                     process,
                                     destroy,
                                     get_extension};

/* Has a parameter of a type that came later. */
static const weft_component unknown_type = {sizeof unknown_type,
                                            0,
                                            "filters/kept.unknown_type",
                                            "1.0.0",
                                            "Has a parameter of a type that came later.",
                                            "",
                                            "Apache-2.0",
                                            "exact",
                                            "",
                                            "",
                                            "",
                                            1,
                                            describe_unknown_type,
                                            create,
                                            prepare,
                                            process,
                                            destroy,
                                            get_extension};

static const weft_component* const components[] = {&component.known, &later,
#ifdef NEWER
                                                   &unknown_type
#endif
};

struct later_table {
  weft_library_table known;
  uint64_t unknown[4];
};
/* Under another name in C, where the symbol is declared with the length of today. */
extern WEFT_EXPORT const struct later_table later_library __asm__("weft_library");
const struct later_table later_library = {{WEFT_ABI_MAGIC,
                                           WEFT_ABI_MAJOR,
                                           SDK_MINOR,
                                           sizeof(struct later_table),
                                           sizeof components / sizeof *components,
                                           WEFT_ABI_NAME,
                                           components,
                                           "",
                                           "synthetic 1.99",
                                           NEEDS_MINOR,
                                           7,
                                           1u << 15,
                                           {1, 2, 3, 4}},
                                          {5, 6, 7, 8}};
