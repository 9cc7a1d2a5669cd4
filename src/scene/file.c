#ifndef _GNU_SOURCE
#define _GNU_SOURCE // fileno
#endif
#include "scene/file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static cloth_status read_stream(FILE *stream, const char *path, cloth_text *out, cloth_error *err)
{
  const size_t most = (size_t)1 << 31;
  size_t room = 1 << 16;
  for (;;) {
    char *grown = realloc(out->data, room + 1);
    if (grown == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory to read %s", path);
    out->data = grown;
    out->size += fread(out->data + out->size, 1, room - out->size, stream);
    if (out->size < room) break;
    if (room >= most) CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s: larger than 2 GiB", path);
    room *= 2;
  }
  if (ferror(stream)) CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s: %s", path, strerror(errno));
  out->data[out->size] = '\0';
  return CLOTH_OK;
}

cloth_status cloth_text_read(const char *path, cloth_text *out, cloth_error *err)
{
  *out = (cloth_text){0};
  FILE *stream = fopen(path, "rb");
  if (stream == NULL) CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s: %s", path, strerror(errno));
  struct stat info;
  cloth_status status = CLOTH_OK;
  if (fstat(fileno(stream), &info) == 0 && (S_ISDIR(info.st_mode) || S_ISCHR(info.st_mode)))
    status = cloth_fail(err, CLOTH_BAD_SCENE, __FILE__, __LINE__, "%s: is a %s, not a file", path,
                        S_ISDIR(info.st_mode) ? "directory" : "device");
  else
    status = read_stream(stream, path, out, err);
  fclose(stream);
  if (status != CLOTH_OK) {
    free(out->data);
    *out = (cloth_text){0};
  }
  return status;
}

cloth_status cloth_path_beside(const char *file, const char *path, char **out, cloth_error *err)
{
  const char *slash = strrchr(file, '/');
  size_t folder = path[0] == '/' || slash == NULL ? 0 : (size_t)(slash - file) + 1;
  size_t length = strlen(path);
  *out = malloc(folder + length + 1);
  if (*out == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for a path");
  memcpy(*out, file, folder);
  memcpy(*out + folder, path, length + 1);
  return CLOTH_OK;
}

char *cloth_string_copy(const char *text)
{
  size_t size = strlen(text) + 1;
  char *copy = malloc(size);
  return copy ? memcpy(copy, text, size) : NULL;
}
