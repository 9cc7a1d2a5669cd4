// Lists that grow while a file is read.
#pragma once

#include <stdbool.h>
#include <stdlib.h>

typedef struct cloth_doubles {
  double *data;
  size_t count, room;
} cloth_doubles;

typedef struct cloth_ints {
  int *data;
  size_t count, room;
} cloth_ints;

// Room for one more item: the array, moved if need be, or NULL without memory (the old one stays).
static inline void *cloth_list_grow(void *data, size_t count, size_t *room, size_t item)
{
  if (count < *room) return data;
  size_t more = *room ? 2 * *room : 64;
  void *grown = realloc(data, more * item);
  if (grown) *room = more;
  return grown;
}

/// Append; false without memory.
static inline bool cloth_doubles_push(cloth_doubles *list, double value)
{
  double *data = cloth_list_grow(list->data, list->count, &list->room, sizeof *data);
  if (data == NULL) return false;
  list->data = data;
  list->data[list->count++] = value;
  return true;
}

/// Append; false without memory.
static inline bool cloth_ints_push(cloth_ints *list, int value)
{
  int *data = cloth_list_grow(list->data, list->count, &list->room, sizeof *data);
  if (data == NULL) return false;
  list->data = data;
  list->data[list->count++] = value;
  return true;
}
