#include "nearest.h"

#include <ctype.h>
#include <string.h>

enum { LENGTH_MAX = 63 };

static int least(int a, int b) { return a < b ? a : b; }

static int length_of(const char *s)
{
  size_t n = strlen(s);
  return n > LENGTH_MAX ? LENGTH_MAX : (int)n;
}

// Optimal string alignment (Damerau 1964), three rows of the table at a time.
int cloth_edit_distance(const char *a, const char *b)
{
  int row[3][LENGTH_MAX + 1];
  int n = length_of(a), m = length_of(b);
  for (int j = 0; j <= m; j++) row[0][j] = j;
  for (int i = 1; i <= n; i++) {
    int *now = row[i % 3], *up = row[(i + 2) % 3], *up2 = row[(i + 1) % 3];
    now[0] = i;
    for (int j = 1; j <= m; j++) {
      int ai = tolower((unsigned char)a[i - 1]), bj = tolower((unsigned char)b[j - 1]);
      now[j] = least(least(now[j - 1], up[j]) + 1, up[j - 1] + (ai != bj));
      if (i > 1 && j > 1 && ai == tolower((unsigned char)b[j - 2]) &&
          bj == tolower((unsigned char)a[i - 2]))
        now[j] = least(now[j], up2[j - 2] + 1);
    }
  }
  return row[n % 3][m];
}

void cloth_nearest(const char *wanted, const char *name, const char **best)
{
  if (*best == NULL || cloth_edit_distance(wanted, name) < cloth_edit_distance(wanted, *best))
    *best = name;
}
