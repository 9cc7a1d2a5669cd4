// Tests of src/scene/scene_*.c and yaml.c: every way to write a scene file wrong, one a row. A
// message names file, line and key, and says what would be right; nothing is left behind (address
// sanitizer).
#include "check.h"
#include "folder.h"
#include "scene/def.h"

typedef struct row {
  const char *text;
  int line;             // 0: the message names no line
  const char *key;      // NULL: the message names no key
  const char *expected; // part of the message
} row;

#define GRID  "grid: {size: [1, 1], resolution: [3, 3]}"
#define CLOTH "cloths:\n- name: a\n  " GRID "\n  " // the next key is on line 4
#define BODY  "bodies:\n- name: b\n  "             // line 3
#define TUBE  "tube: {radius: 1, length: 1, resolution: [5, 3]}"
#define BOX   "box: {size: [1, 1, 1]}"

// one row a line
// clang-format off
static const row rows[] = {
    // YAML itself
    {"", 1, NULL, "the file is empty"},
    {"# nothing\n", 1, NULL, "the file is empty"},
    {"name: [a\n", 2, NULL, "not YAML"},
    {"name: a\n\tduration: 1\n", 2, NULL, "not YAML"},
    {"a: b: c\n", 1, NULL, "not YAML"},
    {"name: \"a\n", 2, NULL, "not YAML"},
    {"name: *nowhere\n", 1, NULL, "not YAML"},
    {"name: a\nduration: \x01\n", 2, NULL, "not YAML"},
    {"name: a\nduration: \xff\xfe\n", 2, NULL, "not YAML"},
    {"name: a\n---\nname: b\n", 3, NULL, "a second document begins"},
    {"name: a\n---\n{[\n", 4, NULL, "not YAML"},
    {"just text\n", 1, NULL, "expected keys with values, found 'just text'"},
    {"- a\n- b\n", 1, NULL, "expected keys with values, found a list of 2"},
    {"&a [*a]\n", 1, NULL, "expected keys with values, found a list of 1"},
    {"bodies: &a [*a]\n", 1, "bodies", "expected keys with values, found a list of 1"},
    {"params: &p {wind: *p}\n", 1, "wind", "expected text, found a mapping"},
    {"[a, b]: c\n", 1, NULL, "a key must be a word"},
    {"params: {[1]: c}\n", 1, "params", "a key must be a word"},
    {"name: a\nduration: 1\nname: b\n", 3, "name", "is there twice; first on line 1"},
    // top level
    {"nmae: a\n", 1, "nmae", "unknown key; the nearest is 'name'"},
    {"duration: 1\nsheets: []\n", 2, "sheets", "unknown key; the nearest is"},
    {"name: [a]\n", 1, "name", "expected text, found a list of 1"},
    {"name:\n", 1, "name", "expected text, found nothing"},
    {"name: "
     "0123456789012345678901234567890123456789012345678901234567890123456789\n",
     1, "name", "longer than 63 characters"},
    {"backend: gpu\n", 1, "backend", "'gpu' is not one of auto, cpu, cuda, shuffle; the nearest is 'cpu'"},
    {"backend: {cpu: 1}\n", 1, "backend", "expected text, found a mapping"},
    {"precision: single\n", 1, "precision", "is not one of float, double"},
    {"devices: []\n", 1, "devices", "expected a list of at least 1, found a list of 0"},
    {"devices: [cpu, gpu]\n", 1, "devices", "'gpu' is neither 'cpu' nor a device index in [0, 1023]"},
    {"devices: [[cpu]]\n", 1, "devices", "expected text, found a list of 1"},
    {"devices: -1\n", 1, "devices", "'-1' is neither"},
    {"duration: long\n", 1, "duration", "'long' is not a number; [s] in [0, 1e+06]"},
    {"duration: .nan\n", 1, "duration", "nan [s] is not in [0, 1e+06]"},
    {"cloths: {}\n", 1, "cloths", "expected a list of at least 0, found a mapping"},
    {"cloths: towel\n", 1, "cloths", "found 'towel'"},
    {"bodies: 3\n", 1, "bodies", "expected a list of at least 0, found '3'"},
    {"cloths: [3]\n", 1, "cloths", "expected keys with values, found '3'"},
    // variables
    {"variables: 3\n", 1, "variables", "expected keys with values, found '3'"},
    {"variables: {a: $b, b: 1}\n", 1, "a", "a variable's value cannot be another variable"},
    {"variables: {time: 1}\nduration: $tmie\n", 2, NULL, "'$tmie': no such variable; the nearest is 'time'"},
    {"duration: $time\n", 1, NULL, "'$time': no such variable; the file has none"},
    {"variables: {time: soon}\nduration: $time\n", 1, "duration", "'soon' is not a number"},
    {"variables: {t: 1}\nvariants: {a: 3}\nduration: $t\n", 2, "a", "expected keys with values, found '3'"},
    {"variables: {t: 1}\nvariants: {a: {t: 2}, b: {u: 3}}\nduration: $t\n", 2, "u", "no such variable; the nearest is 't'"},
    {"variants: []\n", 1, "variants", "expected keys with values, found a list of 0"},
    // params, effects
    {"params: 1\n", 1, "params", "expected keys with values, found '1'"},
    {"params:\n  thicknes: 1e-3\n", 2, "thicknes", "unknown key; the nearest is 'thickness'"},
    {"params:\n  thickness: nan\n", 2, "thickness", "nan [m] is not in [1e-05, 0.05]"},
    {"params:\n  thickness: thin\n", 2, "thickness", "expected a number [m] in [1e-05, 0.05], found 'thin'"},
    {"params:\n  thickness: [1e-3]\n", 2, "thickness", "expected a number [m] in [1e-05, 0.05], found a list of 1"},
    {"params:\n  thickness:\n", 2, "thickness", "found nothing"},
    {"params:\n  pcg_iterations_max: 2.5\n", 2, "pcg_iterations_max", "expected a whole number [1] in [1, 100000], found '2.5'"},
    {"params:\n  threads: -1\n", 2, "threads", "-1 [1] is not in [0, 1024]"},
    {"params:\n  gravity: [0, 0]\n", 2, "gravity", "expected a list of 3 numbers [m/s^2], found a list of 2"},
    {"params:\n  gravity: [0, 0, down]\n", 2, "gravity", "expected a number [m/s^2] in [-1000, 1000], found 'down'"},
    {"params:\n  gravity:\n  - 0\n  - 0\n  - 1e9\n", 5, "gravity", "1e+09 [m/s^2] is not in [-1000, 1000]"},
    {"params:\n  gravity: 9.81\n", 2, "gravity", "is not three numbers such as \"0 0 -9.81\""},
    {"params:\n  mesh_defects: fix\n", 2, "mesh_defects", "is not one of refuse|repair"},
    {"params:\n  mesh_defects: [repair]\n", 2, "mesh_defects", "expected text, found a list of 1"},
    {"effects: [air]\n", 1, "effects", "expected keys with values"},
    {"effects:\n  bendign: on\n", 2, "bendign", "unknown effect; the nearest is 'bending'"},
    {"effects:\n  bending: maybe\n", 2, "bending", "'maybe' is not one of auto, on, off"},
    {"effects:\n  bending: [on]\n", 2, "bending", "expected text, found a list of 1"},
    // materials
    {"materials: [a]\n", 1, "materials", "expected keys with values, found a list of 1"},
    {"materials: {a: soft}\n", 1, "a", "expected keys with values, found 'soft'"},
    {"materials:\n  a:\n    densty: 1\n", 3, "densty", "unknown key; the nearest is 'density'"},
    {"materials:\n  a:\n    density: -1\n", 3, "density", "-1 [kg/m^2] is not in [0.001, 100]"},
    {"materials:\n  a:\n    density: heavy\n", 3, "density", "expected a number [kg/m^2] in [0.001, 100], found 'heavy'"},
    {"materials:\n  a:\n    poisson: 0.9\n    stretch_weft: 9000\n", 3, "a", "poisson = 0.9 [1] is not in [0, 0.4714"},
    {"materials:\n  a: {file: none.yaml}\n", 2, "file", "none.yaml: No such file or directory"},
    {"materials:\n  a: {file: [x]}\n", 2, "file", "expected text, found a list of 1"},
    {"materials:\n  a: {file: broken.yaml}\n", 2, "file", "broken.yaml:2: not YAML"},
    {"materials:\n  a: {file: wrong.yaml}\n", -2, "bend_wrap", "unknown key; the nearest is 'bend_warp'"},
    // cloths
    {"cloths:\n- " GRID "\n", 2, "cloths", "'name' is missing"},
    {"cloths:\n- name: a b\n  " GRID "\n", 2, "cloths", "the cloth's name 'a b' is not a letter followed by"},
    {"cloths:\n- {name: a, " GRID "}\n- {name: a, " GRID "}\n", 3, "cloths", "there is a cloth 'a' already"},
    {"cloths:\n- name: a\n", 2, "cloths", "the cloth has no shape; give one of 'grid', 'tube' or 'mesh'"},
    {CLOTH "mesh: quad.obj\n", 4, "mesh", "stands beside 'grid'"},
    {CLOTH "scale: 2\n", 4, "scale", "belongs to 'mesh' only"},
    {CLOTH "material_scale: 2\n", 4, "material_scale", "belongs to 'mesh' only"},
    {CLOTH "colour: red\n", 4, "colour", "unknown key; the nearest is"},
    {CLOTH "material: towel\n", 4, "material", "no material 'towel': the file has no 'materials'"},
    {"materials: {towel: {}}\n" CLOTH "material: towle\n", 5, "material", "no material 'towle'; the nearest is 'towel'"},
    {CLOTH "pose: [0, 0, 1]\n", 4, "pose", "expected keys with values, found a list of 3"},
    {CLOTH "pose: {postion: [0, 0, 1]}\n", 4, "postion", "the nearest is 'position'"},
    {CLOTH "pose: {position: [0, 0]}\n", 4, "position", "expected a list of 3 numbers [m], found a list of 2"},
    {CLOTH "pose: {position: [0, 0, .inf]}\n", 4, "position", "inf [m] is not in [-1e+06, 1e+06]"},
    {CLOTH "pose: {rotation: [0, 0, 0]}\n", 4, "rotation", "expected a list of 4 numbers [1], found a list of 3"},
    {CLOTH "pose: {rotation: [0, 0, 0, 0]}\n", 4, "rotation", "has length 0; a quaternion x, y, z, w has length 1"},
    {CLOTH "pose: {rotation: [0, 0, 0, 1],\n    rpy: [0, 0, 0]}\n", 5, "rpy", "stands beside 'rotation'"},
    {CLOTH "pose: {rpy: [0, 0, north]}\n", 4, "rpy", "expected a number [rad]"},
    {CLOTH "velocity: 3\n", 4, "velocity", "expected a list of 3 numbers [m/s], found '3'"},
    {CLOTH "velocity: [0, 0, 1e4]\n", 4, "velocity", "10000 [m/s] is not in [-1000, 1000]"},
    // grids
    {"cloths: [{name: a, grid: big}]\n", 1, "grid", "expected keys with values, found 'big'"},
    {"cloths: [{name: a, grid: {size: [1, 1]}}]\n", 1, "grid", "'resolution' is missing"},
    {"cloths: [{name: a, grid: {resolution: [2, 2]}}]\n", 1, "grid", "'size' is missing"},
    {"cloths: [{name: a, grid: {size: 1, resolution: [2, 2]}}]\n", 1, "size", "expected a list of 2, found '1'"},
    {"cloths: [{name: a, grid: {size: [1, 0], resolution: [2, 2]}}]\n", 1, "size", "0 [m] is not in [1e-06, 10000]"},
    {"cloths: [{name: a, grid: {size: [1, 1], resolution: [2]}}]\n", 1, "resolution", "expected a list of 2, found a list of 1"},
    {"cloths: [{name: a, grid: {size: [1, 1], resolution: [2, 1]}}]\n", 1, "resolution", "1 [vertices] is not in [2, 10000]"},
    {"cloths: [{name: a, grid: {size: [1, 1], resolution: [2, 2.5]}}]\n", 1, "resolution", "expected a whole number [vertices] in [2, 10000], found '2.5'"},
    {"cloths: [{name: a, grid: {size: [1, 1], resolution: [10000, 10000]}}]\n", 1, "grid", "more than 25 million vertices"},
    {"cloths: [{name: a, grid: {size: [1, 1], resolution: [2, 2], pattern: lefft}}]\n", 1, "pattern", "expected one of alternating, left, right, unstructured, found 'lefft'; the nearest is 'left'"},
    {"cloths: [{name: a, grid: {size: [1, 1], resolution: [2, 2], pattern: []}}]\n", 1, "pattern", "found a list of 0"},
    // meshes
    {"cloths: [{name: a, mesh: none.obj}]\n", 1, "mesh", "none.obj: No such file or directory"},
    {"cloths: [{name: a, mesh: .}]\n", 1, "mesh", "the name ends neither with .obj nor with .ply"},
    {"cloths: [{name: a, mesh: bad.obj}]\n", 1, "mesh", "bad.obj:4: f: vertex 7 is not there"},
    {"cloths: [{name: a, mesh: {}}]\n", 1, "mesh", "expected text, found a mapping"},
    {"cloths: [{name: a, mesh: quad.obj, scale: 0}]\n", 1, "scale", "0 [1]: the absolute value is not in"},
    {"cloths: [{name: a, mesh: quad.obj, scale: [1, 1]}]\n", 1, "scale", "expected a list of 3 numbers [1], found a list of 2"},
    {"cloths: [{name: a, mesh: quad.obj, scale: big}]\n", 1, "scale", "expected a number [1]"},
    {"cloths: [{name: a, mesh: quad.obj, material_coordinates: file}]\n", 1, "material_coordinates", "the mesh file has no texture coordinates"},
    {"cloths: [{name: a, mesh: quad.obj, material_coordinates: fiel}]\n", 1, "material_coordinates", "the nearest is 'file'"},
    {"cloths: [{name: a, mesh: quad.obj, material_scale: 2}]\n", 1, "material_scale", "there are no material coordinates"},
    {"cloths: [{name: a, mesh: half.obj}]\n", 1, "mesh", "line 7 of the file: a face without vt"},
    {"cloths:\n- {name: a, mesh: twice.obj}\n", 2, "cloths", "'a': triangles 0 and 1 have the same vertices (0, 1, 2); mesh_defects: repair drops"},
    // groups
    {CLOTH "groups: [0]\n", 4, "groups", "expected keys with values, found a list of 1"},
    {CLOTH "groups: {g: 0}\n", 4, "g", "expected keys with values, found '0'"},
    {CLOTH "groups: {g: {}}\n", 4, "g", "expected one of vertices, box, nearest, radius, side, found 0 keys"},
    {CLOTH "groups: {g: {side: left, vertices: [0]}}\n", 4, "g", "found 2 keys"},
    {CLOTH "groups: {g: {sides: left}}\n", 4, "sides", "unknown key; the nearest is 'side'"},
    {CLOTH "groups: {g: [[{side: left}]]}\n", 4, "g", "expected keys with values, found a list of 1"},
    {CLOTH "groups: {g: []}\n", 4, "g", "expected a list of at least 1"},
    {CLOTH "groups: {g: {vertices: []}}\n", 4, "vertices", "expected a list of at least 1, found a list of 0"},
    {CLOTH "groups: {g: {vertices: [9]}}\n", 4, "vertices", "9 [vertex] is not in [0, 8]"},
    {CLOTH "groups: {g: {vertices: [-1]}}\n", 4, "vertices", "-1 [vertex] is not in [0, 8]"},
    {CLOTH "groups: {g: {vertices: [one]}}\n", 4, "vertices", "expected a whole number [vertex] in [0, 8], found 'one'"},
    {CLOTH "groups: {g: {box: [[0, 0, 0]]}}\n", 4, "box", "expected a list of 2, found a list of 1"},
    {CLOTH "groups: {g: {box: [[0, 0, 1], [1, 1, 0]]}}\n", 4, "box", "the first corner's z = 1 [m] is above the second's 0"},
    {CLOTH "groups: {g: {box: [[5, 5, 5], [6, 6, 6]]}}\n", 4, "g", "no vertex of the mesh is in this group"},
    {CLOTH "groups: {g: {nearest: [0, 0]}}\n", 4, "nearest", "expected a list of 3 numbers [m], found a list of 2"},
    {CLOTH "groups: {g: {nearest: [[[0, 0, 0], 0, 0]]}}\n", 4, "nearest", "expected a number [m] in [-1e+06, 1e+06], found a list of 3"},
    {CLOTH "groups: {g: {nearest: &n [*n]}}\n", 4, "nearest", "expected a list of 3 numbers [m]"},
    {CLOTH "groups: {g: {radius: 1}}\n", 4, "radius", "expected keys with values"},
    {CLOTH "groups: {g: {radius: {r: 1}}}\n", 4, "radius", "'center' is missing"},
    {CLOTH "groups: {g: {radius: {center: [0, 0, 0]}}}\n", 4, "radius", "'r' is missing"},
    {CLOTH "groups: {g: {radius: {center: [0, 0, 0], r: -1}}}\n", 4, "r", "-1 [m] is not in [0, 1e+06]"},
    {CLOTH "groups: {g: {side: front}}\n", 4, "side", "expected one of left, right, bottom, top, found 'front'"},
    {"cloths:\n- name: a\n  mesh: quad.obj\n  groups: {g: {side: left}}\n", 4, "side", "only a 'grid' has left and right"},
    {"cloths:\n- name: a\n  mesh: quad.obj\n  groups: {g: {side: top}}\n", 4, "side", "only a 'grid' has sides, a 'tube' top and bottom"},
    {"cloths:\n- name: a\n  " TUBE "\n  groups: {g: {side: right}}\n", 4, "side", "only a 'grid' has left and right"},
    {"cloths:\n- name: a\n  " TUBE "\n  grid: {}\n", 3, "tube", "stands beside 'grid'; a cloth has one shape"},
    {"cloths:\n- name: a\n  " TUBE "\n  scale: 2\n", 4, "scale", "belongs to 'mesh' only"},
    {"cloths:\n- name: a\n  tube: {radius: 1, length: 1}\n", 3, "tube", "'resolution' is missing"},
    {"cloths:\n- name: a\n  tube: {radius: -1, length: 1, resolution: [3, 3]}\n", 3, "radius", "-1 [m] is not in [1e-06, 10000]"},
    {"cloths:\n- name: a\n  tube: {radius: 1, length: 1, resolution: [2, 3]}\n", 3, "resolution", "2 [vertices] is not in [3, 10000]"},
    {"cloths:\n- name: a\n  tube: {radius: 1, length: 1, resolution: [9999, 9999]}\n", 3, "tube", "more than 25 million vertices"},
    {"cloths:\n- name: a\n  mesh: quad.obj\n  groups: {sheet: {vertices: [0]}}\n", 4, "sheet", "the mesh file has a group of this name"},
    // pins
    {CLOTH "pins: {group: g}\n", 4, "pins", "expected a list of at least 0, found a mapping"},
    {CLOTH "pins:\n  - {}\n", 5, "pins", "'group' is missing"},
    {CLOTH "pins:\n  - {group: g}\n", 5, "group", "no group 'g': the cloth has no groups"},
    {CLOTH "groups: {top: {side: top}}\n  pins:\n  - {group: tpo}\n", 6, "group", "no group 'tpo'; the nearest is 'top'"},
    {CLOTH "groups: {g: {side: top}}\n  pins:\n  - {group: g, bdoy: b}\n", 6, "bdoy", "the nearest is 'body'"},
    {CLOTH "groups: {g: {side: top}}\n  pins:\n  - {group: g, body: b}\n", 6, "body", "no body 'b': the file has no bodies"},
    {CLOTH "groups: {g: {side: top}}\n  pins:\n  - {group: g, body: hnad}\nbodies: [{name: hand, " BOX "}]\n", 6, "body", "no body 'hnad'; the nearest is 'hand'"},
    {CLOTH "groups: {g: {side: top}}\n  pins:\n  - {group: g, body: b, motion: {}}\nbodies: [{name: b, " BOX "}]\n", 6, "motion", "stands beside 'body'"},
    {CLOTH "groups: {g: {side: top}}\n  pins:\n  - {group: g, start: -1}\n", 6, "start", "-1 [s] is not in [0, 1e+06]"},
    {CLOTH "groups: {g: {side: top}}\n  pins:\n  - {group: g, start: 2, end: 1}\n", 6, "end", "1 [s] is not in [2, inf]"},
    {CLOTH "groups: {g: {side: top}}\n  pins:\n  - {group: g, stiffness: -1}\n", 6, "stiffness", "-1 [N/m] is not in"},
    {CLOTH "groups: {g: {side: top}}\n  pins:\n  - {group: g, break_force: weak}\n", 6, "break_force", "expected a number [N]"},
    {CLOTH "groups: {g: {side: top}, h: {vertices: [7]}}\n  pins:\n  - {group: g, end: 2}\n  - {group: h, start: 1}\n", 7, "pins", "vertex 7 is held by groups 'g' and 'h' at the same time"},
    {CLOTH "groups: {g: {side: top}}\n  pins:\n  - {group: g, motion: {keys: []}}\n", 6, "keys", "expected a list of at least 1"},
    // bodies
    {"bodies:\n- " BOX "\n", 2, "bodies", "'name' is missing"},
    {"bodies:\n- {name: b, " BOX "}\n- {name: b, " BOX "}\n", 3, "bodies", "there is a body 'b' already"},
    {BODY "pose: {}\n", 2, "bodies", "the body has no shape; give one of box, sphere, cylinder, cone, plane, mesh"},
    {BODY BOX "\n  sphere: {radius: 1}\n", 4, "sphere", "stands beside 'box'; a body has one shape"},
    {BODY BOX "\n  scale: 2\n", 4, "scale", "belongs to 'mesh' only"},
    {BODY BOX "\n  frcition: 1\n", 4, "frcition", "unknown key; the nearest is 'friction'"},
    {BODY BOX "\n  friction: -1\n", 4, "friction", "-1 [1] is not in [0, 10]"},
    {BODY "box: 1\n", 3, "box", "expected keys with values, found '1'"},
    {BODY "box: {}\n", 3, "box", "'size' is missing"},
    {BODY "box: {size: [1, 1]}\n", 3, "size", "expected a list of 3, found a list of 2"},
    {BODY "box: {size: [1, 1, -1]}\n", 3, "size", "-1 [m] is not in [1e-06, 10000]"},
    {BODY "sphere: {}\n", 3, "sphere", "'radius' is missing"},
    {BODY "sphere: {radius: 0}\n", 3, "radius", "0 [m] is not in [1e-06, 10000]"},
    {BODY "sphere: {radius: 1, segments: 2}\n", 3, "segments", "2 [1] is not in [3, 1000]"},
    {BODY "cylinder: {radius: 1}\n", 3, "cylinder", "'length' is missing"},
    {BODY "cylinder: {radius: 1, length: nan}\n", 3, "length", "nan [m] is not in [1e-06, 10000]"},
    {BODY "cylinder: {radius: 1, height: 1}\n", 3, "height", "unknown key; the nearest is 'length'"},
    {BODY "plane: {normal: [0, 0, 0]}\n", 3, "normal", "a normal of length 0 has no direction"},
    {BODY "plane: {normal: up}\n", 3, "normal", "expected a list of 3 numbers [1], found 'up'"},
    {BODY "plane: {size: 0}\n", 3, "size", "0 [m] is not in [1e-06, 10000]"},
    {BODY "plane: {offset: low}\n", 3, "offset", "expected a number [m]"},
    {BODY "mesh: none.ply\n", 3, "mesh", "none.ply: No such file or directory"},
    {BODY "mesh: flat.obj\n", 2, "bodies", "'b': no triangle has an area"},
    {BODY "cone: {length: 1}\n", 3, "cone", "'radius' is missing"},
    {BODY "cone: {radius: [0, 0], length: 1}\n", 3, "cone", "radius = (0, 0) [m]: a cone has one tip"},
    {BODY "cone: {radius: [1, 1, 1], length: 1}\n", 3, "radius", "expected a list of 2"},
    {BODY "cone: {radius: 0, length: 1}\n", 3, "radius", "0 [m] is not in [1e-06, 10000]"},
    {BODY BOX "\n  motion: fast\n", 4, "motion", "expected keys with values, found 'fast'"},
    {BODY BOX "\n  motion: {speed: 1}\n", 4, "speed", "unknown key; the nearest is"},
    {BODY BOX "\n  motion: {velocity: [0, 0, 9e9]}\n", 4, "velocity", "9e+09 [m/s] is not in [-1000, 1000]"},
    {BODY BOX "\n  motion: {spin: 1}\n", 4, "spin", "expected a list of 3 numbers [rad/s], found '1'"},
    {BODY BOX "\n  motion: {oscillation: {swing: [0, 0, 1]}}\n", 4, "oscillation", "'period' is missing"},
    {BODY BOX "\n  motion: {oscillation: {period: 0}}\n", 4, "period", "0 [s] is not in [0.001, 1e+06]"},
    {BODY BOX "\n  motion: {keys: [{time: 0}], oscillation: {period: 1}}\n", 4, "oscillation", "stands beside 'keys'"},
    {BODY BOX "\n  motion: {start: -1}\n", 4, "start", "-1 [s] is not in [0, 1e+06]"},
    {BODY BOX "\n  motion: {start: 3, end: 2}\n", 4, "end", "2 [s] is not in [3, inf]"},
    {BODY BOX "\n  motion: {keys: [{time: 0}], velocity: [0, 0, 1]}\n", 4, "velocity", "stands beside 'keys'"},
    {BODY BOX "\n  motion: {keys: {time: 0}}\n", 4, "keys", "expected a list of at least 1, found a mapping"},
    {BODY BOX "\n  motion: {keys: [0]}\n", 4, "keys", "expected keys with values, found '0'"},
    {BODY BOX "\n  motion:\n    keys:\n    - {position: [0, 0, 0]}\n", 6, "keys", "'time' is missing"},
    {BODY BOX "\n  motion:\n    keys:\n    - {time: 1}\n    - {time: 1}\n", 7, "time", "1 [s] is not after the key before, 1"},
    {BODY BOX "\n  motion:\n    keys:\n    - {time: nan}\n", 6, "time", "nan [s] is not in [0, 1e+06]"},
};
// clang-format on

static void write_fixtures(folder *f)
{
  folder_write(f, "quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng sheet\nf 1 2 3 4\n");
  folder_write(f, "bad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 7\n");
  folder_write(f, "half.obj",
               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\nf 1 3 4\n");
  folder_write(f, "twice.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 2 3 1\n");
  folder_write(f, "flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  folder_write(f, "broken.yaml", "{");
  folder_write(f, "wrong.yaml", "source: me\nbend_wrap: 1\n");
}

static int check_row(folder *f, const row *r)
{
  cloth_def *def = (cloth_def *)f; // must become NULL
  cloth_error err = {0};
  char start[400];
  CHECK(cloth_def_load(folder_write(f, "scene.yaml", r->text), &def, &err) == CLOTH_BAD_SCENE);
  CHECK(def == NULL);
  // a line below 0 is one of the material file
  int n = snprintf(start, sizeof start, "%s/%s:%d: ", f->path,
                   r->line < 0 ? "wrong.yaml" : "scene.yaml", abs(r->line));
  if (r->key) snprintf(start + n, sizeof start - (size_t)n, "key '%s': ", r->key);
  CHECK(strncmp(err.text, start, strlen(start)) == 0);
  CHECK(strstr(err.text + n, r->expected) != NULL);
  return 0;
}

static int every_refusal_names_its_line_and_key(void)
{
  folder f = folder_make();
  write_fixtures(&f);
  int files = folder_count(&f), failed = 0;
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    if (check_row(&f, &rows[i]) == 0) continue;
    cloth_def *def;
    cloth_error err = {0};
    cloth_def_load(folder_path(&f, "scene.yaml"), &def, &err);
    printf("row %zu:\n%s=> %s\nexpected line %d, key %s: %s\n", i, rows[i].text, err.text,
           rows[i].line, rows[i].key ? rows[i].key : "-", rows[i].expected);
    cloth_def_free(def);
    failed = 1;
  }
  CHECK(folder_count(&f) == files + 1); // reading writes nothing
  folder_remove(&f);
  return failed;
}

static int missing_files_are_named(void)
{
  folder f = folder_make();
  cloth_def *def;
  cloth_error err = {0};
  const char *path = folder_path(&f, "none.yaml");
  CHECK(cloth_def_load(path, &def, &err) == CLOTH_BAD_SCENE && def == NULL);
  CHECK(strstr(err.text, "none.yaml: No such file or directory") != NULL);
  err = (cloth_error){0};
  CHECK(cloth_def_load(f.path, &def, &err) == CLOTH_BAD_SCENE && def == NULL);
  CHECK(strstr(err.text, "is a directory, not a file") != NULL);
  CHECK(cloth_def_load(path, &def, NULL) == CLOTH_BAD_SCENE); // the message is optional
  folder_remove(&f);
  return 0;
}

// nothing here may recurse as deep as a file asks for
static int deep_nesting_is_refused(void)
{
  static const char *const starts[] = {"name: ", "groups: ", "cloths: "};
  folder f = folder_make();
  const size_t n = 4000; // libyaml takes the square of it
  static char text[10000];
  for (int i = 0; i < 6; i++) {
    size_t at = strlen(starts[i % 3]);
    memcpy(text, starts[i % 3], at);
    memset(text + at, '[', n);
    memset(text + at + n, ']', i < 3 ? n : 0);
    text[at + n + (i < 3 ? n : 0)] = '\0';
    cloth_def *def;
    cloth_error err = {0};
    CHECK(cloth_def_load(folder_write(&f, "deep.yaml", text), &def, &err) == CLOTH_BAD_SCENE);
    CHECK(strstr(err.text, "deep.yaml:") != NULL);
    CHECK(strstr(err.text, i < 3 ? "key" : "not YAML") != NULL);
  }
  folder_remove(&f);
  return 0;
}

// a good file with bytes changed or cut off is refused or read, never a crash (address sanitizer)
static int damaged_files_do_no_harm(void)
{
  static const char good[] =
      "name: x\ndevices: [cpu, cpu]\nparams: {gravity: [0, 0, -9.81], thickness: 1e-3}\nmaterials: "
      "{m: {density: "
      "0.2}}\n" CLOTH
      "material: m\n  groups: {g: {side: top}, h: {vertices: [0, 1]}}\n  pins:\n  - {group: g, "
      "body: b}\n  - {group: h, motion: {velocity: [0, 0, 1]}}\nbodies:\n- {name: b, " BOX
      ", motion: {keys: [{time: 0, position: [0, 0, 0]}, {time: 1, rpy: [0, 0, 1]}]}}\n- {name: c, "
      "mesh: quad.obj}\n";
  folder f = folder_make();
  write_fixtures(&f);
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(cloth_def_load(folder_write(&f, "s.yaml", good), &def, &err), err);
  cloth_def_free(def);
  unsigned long long state = 3;
  for (int i = 0; i < 600; i++) {
    char text[sizeof good];
    memcpy(text, good, sizeof good);
    size_t size = sizeof good - 1;
    for (int k = 0; k < 1 + i % 3; k++) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      text[(state >> 20) % size] =
          i % 2 ? "[]{},:-#&*!|>'\"%@`\n 0a"[(state >> 50) % 23] : (char)(state >> 56);
    }
    if (i % 5 == 0) size = (size_t)(state >> 30) % size;
    err = (cloth_error){0};
    cloth_status status = cloth_def_load(folder_write_bytes(&f, "s.yaml", text, size), &def, &err);
    CHECK(status == CLOTH_OK || status == CLOTH_BAD_SCENE);
    CHECK((status == CLOTH_OK) == (def != NULL));
    cloth_def_free(def);
  }
  folder_remove(&f);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(every_refusal_names_its_line_and_key);
  RUN(missing_files_are_named);
  RUN(deep_nesting_is_refused);
  RUN(damaged_files_do_no_harm);
  return failures != 0;
}
