// A backend whose devices are spread over processes: device i is that of process i. Every process
// runs the same host program; what it asks of its own device is done, what it asks of another's is
// that process's to do, and here nothing happens. What the host reads is read by the owner and
// comes to all, so all processes decide by the same numbers.
//
// An error of one device shows where all processes listen next: alloc, read, elapsed. Until
// then the device does nothing more, and its process goes on like the others.
#pragma once

#include "scene/def.h"
#include "transport.h"

enum { CLOTH_SPREAD_MAX = CLOTH_DEVICES_MAX }; // processes

/// What a cloth_device of this backend is.
typedef struct cloth_spread_device {
  const cloth_backend *inner;
  const cloth_transport *transport;
  cloth_device *here; // inner's; NULL: another process has it
  int rank;           // of the process that has it
  cloth_status failed;
  cloth_error why;
} cloth_spread_device;

/// All devices are open: choose how rows travel. `own` is this process's.
cloth_status cloth_spread_connect(cloth_device *own, cloth_transport *transport, cloth_error *err);

/// The table. `inner` and `transport` outlive it; the last pair given counts for devices that are
/// opened after it.
const cloth_backend *cloth_backend_spread(const cloth_backend *inner, cloth_transport *transport);
