// Several processes that mpirun started, as one command: the first writes and prints, all end
// alike.
#include "processes.h"

#include "scene/def.h"
#include "tool.h"

#include <fcntl.h>
#include <string.h>
#include <unistd.h>

static cloth_transport *transport; // NULL: one process
static int said = STDERR_FILENO;   // where to say what only this process knows

static void be_silent(void)
{
  int nowhere = open("/dev/null", O_WRONLY);
  fflush(stdout), fflush(stderr);
  said = dup(STDERR_FILENO);
  if (nowhere < 0) return;
  dup2(nowhere, STDOUT_FILENO), dup2(nowhere, STDERR_FILENO);
  close(nowhere);
}

cloth_status tool_processes_join(const tool_arguments *args, const cloth_def *def, cloth_error *err)
{
  const char *devices = tool_text(args, "devices");
  bool asked = def ? def->devices_are_processes : devices && strcmp(devices, "mpi") == 0;
  if (!asked || transport) return CLOTH_OK;
  if (args->command != &tool_run)
    CLOTH_FAIL(err, CLOTH_UNSUPPORTED, "devices = 'mpi' is for cloth run alone, not for cloth %s",
               args->command->name);
  CLOTH_TRY(cloth_processes_join(&transport, err));
  if (transport->rank > 0) be_silent();
  return CLOTH_OK;
}

bool tool_processes_first(void) { return !transport || transport->rank == 0; }

cloth_status tool_processes_agree(cloth_status mine, cloth_error *err)
{
  return transport ? transport->agree(transport, mine, err) : mine;
}

cloth_status tool_processes_share(int *value, cloth_error *err)
{
  return transport ? transport->share(transport, 0, value, sizeof *value, err) : CLOTH_OK;
}

void tool_processes_print(void)
{
  if (!transport) return;
  printf("processes         %d, rows by %s%s%s\n", transport->ranks, transport->name,
         transport->why[0] ? ", " : "", transport->why);
}

int tool_processes_leave(int code, const char *message)
{
  // process 0 has said it, and so it is not said again
  return cloth_processes_leave(code, said, tool_processes_first() ? "" : message);
}
