/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The binary contract between the host and a plugin library, version 1.0, in C99. docs/abi.md is
 * its specification: life cycle, ownership, threads, limits and versions.
 *
 * Rules that hold for every function below:
 *  - C linkage; no exception leaves it; an int32_t result is a weft_status;
 *  - text is UTF-8 and NUL-terminated; text inside arrays is u8 [n] without NUL;
 *  - pointers are read-only, not null and valid until the function returns, unless stated
 *    otherwise; with a count of 0 the pointer may be null and is not read;
 *  - one call at a time per instance, from any thread; create and destroy may run concurrently;
 *  - host functions marked [call] may be called by the thread of the call, those marked [any] by
 *    any thread until the call returns.
 * Structs that begin with struct_size grow at their end. The writer sets its own size, in bytes;
 * the reader uses no more than that. All other structs have room in `reserved`: a writer sets it to
 * zero, a reader ignores it, and a component that passes on a record or an array copies it.
 * Authors of C++ plugins do not need this file: they include one header of weft/sdk.
 */
#ifndef WEFT_ABI_H_
#define WEFT_ABI_H_

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define WEFT_ABI_MAGIC 0x31544657u /* "WFT1" */
#define WEFT_ABI_MAJOR 1
#define WEFT_ABI_MINOR 0
#define WEFT_ABI_NAME "weft.plugin/1" /* equal in all libraries and hosts of 1.x */
#define WEFT_MAX_DIMENSIONS 6

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "Weft records are little-endian"
#endif
#if UINTPTR_MAX != UINT64_MAX
#error "Weft plugins are 64-bit"
#endif

typedef enum weft_status {
  WEFT_OK = 0,
  WEFT_DEGENERATE = 1, /* outputs are usable but flagged; error->message is the reason */
  WEFT_NO_RESULT = 2,  /* the data do not determine an answer; error->message is the reason */
  WEFT_ERROR = 3,
  WEFT_CANCELLED = 4,
  WEFT_END = 5 /* returned by sources: there are no more frames; error->message is the reason */
} weft_status;

/* Values of weft_error.code, equal to weft::Errc. */
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
  WEFT_F64 = 8,
  WEFT_F16 = 9, /* IEEE 754 binary16 */
  WEFT_U32 = 10,
  WEFT_U64 = 11
} weft_dtype;

typedef enum weft_memory {
  WEFT_HOST = 0,   /* memory of this process */
  WEFT_SHARED = 1, /* memory that another process maps too; used like WEFT_HOST */
  WEFT_DEVICE = 2  /* memory of a device; components with the same weft_device_memory read it */
} weft_memory;

/* One array of a record. Inputs are read-only and valid until the call returns. */
typedef struct weft_array {
  const char* name;                   /* 1 to 100 of A-Z a-z 0-9 _ - . */
  int32_t dtype;                      /* weft_dtype */
  int32_t ndim;                       /* number of axes, 0 to WEFT_MAX_DIMENSIONS; 0 for a scalar */
  int64_t shape[WEFT_MAX_DIMENSIONS]; /* elements per axis; the first ndim count */
  int64_t stride[WEFT_MAX_DIMENSIONS]; /* bytes; [0] of two or more axes: padded or negative */
  void* data;      /* element [0, ...], aligned to its size; null only in device memory */
  void* owner;     /* private to the host, copied when passed on; null in a plugin's own arrays */
  uint64_t handle; /* device memory: the identifier in its library, not 0; else 0 */
  int32_t memory;  /* weft_memory */
  int32_t reserved_word;
  uint64_t reserved[2];
} weft_array;

/* One input, output or answer. In one call a slot occurs at most once, except for slots that
 * docs/records.md marks as lists. Later versions can pass one record per view and object to
 * components that request it. */
typedef struct weft_record {
  const char* slot;         /* name of the input or output: "correspondences", "previous.shape" */
  const char* type;         /* catalogue name and version: "correspondences/1" */
  uint64_t revision;        /* equal only for equal content, for caches; 0: unknown */
  uint64_t producer;        /* component handle of the producer, for warps; else 0 */
  uint64_t count;           /* length of arrays */
  const weft_array* arrays; /* [count] with different names */
  int64_t frame;            /* index of the frame in which it was made, or WEFT_NO_FRAME */
  int32_t view;             /* index of the camera; 0 in this version */
  int32_t object;           /* index of the surface; 0 in this version */
  uint64_t reserved[3];
} weft_record;

#define WEFT_NO_FRAME (-1)

/* Filled by the callee. The caller sets struct_size and all other members to zero. */
typedef struct weft_error {
  uint32_t struct_size;
  int32_t code;       /* weft_code; 0 is unset */
  char where[128];    /* the component or file that the error concerns, or "" */
  char message[1024]; /* one sentence; cut on a character boundary */
  char subject[64];   /* the parameter, input or array that the error concerns, or "" */
} weft_error;

typedef enum weft_value_type {
  WEFT_VALUE_F64 = 1,
  WEFT_VALUE_I64 = 2,
  WEFT_VALUE_BOOL = 3,        /* u8: 0 or 1 */
  WEFT_VALUE_CHOICE = 4,      /* const char* */
  WEFT_VALUE_TEXT = 5,        /* const char* */
  WEFT_VALUE_INPUT_PATH = 6,  /* const char*, absolute */
  WEFT_VALUE_OUTPUT_PATH = 7, /* const char*, absolute */
  WEFT_VALUE_COMPONENT = 8,   /* uint64_t handle for weft_host.invoke; in describe the default id */
  WEFT_VALUE_LABELS = 9       /* const char* key, text, key, text ... */
} weft_value_type;

/* A typed parameter value. Single values have count 1; lists have any count, including 0; labels
 * have an even count. */
typedef struct weft_value {
  const char* name;  /* the name of the parameter */
  int32_t type;      /* weft_value_type */
  int32_t is_vector; /* 1 for a list of numbers or texts, else 0 */
  uint64_t count;    /* length of data */
  const void* data;  /* double, int64_t, uint8_t, const char* or uint64_t [count] */
  uint64_t reserved[2];
} weft_value;

#define WEFT_PARAMETER_DEPRECATED 1u /* files that set it get a warning: help names what to use */
#define WEFT_PARAMETER_PROMINENT 2u  /* one of those that users change most; shown first */

/* The declaration of a parameter, given to weft_describe.parameter. */
typedef struct weft_parameter {
  uint32_t struct_size;
  uint32_t flags;           /* WEFT_PARAMETER_*; bits 0 to 15 may be ignored */
  weft_value default_value; /* with name and type; a component's default is its id as text */
  const char* unit;         /* "" if there is none */
  const char* help;         /* one line, a noun phrase */
  double minimum;          /* WEFT_VALUE_F64: in unit, inclusive; minus infinity if there is none */
  double maximum;          /* WEFT_VALUE_F64: in unit, inclusive; plus infinity if there is none */
  int64_t integer_minimum; /* WEFT_VALUE_I64: in unit, inclusive; INT64_MIN if there is none */
  int64_t integer_maximum; /* WEFT_VALUE_I64: in unit, inclusive; INT64_MAX if there is none */
  const char* const* choices; /* [choice_count] legal words: of a choice, or beside a path */
  uint64_t choice_count;      /* length of choices */
  const char* role;           /* the role of a component parameter, else "" */
  const char* was;            /* former name, accepted as an alias, or "" */
  int32_t required;           /* 1 if the parameter has no default, else 0 */
  int32_t reserved;
} weft_parameter;

#define WEFT_FIELD_OPTIONAL 1u   /* bits 0 to 15 of flags may be ignored */
#define WEFT_FIELD_MAY_BE_NAN 2u /* NaN marks a missing value */

/* One array of a record type of a vendor, given to weft_describe.field. */
typedef struct weft_field {
  uint32_t struct_size;
  uint32_t flags;      /* WEFT_FIELD_* */
  const char* name;    /* the name of the array */
  const char* shape;   /* in the notation of docs/records.md: "" for a scalar, "N,2" */
  const char* unit;    /* unit and frame, "" if there is none */
  const char* meaning; /* one line */
  int32_t dtype;       /* weft_dtype */
  int32_t reserved;
} weft_field;

/* Argument of describe, which calls these functions with `context`. The host copies what it is
 * given. */
typedef struct weft_describe {
  uint32_t struct_size;
  uint32_t reserved;
  void* context; /* private to the host */
  /* Called for each parameter, in the order of the documentation. */
  void (*parameter)(void* context, const weft_parameter* parameter);
  /* Called for each record type, with its version, that the component reads or makes:
   * "correspondences/1", "vendor.depth/1". */
  void (*record)(void* context, const char* type);
  /* Called for each array of a vendor's record type, "vendor.name/version". */
  void (*field)(void* context, const char* type, const weft_field* field);
} weft_describe;

struct weft_host;

/* Arguments of create. */
typedef struct weft_create {
  uint32_t struct_size;
  uint32_t reserved;
  const struct weft_host* host; /* valid until destroy; create calls get_extension only */
  const weft_value* values;     /* [count] a subset of the parameters; others have their defaults */
  uint64_t count;               /* length of values */
  void* context;                /* private to the host, for get_extension; valid in create only */
} weft_create;

#define WEFT_OFFLINE UINT64_MAX /* weft_call.frame of a call outside any frame */

/* Context of a call; valid until the call returns. A plugin changes none of it. */
typedef struct weft_call {
  uint32_t struct_size;
  int32_t method;               /* WEFT_SOURCE_*, WEFT_WARP_*, WEFT_SINK_*; 0 for all other roles */
  const struct weft_host* host; /* valid until destroy */
  void* context;                /* private to the host */
  uint64_t seed;                /* seed of this component in this frame */
  uint64_t frame;               /* index of the frame, from 0, or WEFT_OFFLINE */
  int32_t threads;              /* maximum number of threads, this one included; at least 1 */
  int32_t reserved;
} weft_call;

/* Methods of roles that have several. */
#define WEFT_SOURCE_OPEN 0  /* template and camera */
#define WEFT_SOURCE_COUNT 1 /* the number of frames, where it is known */
#define WEFT_SOURCE_READ 2  /* the frame of weft_call.frame; frames come in any order */
#define WEFT_WARP_FIT 0
#define WEFT_WARP_EVALUATE 1
#define WEFT_SINK_OPEN 0
#define WEFT_SINK_WRITE 1
#define WEFT_SINK_FINISH 2

/* A call of another component: one that is nested in the caller, or the producer of a warp among
 * the inputs of the call or among the answers to it. */
typedef struct weft_invocation {
  uint32_t struct_size;
  int32_t method;             /* as weft_call.method */
  uint64_t component;         /* handle: the value of a parameter, or a warp's producer */
  const weft_record* inputs;  /* [input_count] */
  uint64_t input_count;       /* length of inputs */
  uint64_t frame;             /* index of the frame: weft_call.frame, or another one of a source */
  uint64_t draw;              /* 0; other numbers give other seeds for several calls in one frame */
  const weft_record* outputs; /* [output_count] set by the host, valid until the caller returns */
  uint64_t output_count;      /* set by the host */
} weft_invocation;

/* An array of an output, for weft_host.alloc and adopt. */
typedef struct weft_output {
  uint32_t struct_size;
  int32_t dtype;        /* weft_dtype */
  const char* slot;     /* an output of the method */
  const char* type;     /* the type of its record, with the version */
  const char* array;    /* name of the array */
  const int64_t* shape; /* [ndim] elements per axis */
  int32_t ndim;         /* number of axes, 0 to WEFT_MAX_DIMENSIONS */
  int32_t view;         /* index of the camera; 0 in this version */
  int32_t object;       /* index of the surface; 0 in this version */
  int32_t reserved;
  int64_t frame;   /* index of the frame in which the record was made; WEFT_NO_FRAME: this one */
  uint64_t handle; /* adopt: the identifier in the library, not 0; alloc: 0 */
} weft_output;

/* Functions of the host. The table lives longer than every instance. */
typedef struct weft_host {
  uint32_t struct_size;
  uint16_t abi_major;  /* WEFT_ABI_MAJOR of the host */
  uint16_t abi_minor;  /* WEFT_ABI_MINOR of the host; functions of later versions are absent */
  const char* name;    /* the name of the program, "weft" */
  const char* version; /* the version of the program */
  /* [call] Allocates a 64-byte aligned, contiguous, C-order array owned by the host, as part of an
   * output record. It is not cleared: the caller writes all elements. Debug builds and sanitizer
   * builds of the host fill it with 0xFF bytes (NaN for floating point). A second call for the same
   * array replaces it; the memory of the first stays valid until the call returns. Returns null to
   * refuse what the host cannot store: the caller can then leave the array out or return an error.
   */
  void* (*alloc)(const weft_call* call, const weft_output* output);
  /* [any] Returns non-zero if the plugin should return WEFT_CANCELLED. Call at least every 5 ms. */
  int32_t (*cancelled)(const weft_call* call);
  /* [any] Logs a text. level: 0 debug, 1 info, 2 warning. The host escapes control characters, cuts
   * texts at 4096 bytes and drops what exceeds 100 texts per call. */
  void (*log)(const weft_call* call, int32_t level, const char* text);
  /* [call] Calls another component and sets the outputs of the invocation. */
  int32_t (*invoke)(const weft_call* call, weft_invocation* invocation, weft_error* error);
  /* [call] Like alloc, for an array whose contents the library keeps in device memory. The host
   * retains the handle. Returns zero to refuse: the caller can then use alloc. */
  int32_t (*adopt)(const weft_call* call, const weft_output* output);
  /* [any] Returns an extension of the host by name and version, valid for the lifetime of the
   * process; null if there is none. `context` is that of weft_call or weft_create. */
  const void* (*get_extension)(const struct weft_host* host, void* context, const char* name);
} weft_host;

/* The tables of extensions are valid for the lifetime of the process and equal at every request. */

/* Extension of components that keep arrays in device memory. Components that return the same table
 * read each other's arrays in place; all others get a copy. The functions may be called from any
 * thread for the lifetime of the process. */
#define WEFT_DEVICE_MEMORY "weft.device_memory/1"
typedef struct weft_device_memory {
  uint32_t struct_size;
  uint32_t reserved;
  /* Count the references to a handle; its contents are freed with the last one. */
  void (*retain)(uint64_t handle);
  void (*release)(uint64_t handle);
  /* Writes the contents, contiguous in C order, with the array's dtype. Waits for them until
   * `call` is cancelled; `call` may be null. */
  int32_t (*download)(const weft_call* call, uint64_t handle, void* to, uint64_t bytes,
                      weft_error* error);
} weft_device_memory;

/* Extension of components that compute on devices. It lists one line of text per usable device, in
 * the order of their indices. */
#define WEFT_DEVICES "weft.devices/1"
typedef struct weft_devices {
  uint32_t struct_size;
  uint32_t reserved;
  /* Calls device(context, text) for each device; the host copies the text. WEFT_OK or WEFT_ERROR.
   */
  int32_t (*list)(void* context, void (*device)(void* context, const char* text),
                  weft_error* error);
} weft_devices;

/* Extension of components with parameter errors beyond their declarations: files, patterns,
 * parameters that exclude one another. The host calls it after create (without nested components)
 * and before prepare. It may read headers and small files, but must neither block nor compute.
 * Each message concerns one parameter. A message that begins with "warning: " is about a legal but
 * doubtful value. */
#define WEFT_CHECK "weft.check/1"
typedef struct weft_check {
  uint32_t struct_size;
  uint32_t reserved;
  /* Calls mistake(context, parameter, message) for each error; the host copies the texts. WEFT_OK,
   * also with errors, or WEFT_ERROR if the check itself failed. */
  int32_t (*check)(void* self, void* context,
                   void (*mistake)(void* context, const char* parameter, const char* message),
                   weft_error* error);
} weft_check;

/* Extension of components with one number that determines their strictness: the values of a ROC
 * curve. The host reads it when it describes the library, never in a run. */
#define WEFT_SWEEP "weft.sweep/1"
typedef struct weft_sweep {
  uint32_t struct_size;
  uint32_t reserved;
  const char* parameter; /* name of a declared number */
  const double* values;  /* ascending, in its range, over the whole curve */
  uint64_t count;        /* length of values, at least 2 */
} weft_sweep;

/* Extension of components that should not share the process of a run, such as those with an
 * interpreter. Their stage runs in its own process unless the pipeline has `isolate: none`. The
 * host reads it when it describes the library, never in a run. */
#define WEFT_ISOLATION "weft.isolation/1"
typedef struct weft_isolation {
  uint32_t struct_size;
  uint32_t reserved;
} weft_isolation;

/* Extension of sinks that steer the run. Both functions are called from any thread, also during
 * process. */
#define WEFT_STEERING "weft.steering/1"
typedef struct weft_steering {
  uint32_t struct_size;
  uint32_t reserved;
  /* Calls request(context, number, text) for each request since the last call, once; the sink
   * assigns `number`. Texts:
   * "set PATH=VALUE" as in `weft run --set`, "save", "pause", "step", "resume", "stop". */
  int32_t (*take_change_requests)(void* self, void* context,
                                  void (*request)(void* context, uint64_t number, const char* text),
                                  weft_error* error);
  /* Answers a request: `frame` is the first frame to which it applies, or, for "save", N of the
   * file settings-N.yaml in the run folder. `refusal` is "" if it was granted. */
  int32_t (*answer)(void* self, uint64_t number, uint64_t frame, const char* refusal,
                    weft_error* error);
} weft_steering;

/* One component. Texts are not null; all functions but get_extension are present. */
typedef struct weft_component {
  uint32_t struct_size;
  uint32_t flags;          /* WEFT_FLAG_* */
  const char* id;          /* "filters/myneighbor", "filters/vendor.name" */
  const char* version;     /* the version of the component */
  const char* summary;     /* one sentence */
  const char* reference;   /* paper or standard, or "" */
  const char* licence;     /* SPDX identifier of the built library */
  const char* determinism; /* "exact" or "tolerance" */
  const char* needs;       /* inputs required beyond those of the role, separated by spaces */
  const char* reads;       /* inputs used when present, separated by spaces */
  const char* produces;    /* outputs, if the role leaves a choice, separated by spaces; else "" */
  uint64_t methods;        /* implemented methods of its role: bit n is method n */
  /* Declares parameters and records; reads no file. WEFT_OK or WEFT_ERROR. */
  int32_t (*describe)(const weft_describe* sink, weft_error* error);
  /* Makes an instance and sets *self to a value that is not null. WEFT_OK or WEFT_ERROR, which
   * leaves nothing to destroy. */
  int32_t (*create)(const weft_create* with, void** self, weft_error* error);
  /* Gives the template and the camera (slots "template" and "camera") before the first frame, and
   * again when they change. Not called for sources and templates. WEFT_OK, WEFT_DEGENERATE,
   * WEFT_NO_RESULT, WEFT_ERROR or WEFT_CANCELLED. */
  int32_t (*prepare)(void* self, const weft_call* call, const weft_record* inputs,
                     uint64_t input_count, weft_error* error);
  /* Runs one method of the role. Any weft_status; WEFT_END only from WEFT_SOURCE_READ. */
  int32_t (*process)(void* self, const weft_call* call, const weft_record* inputs,
                     uint64_t input_count, weft_error* error);
  /* Ends an instance; called once for each successful create, also after a failed prepare. */
  void (*destroy)(void* self);
  /* Returns an extension by name and version, null if there is none. The pointer may be null. */
  const void* (*get_extension)(const struct weft_component* component, const char* name);
} weft_component;

/* Flags of components and libraries. A host may ignore unknown bits 0 to 15 and refuses components
 * and libraries with unknown bits 16 to 31. */
#define WEFT_FLAG_RANDOM 1u     /* draws from the seed */
#define WEFT_FLAG_USES_TRUTH 2u /* may read ground_truth */

/* The content of a library. It is constant and valid for the lifetime of the process. */
typedef struct weft_library_table {
  uint32_t magic;     /* WEFT_ABI_MAGIC */
  uint16_t abi_major; /* WEFT_ABI_MAJOR: must equal the host's */
  uint16_t sdk_minor; /* WEFT_ABI_MINOR of the header of its build */
  uint32_t struct_size;
  uint32_t count;                          /* length of components, 1 to 4096 */
  const char* abi;                         /* WEFT_ABI_NAME */
  const weft_component* const* components; /* [count] with different ids */
  const char* isa;      /* processor features assumed by the compiler, separated by spaces */
  const char* compiler; /* name and version of the compiler */
  uint16_t needs_minor; /* minor version of the oldest compatible host */
  uint16_t reserved_half;
  uint32_t flags; /* bits as of WEFT_FLAG_*; 0 in this version */
  uint64_t reserved[4];
} weft_library_table;

/* Allocates an array of an output of this frame with weft_host.alloc. Null if it is refused. */
static inline void* weft_alloc(const weft_call* call, const char* slot, const char* type,
                               const char* array, int32_t dtype, int32_t ndim,
                               const int64_t* shape) {
  const weft_output output = {sizeof(weft_output), dtype, slot, type, array, shape, ndim, 0, 0, 0,
                              WEFT_NO_FRAME,       0};
  return call->host->alloc(call, &output);
}

#ifndef WEFT_EXPORT
#define WEFT_EXPORT __attribute__((visibility("default")))
#endif

/* The only symbol that a library exports. */
extern WEFT_EXPORT const weft_library_table weft_library;

#ifdef __cplusplus
}
#endif

#endif /* WEFT_ABI_H_ */
