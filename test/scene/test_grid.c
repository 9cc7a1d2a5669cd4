// Tests of src/scene/grid.c.
#include "check.h"
#include "shape.h"

static const cloth_grid_pattern patterns[] = {CLOTH_GRID_ALTERNATING, CLOTH_GRID_LEFT,
                                              CLOTH_GRID_RIGHT, CLOTH_GRID_UNSTRUCTURED};
static const int resolutions[][2] = {{2, 2}, {3, 2}, {2, 5}, {7, 4}, {6, 9}};

// one sheet: no holes, no overlaps, no triangle the other way round
static int every_pattern_tiles_the_sheet(void)
{
  const double size[2] = {0.5, 0.7};
  for (int p = 0; p < 4; p++)
    for (int r = 0; r < 5; r++) {
      cloth_mesh m;
      cloth_error err = {0};
      double least;
      CHECK_OK(cloth_mesh_grid(size, resolutions[r], patterns[p], &m, &err), err);
      CHECK_NEAR(shape_area(&m, &least), 0.35, 1e-15); // rounding
      CHECK(least > 0);
      CHECK(shape_euler(&m) == 1);
      shape_edges e = shape_count_edges(&m);
      CHECK(e.manifold);
      int nx = resolutions[r][0], ny = resolutions[r][1];
      CHECK(e.borders == 2 * (nx - 1) + 2 * (ny - 1) || patterns[p] == CLOTH_GRID_UNSTRUCTURED);
      cloth_mesh_free(&m);
    }
  return 0;
}

static int vertices_stand_row_by_row(void)
{
  const double size[2] = {3, 2};
  const int resolution[2] = {4, 3};
  for (int p = 0; p < 3; p++) {
    cloth_mesh m;
    cloth_error err = {0};
    CHECK_OK(cloth_mesh_grid(size, resolution, patterns[p], &m, &err), err);
    CHECK(m.vertex_count == 12 && m.triangle_count == 12);
    for (int row = 0; row < 3; row++)
      for (int col = 0; col < 4; col++) {
        const double *x = m.position + 3 * (row * 4 + col);
        CHECK(x[0] == col - 1.5 && x[1] == row - 1.0 && x[2] == 0);
      }
    cloth_mesh_free(&m);
  }
  return 0;
}

static int patterns_draw_the_diagonals_they_name(void)
{
  const double size[2] = {2, 2};
  const int resolution[2] = {3, 3};
  // is the diagonal of the cell (0, 0), (1, 0) the one from lower left to upper right?
  const bool rising[3][2] = {{true, false}, {false, false}, {true, true}};
  for (int p = 0; p < 3; p++) {
    cloth_mesh m;
    cloth_error err = {0};
    CHECK_OK(cloth_mesh_grid(size, resolution, patterns[p], &m, &err), err);
    for (int col = 0; col < 2; col++) {
      CHECK((shape_side_count(&m, col, col + 4) == 1) == rising[p][col]);
      CHECK((shape_side_count(&m, col + 1, col + 3) == 1) == !rising[p][col]);
    }
    cloth_mesh_free(&m);
  }
  return 0;
}

static int material_coordinates_are_those_of_the_plane(void)
{
  const double size[2] = {1, 0.3};
  const int resolution[2] = {5, 4};
  for (int p = 0; p < 4; p++) {
    cloth_mesh m;
    cloth_error err = {0};
    CHECK_OK(cloth_mesh_grid(size, resolution, patterns[p], &m, &err), err);
    for (int i = 0; i < 3 * m.triangle_count; i++) {
      CHECK(m.material[2 * i] == m.position[3 * m.triangle[i]]);
      CHECK(m.material[2 * i + 1] == m.position[3 * m.triangle[i] + 1]);
    }
    cloth_mesh_free(&m);
  }
  return 0;
}

// near-equilateral cells: the half triangles at the sides begin at 30 degrees, and a corner that
// moves by 0.15 of the spacing across a side of this length takes at most 10 degrees off
static int unstructured_angles_stay_above_20_degrees(void)
{
  const double size[2] = {1, 1};
  const int resolution[2] = {31, 36}; // rows at sqrt(3) / 2 of the spacing
  cloth_mesh m;
  cloth_error err = {0};
  CHECK_OK(cloth_mesh_grid(size, resolution, CLOTH_GRID_UNSTRUCTURED, &m, &err), err);
  double angle = shape_angle_min(&m);
  printf("     smallest angle %.2f degrees\n", angle);
  CHECK(angle > 20);
  cloth_mesh_free(&m);
  return 0;
}

// a mesh without preferred direction has edges in all of them: each 15 degree sector of edge
// directions holds some share, and no two runs differ
static int unstructured_edges_point_everywhere_and_always_the_same(void)
{
  const double size[2] = {1, 1};
  const int resolution[2] = {31, 36};
  cloth_mesh m, again;
  cloth_error err = {0};
  CHECK_OK(cloth_mesh_grid(size, resolution, CLOTH_GRID_UNSTRUCTURED, &m, &err), err);
  CHECK_OK(cloth_mesh_grid(size, resolution, CLOTH_GRID_UNSTRUCTURED, &again, &err), err);
  CHECK(memcmp(m.position, again.position, sizeof(double) * 3 * (size_t)m.vertex_count) == 0);
  int sector[12] = {0};
  for (int t = 0; t < m.triangle_count; t++) {
    const double *a = shape_corner(&m, t, 0), *b = shape_corner(&m, t, 1);
    double angle = atan2(b[1] - a[1], b[0] - a[0]) / 3.14159265358979323846;
    sector[(int)((angle + 1) * 12) % 12]++;
  }
  int filled = 0;
  for (int i = 0; i < 12; i++) filled += sector[i] > 0;
  CHECK(filled >= 8);
  cloth_mesh_free(&m);
  cloth_mesh_free(&again);
  return 0;
}

static int nonsense_is_refused_with_its_range(void)
{
  const double sizes[][2] = {{0, 1}, {1, -1}, {NAN, 1}, {1, INFINITY}};
  const int good[2] = {2, 2}, bad[][2] = {{1, 2}, {2, 0}, {20000, 2}, {10000, 10000}};
  const double size[2] = {1, 1};
  cloth_mesh m;
  for (int i = 0; i < 4; i++) {
    cloth_error err = {0};
    CHECK(cloth_mesh_grid(sizes[i], good, CLOTH_GRID_LEFT, &m, &err) == CLOTH_BAD_SCENE);
    CHECK(strstr(err.text, "size = ") != NULL && strstr(err.text, "[1e-06, 10000]") != NULL);
    err = (cloth_error){0};
    CHECK(cloth_mesh_grid(size, bad[i], CLOTH_GRID_LEFT, &m, &err) == CLOTH_BAD_SCENE);
    CHECK(strstr(err.text, "resolution = ") != NULL);
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(every_pattern_tiles_the_sheet);
  RUN(vertices_stand_row_by_row);
  RUN(patterns_draw_the_diagonals_they_name);
  RUN(material_coordinates_are_those_of_the_plane);
  RUN(unstructured_angles_stay_above_20_degrees);
  RUN(unstructured_edges_point_everywhere_and_always_the_same);
  RUN(nonsense_is_refused_with_its_range);
  return failures != 0;
}
