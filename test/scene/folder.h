// A folder of files that a test makes and leaves nothing of.
#pragma once

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct folder {
  char path[256];
  char file[8][512]; // the paths given last, so that several can be used in one call
  int next;
} folder;

static inline folder folder_make(void)
{
  folder f = {.next = 0};
  const char *base = getenv("TMPDIR");
  snprintf(f.path, sizeof f.path, "%.200s/cloth_test_XXXXXX", base ? base : "/var/tmp");
  if (mkdtemp(f.path) == NULL) {
    perror(f.path);
    exit(1);
  }
  return f;
}

/// Path of a file in it.
static inline const char *folder_path(folder *f, const char *name)
{
  char *out = f->file[f->next++ % 8];
  size_t n = strlen(f->path), m = strlen(name);
  if (n + m + 2 > sizeof f->file[0]) exit(1);
  memcpy(out, f->path, n);
  out[n] = '/';
  memcpy(out + n + 1, name, m + 1);
  return out;
}

static inline const char *folder_write_bytes(folder *f, const char *name, const void *data,
                                             size_t size)
{
  const char *path = folder_path(f, name);
  FILE *stream = fopen(path, "wb");
  if (stream == NULL || fwrite(data, 1, size, stream) != size || fclose(stream) != 0) {
    perror(path);
    exit(1);
  }
  return path;
}

static inline const char *folder_write(folder *f, const char *name, const char *text)
{
  return folder_write_bytes(f, name, text, strlen(text));
}

/// How many files are in it.
static inline int folder_count(const folder *f)
{
  DIR *dir = opendir(f->path);
  int n = 0;
  for (struct dirent *e; dir && (e = readdir(dir)) != NULL;) n += e->d_name[0] != '.';
  if (dir) closedir(dir);
  return n;
}

static inline void folder_remove(folder *f)
{
  DIR *dir = opendir(f->path);
  for (struct dirent *e; dir && (e = readdir(dir)) != NULL;) {
    char path[600];
    snprintf(path, sizeof path, "%s/%s", f->path, e->d_name);
    if (e->d_name[0] != '.') unlink(path);
  }
  if (dir) closedir(dir);
  rmdir(f->path);
}
