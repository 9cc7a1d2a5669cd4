// Status codes and error messages. Every fallible function returns cloth_status and takes a
// nullable cloth_error as its last argument; there is no global error state.
#pragma once

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Outcome of a call. 0 is success.
/// Positive: the request was refused and the object is exactly as it was before the call.
/// Negative: the object is in an unknown state; the only legal next call is its _free().
typedef enum cloth_status {
  CLOTH_OK = 0,
  CLOTH_BAD_ARGUMENT = 1, // a value outside its documented range
  CLOTH_BAD_SCENE = 2,    // a scene that cannot be simulated (empty, non-manifold, ...)
  CLOTH_UNSUPPORTED = 3,  // the chosen backend cannot do this
  CLOTH_BAD_STATE = 4,    // a state or recording that does not belong to this scene, or is damaged
  CLOTH_UNSTABLE = 5,     // a step that stayed non-finite or out of bounds at the smallest size
  CLOTH_IO = 6,           // a file that cannot be read or written
  CLOTH_NO_MEMORY = -1,   // host or device allocation failed
  CLOTH_DEVICE_LOST = -2, // the device reported an error that it will not recover from
  CLOTH_INTERNAL = -3,    // a broken invariant; please report it with the recording
} cloth_status;

/// Where and why the first failure happened. Zero-initialise before the first use; set
/// status to CLOTH_OK to use it again.
typedef struct cloth_error {
  cloth_status status;
  int line;
  const char *file;
  char text[512];
} cloth_error;

#if defined(__GNUC__)
__attribute__((format(printf, 5, 6)))
#endif
cloth_status
cloth_fail(cloth_error *err, cloth_status status, const char *file, int line, const char *format, ...);

/// Record a failure at this line and return it.
#define CLOTH_FAIL(err, status, ...) return cloth_fail(err, status, __FILE__, __LINE__, __VA_ARGS__)

/// Call something fallible; on failure return its status unchanged.
#define CLOTH_TRY(call)                                                                              \
  do {                                                                                             \
    cloth_status status_ = (call);                                                                   \
    if (status_ != CLOTH_OK) return status_;                                                         \
  } while (0)

/// Call something fallible; on failure keep the status and jump to the clean-up label.
#define CLOTH_TRY_GOTO(call, status, label)                                                          \
  do {                                                                                             \
    (status) = (call);                                                                             \
    if ((status) != CLOTH_OK) goto label;                                                            \
  } while (0)

#ifdef __cplusplus
}
#endif
