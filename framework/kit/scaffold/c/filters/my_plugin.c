/* SPDX-License-Identifier: Apache-2.0 */
/* Keeps a match that lies where one affine map of the whole template puts it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <weft/abi.h>

#define FEWEST 4 /* matches; three lie on an affine map whatever they are */
#define ROUNDS 30

static const double usual_tolerance_px = 30.0;
static const double nothing_px = 0.1; /* added to residuals, so that no weight is infinite */
static const double on_a_line = 1e-9; /* ratio of the spread across the line to that along it */
static const char *const slot = "inlier_mask", *const type = "inlier_mask/1";

static int32_t say(weft_error* error, int32_t status, int32_t code, const char* message) {
  error->code = code;
  snprintf(error->message, sizeof(error->message), "%s", message);
  return status;
}

/* Declares each parameter and each record; the manifest is made of it. */
static int32_t describe(const weft_describe* sink, weft_error* error) {
  const weft_parameter tolerance = {
      .struct_size = sizeof(weft_parameter),
      .default_value = {"tolerance_px", WEFT_VALUE_F64, 0, 1, &usual_tolerance_px, {0}},
      .unit = "px",
      .help = "kept if so near to where the affine map puts it",
      .minimum = 0.0,
      .maximum = 1000.0,
      .role = "",
      .was = ""};
  (void)error;
  sink->parameter(sink->context, &tolerance);
  sink->record(sink->context, "correspondences/1");
  sink->record(sink->context, type);
  return WEFT_OK;
}

static int32_t create(const weft_create* with, void** self, weft_error* error) {
  double* tolerance_px = malloc(sizeof(double));
  if (tolerance_px == NULL) return say(error, WEFT_ERROR, WEFT_CODE_NO_MEMORY, "out of memory");
  *tolerance_px = usual_tolerance_px;
  for (uint64_t i = 0; i < with->count; ++i) {
    const weft_value* value = &with->values[i];
    if (strcmp(value->name, "tolerance_px") != 0) continue;
    const int is_number = value->type == WEFT_VALUE_F64 && !value->is_vector;
    if (is_number) *tolerance_px = *(const double*)value->data;
    if (is_number && *tolerance_px >= 0.0 && *tolerance_px <= 1000.0) continue;
    free(tolerance_px);
    strcpy(error->subject, "tolerance_px");
    return say(error, WEFT_ERROR, WEFT_CODE_INVALID_VALUE, "is no number from 0 to 1000");
  }
  *self = tolerance_px;
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

/* A row of an array [N,2]; rows of an input may be padded. */
static const double* row_of(const weft_array* array, int64_t i) {
  return (const double*)(const void*)((const char*)array->data + i * array->stride[0]);
}

/* The matches that the filter judges: those that no earlier filter rejected. */
typedef struct {
  int64_t count;
  int64_t* index;
  double (*from)[3]; /* (u - mean, v - mean, 1), in units of their spread */
  double (*to)[2];   /* px */
  double* residual;  /* px */
} matches;

static int allocate(matches* all, int64_t n) {
  const size_t room = (size_t)n + 1;
  all->index = malloc(room * sizeof(*all->index));
  all->from = malloc(room * sizeof(*all->from));
  all->to = malloc(room * sizeof(*all->to));
  all->residual = malloc(room * sizeof(*all->residual));
  return all->index != NULL && all->from != NULL && all->to != NULL && all->residual != NULL;
}

static void release(matches* all) {
  free(all->index);
  free(all->from);
  free(all->to);
  free(all->residual);
}

static void take(matches* all, const weft_array* from, const weft_array* to,
                 const weft_array* kept) {
  double mean[2] = {0.0, 0.0}, spread = 0.0;
  for (int64_t i = 0; i < kept->shape[0]; ++i) {
    if (((const uint8_t*)kept->data)[i * kept->stride[0]] == 0) continue;
    const int64_t k = all->count++;
    all->index[k] = i;
    for (int axis = 0; axis < 2; ++axis) {
      all->from[k][axis] = row_of(from, i)[axis];
      all->to[k][axis] = row_of(to, i)[axis];
      mean[axis] += all->from[k][axis];
    }
    all->from[k][2] = 1.0;
  }
  for (int64_t k = 0; k < all->count; ++k) {
    for (int axis = 0; axis < 2; ++axis) {
      all->from[k][axis] -= mean[axis] / (double)all->count;
      spread = fmax(spread, fabs(all->from[k][axis]));
    }
  }
  for (int64_t k = 0; k < all->count && spread > 0.0; ++k) {
    all->from[k][0] /= spread;
    all->from[k][1] /= spread;
  }
}

/* Solves m x = b of 3 equations with 2 right-hand sides by elimination with full pivots. Omits the
 * components that m does not determine. Returns the rank of m. */
static int solve(double m[3][3], double b[3][2], double x[3][2]) {
  int order[3] = {0, 1, 2}, rank = 0;
  double largest = 0.0;
  for (int step = 0; step < 3; ++step) {
    int row = step, column = step;
    for (int i = step; i < 3; ++i) {
      for (int j = step; j < 3; ++j) {
        if (fabs(m[i][j]) > fabs(m[row][column])) row = i, column = j;
      }
    }
    if (step == 0) largest = fabs(m[row][column]);
    if (fabs(m[row][column]) <= on_a_line * on_a_line * largest) break;
    for (int j = 0; j < 3; ++j) {
      const double swapped = m[step][j];
      m[step][j] = m[row][j], m[row][j] = swapped;
    }
    for (int side = 0; side < 2; ++side) {
      const double swapped = b[step][side];
      b[step][side] = b[row][side], b[row][side] = swapped;
    }
    for (int i = 0; i < 3; ++i) {
      const double swapped = m[i][step];
      m[i][step] = m[i][column], m[i][column] = swapped;
    }
    const int was = order[step];
    order[step] = order[column], order[column] = was;
    for (int i = step + 1; i < 3; ++i) {
      const double factor = m[i][step] / m[step][step];
      for (int j = step; j < 3; ++j) m[i][j] -= factor * m[step][j];
      for (int side = 0; side < 2; ++side) b[i][side] -= factor * b[step][side];
    }
    ++rank;
  }
  for (int i = 2; i >= 0; --i) {
    for (int side = 0; side < 2; ++side) {
      double left = i < rank ? b[i][side] : 0.0;
      for (int j = i + 1; j < rank; ++j) left -= m[i][j] * x[order[j]][side];
      x[order[i]][side] = i < rank ? left / m[i][i] : 0.0;
    }
  }
  return rank;
}

/* One round: the map of least squares with weights 1 / residual, and the residuals that it leaves.
 * Returns the rank of the system. */
static int fit(matches* all) {
  double m[3][3] = {{0}}, b[3][2] = {{0}}, map[3][2] = {{0}};
  for (int64_t k = 0; k < all->count; ++k) {
    const double weight = 1.0 / (all->residual[k] + nothing_px);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) m[i][j] += weight * all->from[k][i] * all->from[k][j];
      for (int side = 0; side < 2; ++side)
        b[i][side] += weight * all->from[k][i] * all->to[k][side];
    }
  }
  const int rank = solve(m, b, map);
  for (int64_t k = 0; k < all->count; ++k) {
    double off[2];
    for (int side = 0; side < 2; ++side) {
      off[side] = all->to[k][side];
      for (int i = 0; i < 3; ++i) off[side] -= all->from[k][i] * map[i][side];
    }
    all->residual[k] = sqrt(off[0] * off[0] + off[1] * off[1]);
  }
  return rank;
}

static int32_t judge(matches* all, const weft_call* call, int64_t n, double tolerance_px,
                     weft_error* error) {
  if (all->count < FEWEST) {
    char message[100];
    snprintf(message, sizeof(message), "%lld matches are left; at least %d are needed",
             (long long)all->count, FEWEST);
    return say(error, WEFT_NO_RESULT, 0, message);
  }
  int rank = 0;
  for (int64_t k = 0; k < all->count; ++k) all->residual[k] = 1.0 - nothing_px; /* weights of 1 */
  for (int round = 0; round < ROUNDS; ++round) {
    if (call->host->cancelled(call)) return WEFT_CANCELLED;
    rank = fit(all);
  }
  uint8_t* kept = weft_alloc(call, slot, type, "kept", WEFT_U8, 1, &n);
  double* score = weft_alloc(call, slot, type, "score", WEFT_F64, 1, &n);
  double* mean_px = weft_alloc(call, slot, type, "diag.mean_residual_px", WEFT_F64, 0, NULL);
  if (kept == NULL || score == NULL || mean_px == NULL) {
    return say(error, WEFT_ERROR, WEFT_CODE_NO_MEMORY, "the host gives no memory for the mask");
  }
  *mean_px = 0.0;
  for (int64_t i = 0; i < n; ++i) kept[i] = 0, score[i] = 0.0; /* alloc does not clear memory */
  for (int64_t k = 0; k < all->count; ++k) {
    kept[all->index[k]] = all->residual[k] <= tolerance_px;
    score[all->index[k]] = 1.0 / (1.0 + all->residual[k]);
    *mean_px += all->residual[k] / (double)all->count;
  }
  if (rank < 3) return say(error, WEFT_DEGENERATE, 0, "the matches lie on a line or in one place");
  return WEFT_OK;
}

static int32_t process(void* self, const weft_call* call, const weft_record* inputs, uint64_t count,
                       weft_error* error) {
  if (call->method != 0) return say(error, WEFT_ERROR, WEFT_CODE_UNSUPPORTED, "has one method");
  const weft_array *from = NULL, *to = NULL, *kept = NULL;
  for (uint64_t i = 0; i < count; ++i) {
    if (strcmp(inputs[i].slot, "correspondences") != 0) continue;
    from = array_of(&inputs[i], "template_px", WEFT_F64);
    to = array_of(&inputs[i], "image_px", WEFT_F64);
    kept = array_of(&inputs[i], "kept", WEFT_U8);
  }
  if (from == NULL || to == NULL || kept == NULL) {
    return say(error, WEFT_ERROR, WEFT_CODE_INVALID_DATA,
               "the matches lack template_px, image_px or kept");
  }
  matches all = {0, NULL, NULL, NULL, NULL};
  int32_t status = WEFT_ERROR;
  if (allocate(&all, kept->shape[0])) {
    take(&all, from, to, kept);
    status = judge(&all, call, kept->shape[0], *(const double*)self, error);
  } else {
    say(error, status, WEFT_CODE_NO_MEMORY, "out of memory");
  }
  release(&all);
  return status;
}

static const weft_component component = {
    .struct_size = sizeof(weft_component),
    .id = "filters/my_plugin",
    .version = "1.0.0",
    .summary = "Keeps matches that lie where one affine map of the template puts them.",
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
    .isa = "", /* CPU features beyond x86-64 that -m options enable, such as "avx2 fma" */
    .compiler = "cc " __VERSION__};
