// cloth links: what a product over several devices would cost on a machine that is described in a
// file, stage by stage, and its timeline as a picture (P-Cloth's figure 3).
#include "links/links_file.h"
#include "tool.h"

#include <errno.h>
#include <string.h>

static const tool_option options[] = {
    {"model", "FILE", "how the parts are joined and what they multiply (doc/multi_gpu.md)"},
    {"svg", "FILE", "draw the timeline"},
    {NULL, NULL, NULL},
};

static void print_order(const cloth_links_forecast *f)
{
  printf("\nstage   ends at   vector: from -> to\n");
  for (int i = 0; i < f->count;) {
    int stage = f->order[i].stage, first = i;
    double end = 0;
    for (; i < f->count && f->order[i].stage == stage; i++)
      if (f->time[2 * i + 1] > end) end = f->time[2 * i + 1];
    printf("%5d %8.1f us ", stage + 1, 1e6 * end);
    for (int k = first; k < i; k++)
      printf("  %d: %d -> %d", f->order[k].vector, f->order[k].from, f->order[k].to);
    printf("\n");
  }
}

static void print_forecast(const cloth_links_model *m, const cloth_links_forecast *f)
{
  int n = m->links.parts;
  printf("model             %s\n", m->name);
  printf("parts             %d, %s\n", n,
         m->links.flat ? "each joined to each" : "tree of switches");
  printf("product           %.6g rows of %.3g blocks; %.0f %% of them own columns\n", m->rows,
         m->blocks, 100 * m->own);
  printf("sub-vector        %.6g bytes\n", m->halo * 3 * m->real_bytes * m->rows / n);
  printf("on one part       %.1f us\n", 1e6 * f->single);
  printf("exchange          %.1f us in %d stages\n", 1e6 * f->exchange, f->stages);
  printf("straightforward   %.1f us, %.2f times faster than one part\n", 1e6 * f->straight,
         f->single / f->straight);
  printf("pipelined         %.1f us, %.2f times faster than one part\n", 1e6 * f->pipelined,
         f->single / f->pipelined);
}

// ---- the picture --------------------------------------------------------------------------------

enum { WIDE = 900, LEFT = 90, ROW = 44 };

static void bar(FILE *svg, double x0, double x1, double y, double h, const char *color,
                const char *label)
{
  fprintf(svg,
          "<rect x='%.1f' y='%.1f' width='%.1f' height='%.1f' fill='%s' stroke='#fff' "
          "stroke-width='.5'/>\n",
          x0, y, x1 - x0 > 0.5 ? x1 - x0 : 0.5, h, color);
  if (label && x1 - x0 > 14)
    fprintf(svg, "<text x='%.1f' y='%.1f' font-size='10' text-anchor='middle'>%s</text>\n",
            (x0 + x1) / 2, y + h - 4, label);
}

static void draw_part(FILE *svg, const cloth_links_forecast *f, int part, double scale)
{
  double y = 30 + ROW * part, busy = f->own;
  fprintf(svg, "<text x='8' y='%.1f' font-size='12'>part %d</text>\n", y + 22, part);
  bar(svg, LEFT, LEFT + scale * f->own, y + 18, 16, "#7fb069", "own");
  for (int i = 0; i < f->count; i++) {
    const cloth_transfer *t = &f->order[i];
    char label[16];
    if (t->to != part) continue;
    snprintf(label, sizeof label, "%d", t->vector);
    bar(svg, LEFT + scale * f->time[2 * i], LEFT + scale * f->time[2 * i + 1], y, 16,
        t->from == t->vector ? "#9ecae1" : "#fdd0a2", label);
    double start = busy > f->time[2 * i + 1] ? busy : f->time[2 * i + 1];
    busy = start + f->other;
    bar(svg, LEFT + scale * start, LEFT + scale * busy, y + 18, 16, "#b5d99c", NULL);
  }
}

static cloth_status draw(const char *path, const cloth_links_model *m,
                         const cloth_links_forecast *f, cloth_error *err)
{
  FILE *svg = fopen(path, "w");
  if (svg == NULL) CLOTH_FAIL(err, CLOTH_IO, "%s: %s", path, strerror(errno));
  double longest = f->straight > f->pipelined ? f->straight : f->pipelined;
  double scale = (WIDE - LEFT - 20) / longest;
  int height = 60 + ROW * m->links.parts;
  fprintf(svg,
          "<svg xmlns='http://www.w3.org/2000/svg' width='%d' height='%d' "
          "font-family='sans-serif'>\n<rect width='100%%' height='100%%' fill='white'/>\n",
          WIDE, height);
  fprintf(svg,
          "<text x='8' y='18' font-size='13'>%s: arrivals (blue from the owner, orange handed "
          "on) and products (green); %.1f us pipelined, dashed: %.1f us straightforward</text>\n",
          m->name, 1e6 * f->pipelined, 1e6 * f->straight);
  for (int p = 0; p < m->links.parts; p++) draw_part(svg, f, p, scale);
  fprintf(svg, "<line x1='%.1f' x2='%.1f' y1='26' y2='%d' stroke='#a00' stroke-dasharray='4'/>\n",
          LEFT + scale * f->straight, LEFT + scale * f->straight, height - 26);
  fprintf(svg, "</svg>\n");
  bool bad = ferror(svg) != 0;
  if (fclose(svg) != 0 || bad)
    CLOTH_FAIL(err, CLOTH_IO, "%s: not written: %s", path, strerror(errno));
  return CLOTH_OK;
}

static int links_main(const tool_arguments *args, cloth_error *err)
{
  const char *path = tool_text(args, "model"), *svg = tool_text(args, "svg");
  if (path == NULL) {
    cloth_fail(err, CLOTH_BAD_ARGUMENT, __FILE__, __LINE__, "--model FILE is needed");
    return TOOL_BAD_INPUT;
  }
  static cloth_links_model model;
  static cloth_links_forecast forecast;
  cloth_status status = cloth_links_load(path, &model, err);
  if (status != CLOTH_OK) return tool_exit_code(status);
  cloth_links_predict(&model, &forecast);
  print_forecast(&model, &forecast);
  print_order(&forecast);
  if (svg) status = draw(svg, &model, &forecast, err);
  return status == CLOTH_OK ? TOOL_DONE : tool_exit_code(status);
}

const tool_command tool_links = {
    "links", "", 0, 0, false, options, "predict the exchange between several devices", links_main};
