/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The binary contract between the host and a plugin library, in C99. docs/abi.md says what is
 * promised of it, and for how long.
 *
 * Rules that hold for every function below:
 *  - C linkage, never throws, returns a weft_status;
 *  - text is UTF-8 and NUL-terminated; text inside arrays is u8 [n] without NUL;
 *  - pointers passed in are valid until the function returns, read-only unless said, and never null
 *    unless said; a count of 0 goes with any pointer;
 *  - one call at a time per instance, from any thread; create and destroy may run concurrently;
 *  - of the host's functions, [call] marks those for the thread that was called, and [any] those
 *    for any thread until the call returns.
 * Structs that begin with struct_size grow at their end: whoever fills one writes its own size, and
 * whoever reads it uses no more than that. All others have room in `reserved`, which is zero.
 * Authors of plugins in C++ do not read this file: they include one header of weft/sdk.
 */
#ifndef WEFT_ABI_H_
#define WEFT_ABI_H_

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define WEFT_ABI_MAGIC 0x54464557u /* "WEFT" */
#define WEFT_ABI_MAJOR 1
#define WEFT_ABI_MINOR 0
#define WEFT_MAX_DIMENSIONS 6

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "Weft records are little-endian"
#endif

typedef enum weft_status {
  WEFT_OK = 0,
  WEFT_DEGENERATE = 1, /* outputs are usable but flagged; error->message says why */
  WEFT_NO_RESULT = 2,  /* the data do not determine an answer; error->message says why */
  WEFT_ERROR = 3,
  WEFT_CANCELLED = 4,
  WEFT_END = 5 /* of sources: there are no more frames; error->message says why */
} weft_status;

/* What weft_error.code says: as weft::Errc. */
typedef enum weft_code {
  WEFT_CODE_NO_RESULT = 1,
  WEFT_CODE_INVALID_VALUE = 2, /* an argument or parameter outside its legal range */
  WEFT_CODE_INVALID_DATA = 3,  /* NaN, wrong shape or inconsistent content of a record or file */
  WEFT_CODE_NOT_FOUND = 4,
  WEFT_CODE_IO = 5,
  WEFT_CODE_SYNTAX = 6,       /* a text that cannot be parsed */
  WEFT_CODE_INCOMPATIBLE = 7, /* wrong ABI, missing symbol, missing processor feature */
  WEFT_CODE_UNSUPPORTED = 8,  /* legal, but this component cannot do it */
  WEFT_CODE_PLUGIN_FAILURE = 9,
  WEFT_CODE_CANCELLED = 10,
  WEFT_CODE_NO_MEMORY = 11,
  WEFT_CODE_END = 12 /* a source has no more frames */
} weft_code;

typedef enum weft_dtype {
  WEFT_U8 = 1,
  WEFT_I8 = 2,
  WEFT_U16 = 3,
  WEFT_I16 = 4,
  WEFT_I32 = 5,
  WEFT_I64 = 6,
  WEFT_F32 = 7,
  WEFT_F64 = 8
} weft_dtype;

typedef enum weft_memory { WEFT_HOST = 0, WEFT_SHARED = 1, WEFT_DEVICE = 2 } weft_memory;

typedef struct weft_array {
  const char* name;
  int32_t dtype; /* weft_dtype */
  int32_t ndim;  /* 0 for a scalar */
  int64_t shape[WEFT_MAX_DIMENSIONS];
  int64_t stride[WEFT_MAX_DIMENSIONS]; /* bytes; [0] of two axes or more: padded, or negative */
  void* data;                          /* aligned to its elements; null in device memory */
  void* owner; /* the host's own, to be passed on as it is; null in records that a plugin makes */
  uint64_t handle; /* device memory only: by which its library knows it; not 0 */
  int32_t memory; /* weft_memory; an array in device memory reaches only the library that made it */
  int32_t reserved_word;
  uint64_t reserved[2];
} weft_array;

typedef struct weft_record {
  const char* slot;  /* the input or output it stands in: "correspondences", "previous.shape" */
  const char* type;  /* catalogue name and version: "correspondences/1" */
  uint64_t revision; /* equal only for equal content; caches key on it; 0 is unknown */
  uint64_t producer; /* component handle of the producer, for warps; else 0 */
  uint64_t count;
  const weft_array* arrays;
  int64_t frame;  /* that it was made in, or WEFT_NO_FRAME */
  int32_t view;   /* of several cameras; 0 */
  int32_t object; /* of several surfaces; 0 */
  uint64_t reserved[3];
} weft_record;

#define WEFT_NO_FRAME (-1)

/* Filled by whoever is called; the caller has set struct_size and the rest to zero. */
typedef struct weft_error {
  uint32_t struct_size;
  int32_t code; /* weft_code; 0 is unset */
  char where[128];
  char message[1024]; /* cut on a character boundary */
  char subject[64];   /* the parameter, input or array that it is about, or "" */
} weft_error;

typedef enum weft_value_type {
  WEFT_VALUE_F64 = 1,
  WEFT_VALUE_I64 = 2,
  WEFT_VALUE_BOOL = 3,        /* u8 */
  WEFT_VALUE_CHOICE = 4,      /* const char* */
  WEFT_VALUE_TEXT = 5,        /* const char* */
  WEFT_VALUE_INPUT_PATH = 6,  /* const char*, absolute */
  WEFT_VALUE_OUTPUT_PATH = 7, /* const char*, absolute */
  WEFT_VALUE_COMPONENT = 8,   /* uint64_t handle for weft_host.invoke; in describe the default id */
  WEFT_VALUE_LABELS = 9       /* const char* key, text, key, text ... */
} weft_value_type;

/* A typed parameter value; count > 1 or is_vector for vectors. */
typedef struct weft_value {
  const char* name;
  int32_t type; /* weft_value_type */
  int32_t is_vector;
  uint64_t count;
  const void* data; /* double, int64_t, uint8_t, const char* or uint64_t [count] */
  uint64_t reserved[2];
} weft_value;

#define WEFT_PARAMETER_DEPRECATED 1u /* help says what to use instead */

/* The declaration of a parameter, given to weft_describe.parameter. */
typedef struct weft_parameter {
  uint32_t struct_size;
  uint32_t flags;           /* WEFT_PARAMETER_*; bits 0 to 15 may be ignored */
  weft_value default_value; /* name and type stand here; a component's default is its id as text */
  const char* unit;         /* "" where there is none */
  const char* help;
  double minimum; /* of numbers, inclusive; minus infinity where there is none */
  double maximum; /* likewise; plus infinity */
  const char* const* choices;
  uint64_t choice_count;
  const char* role; /* of a component parameter, else "" */
  const char* was;  /* its name in older versions, which is still understood, or "" */
  int32_t required;
  int32_t reserved;
} weft_parameter;

#define WEFT_FIELD_OPTIONAL 1u   /* bits 0 to 15 of flags may be ignored */
#define WEFT_FIELD_MAY_BE_NAN 2u /* NaN marks a missing value */

/* One array of a record type of a vendor, given to weft_describe.field. */
typedef struct weft_field {
  uint32_t struct_size;
  uint32_t flags; /* WEFT_FIELD_* */
  const char* name;
  const char* shape;   /* as docs/records.md writes it: "" for a scalar, "N,2" */
  const char* unit;    /* unit and frame, "" where there is none */
  const char* meaning; /* one line */
  int32_t dtype;       /* weft_dtype */
  int32_t reserved;
} weft_field;

typedef struct weft_describe {
  uint32_t struct_size;
  uint32_t reserved;
  void* context; /* the host's own */
  void (*parameter)(void* context, const weft_parameter* parameter);
  /* Each record type, with its version, that the component reads or makes: "correspondences/1",
   * "vendor.depth/1". */
  void (*record)(void* context, const char* type);
  /* Each array of those types that are a vendor's: `type` is "vendor.name/version". */
  void (*field)(void* context, const char* type, const weft_field* field);
} weft_describe;

struct weft_host;

/* What a component is made from. */
typedef struct weft_create {
  uint32_t struct_size;
  uint32_t reserved;
  const struct weft_host* host; /* of which only get_extension may be called */
  const weft_value* values;
  uint64_t count;
} weft_create;

/* What a call brings; valid until the call returns. */
typedef struct weft_call {
  uint32_t struct_size;
  int32_t method; /* WEFT_SOURCE_*, WEFT_WARP_*, WEFT_SINK_*; 0 of all other roles */
  const struct weft_host* host;
  void* context;  /* the host's own */
  uint64_t seed;  /* of this component in this frame */
  uint64_t frame; /* 2^64-1 for offline calls */
  int32_t threads;
  int32_t reserved;
} weft_call;

/* Methods of roles that have several. */
#define WEFT_SOURCE_OPEN 0
#define WEFT_SOURCE_COUNT 1
#define WEFT_SOURCE_READ 2
#define WEFT_WARP_FIT 0
#define WEFT_WARP_EVALUATE 1
#define WEFT_SINK_OPEN 0
#define WEFT_SINK_WRITE 1
#define WEFT_SINK_FINISH 2

/* A call of another component. */
typedef struct weft_invocation {
  uint32_t struct_size;
  int32_t method;
  uint64_t component; /* its handle: the value of a parameter, or a warp's producer */
  const weft_record* inputs;
  uint64_t input_count;
  uint64_t frame; /* that it is about: weft_call.frame, or another one of a source */
  uint64_t draw;  /* 0; other numbers give other seeds, where one call of a frame has several */
  const weft_record* outputs; /* set by the host, and alive until the calling process() returns */
  uint64_t output_count;
} weft_invocation;

typedef struct weft_host {
  uint32_t struct_size;
  uint32_t reserved;
  /* [call] A 64-byte aligned, contiguous, C-order array owned by the host, as part of the output
   * record `slot` of type `type`. It is not cleared: who asks for it writes all of it, and a host
   * that is built for debugging or with a sanitizer has filled it with 0xFF bytes, NaN where it is
   * of floating point. Asking again for the same array replaces it. Null when refused. */
  void* (*alloc)(const weft_call* call, const char* slot, const char* type, const char* array,
                 int32_t dtype, int32_t ndim, const int64_t* shape);
  /* [any] Non-zero when the plugin should return WEFT_CANCELLED; ask at least every 5 ms. */
  int32_t (*cancelled)(const weft_call* call);
  /* [any] level: 0 debug, 1 info, 2 warning. */
  void (*log)(const weft_call* call, int32_t level, const char* text);
  /* [call] Calls another component. */
  int32_t (*invoke)(const weft_call* call, weft_invocation* invocation, weft_error* error);
  /* [call] As alloc, for an array whose contents the library keeps in device memory: the host
   * retains the handle. Zero when refused, also to a component without WEFT_DEVICE_MEMORY. */
  int32_t (*adopt)(const weft_call* call, const char* slot, const char* type, const char* array,
                   int32_t dtype, int32_t ndim, const int64_t* shape, uint64_t handle);
  /* [any] What a host can do beyond this table, by name and version; null where it cannot. */
  const void* (*get_extension)(const char* name);
} weft_host;

/* Extension of components that keep arrays in device memory. Components that return the same table
 * read each other's arrays where they lie; everyone else is given a copy. From any thread, and as
 * long as the process lives. */
#define WEFT_DEVICE_MEMORY "weft.device_memory/1"
typedef struct weft_device_memory {
  uint32_t struct_size;
  uint32_t reserved;
  /* References to what a handle stands for; it is free with the last one. */
  void (*retain)(uint64_t handle);
  void (*release)(uint64_t handle);
  /* Writes the contents, contiguous in C order, of the array's own dtype. Waits until they are
   * there, or the call for which they are fetched is cancelled; it is null where there is none. */
  int32_t (*download)(const weft_call* call, uint64_t handle, void* to, uint64_t bytes,
                      weft_error* error);
} weft_device_memory;

/* Extension of components that compute on devices: one line of text for each that they could use,
 * in the order of their indices. */
#define WEFT_DEVICES "weft.devices/1"
typedef struct weft_devices {
  uint32_t struct_size;
  uint32_t reserved;
  int32_t (*list)(void* context, void (*device)(void* context, const char* text),
                  weft_error* error);
} weft_devices;

/* Extension of components whose parameters can be wrong in a way that their declarations do not
 * tell: files, patterns, parameters that exclude one another. Called after create (which was given
 * no nested components) and before prepare; it may read headers and small files, but must neither
 * block nor compute. Each mistake names the parameter that it is about; one that begins with
 * "warning: " is something legal, but doubtful. */
#define WEFT_CHECK "weft.check/1"
typedef struct weft_check {
  uint32_t struct_size;
  uint32_t reserved;
  int32_t (*check)(void* self, void* context,
                   void (*mistake)(void* context, const char* parameter, const char* message),
                   weft_error* error);
} weft_check;

/* Extension of components with one number that decides how strict they are: values of it over which
 * a ROC curve runs. It is read when the library is described and never asked for in a run. */
#define WEFT_SWEEP "weft.sweep/1"
typedef struct weft_sweep {
  uint32_t struct_size;
  uint32_t reserved;
  const char* parameter; /* a number that the component declares */
  const double* values;  /* ascending, in its range, from one end of the curve to the other */
  uint64_t count;        /* at least 2 */
} weft_sweep;

/* Extension of components that had better not share the process of a run, as those that bring an
 * interpreter: their stage has a process of its own unless the pipeline says `isolate: none`. It is
 * read when the library is described and never asked for in a run. */
#define WEFT_ISOLATION "weft.isolation/1"
typedef struct weft_isolation {
  uint32_t struct_size;
  uint32_t reserved;
} weft_isolation;

/* Extension of sinks at which somebody steers the run. Both functions are called from any thread,
 * also beside process. */
#define WEFT_STEERING "weft.steering/1"
typedef struct weft_steering {
  uint32_t struct_size;
  uint32_t reserved;
  /* Hands over what was wished for since it was last called, each wish once; `number` is the
   * sink's own. Texts: "set PATH=VALUE" as of `weft run --set`, "pause", "step", "resume", "stop".
   */
  int32_t (*take_wishes)(void* self, void* context,
                         void (*wish)(void* context, uint64_t number, const char* text),
                         weft_error* error);
  /* What became of a wish: `frame` is the first one for which it holds; `refusal` is "" where it is
   * granted. */
  int32_t (*answer)(void* self, uint64_t number, uint64_t frame, const char* refusal,
                    weft_error* error);
} weft_steering;

typedef struct weft_component {
  uint32_t struct_size;
  uint32_t flags; /* WEFT_FLAG_* */
  const char* id; /* "filters/myneighbor" */
  const char* version;
  const char* summary;
  const char* reference;
  const char* licence;
  const char* determinism; /* "exact" or "tolerance" */
  const char* needs;       /* inputs required beyond those of the role, separated by spaces */
  const char* reads;       /* inputs used when present */
  const char* produces;    /* outputs, where the role leaves a choice; else "" */
  uint64_t methods;        /* those of its role that it has: bit n stands for method n */
  int32_t (*describe)(const weft_describe* sink, weft_error* error);
  int32_t (*create)(const weft_create* with, void** self, weft_error* error);
  int32_t (*prepare)(void* self, const weft_call* call, const weft_record* inputs,
                     uint64_t input_count, weft_error* error);
  int32_t (*process)(void* self, const weft_call* call, const weft_record* inputs,
                     uint64_t input_count, weft_error* error);
  void (*destroy)(void* self);
  const void* (*get_extension)(const char* name); /* null means absent */
} weft_component;

/* Of components and libraries: a host may ignore bits 0 to 15 that it does not know, and refuses
 * what has one of bits 16 to 31 that it does not know. */
#define WEFT_FLAG_RANDOM 1u     /* draws from the seed */
#define WEFT_FLAG_USES_TRUTH 2u /* may read ground_truth */

typedef struct weft_library_table {
  uint32_t magic;
  uint16_t abi_major; /* must be the host's */
  uint16_t sdk_minor; /* WEFT_ABI_MINOR of the header that it was built with */
  uint32_t struct_size;
  uint32_t count;
  const weft_component* const* components;
  const char* isa; /* processor features assumed by the compiler, separated by spaces */
  const char* compiler;
  uint16_t needs_minor; /* the oldest host that it works with */
  uint16_t reserved_half;
  uint32_t flags;
  uint64_t reserved[4];
} weft_library_table;

#ifndef WEFT_EXPORT
#define WEFT_EXPORT __attribute__((visibility("default")))
#endif

/* The one symbol that a library exports. */
extern WEFT_EXPORT const weft_library_table weft_library;

#ifdef __cplusplus
}
#endif

#endif /* WEFT_ABI_H_ */
