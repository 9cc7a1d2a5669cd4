"""Scenes as Python values, and meshes that no grid makes. SI units. A scene is written as JSON, which is YAML."""
import json
import math

GRAVITY = 9.81
TOWEL = {}  # the engine's default fabric: 0.3 kg/m^2, 2000 N/m
DENSITY = 0.3


def scene(cloths, bodies=(), material=None, materials=None, effects=None, precision=None, **params):
    """A scene file as a dictionary. Cloths without a material of their own are of `material`."""
    out = {
        'name': 'stability', 'params': params, 'materials': dict(materials or {}, fabric=dict(material or TOWEL)),
        'cloths': [dict({'material': 'fabric'}, **cloth) for cloth in cloths], 'bodies': list(bodies)
    }
    if effects:
        out['effects'] = effects
    if precision:
        out['precision'] = precision
    return out


def text_of(value):
    return json.dumps(value, indent=1)


def sheet(size=0.3, cells=14, at=(0, 0, 0), turn=(0, 0, 0), pattern='unstructured', name='sheet', **more):
    """A grid; a number for size or cells means a square."""
    size = list(size) if isinstance(size, (tuple, list)) else [size, size]
    cells = cells if isinstance(cells, (tuple, list)) else [cells, cells]
    return dict(
        {
            'name': name, 'grid': {'size': size, 'resolution': [n + 1 for n in cells], 'pattern': pattern},
            'pose': {'position': list(at), 'rpy': list(turn)}
        }, **more)


def hung(size=0.3, cells=14, at=(0, 0, 0), pins=({}, ), **more):
    """A sheet in the plane y = 0 that is held along its upper side."""
    return sheet(size,
                 cells,
                 at, (math.pi / 2, 0, 0),
                 groups={'held': {'side': 'top'}},
                 pins=[dict({'group': 'held'}, **pin) for pin in pins],
                 **more)


def mesh_cloth(file='mesh.obj', at=(0, 0, 0), **more):
    return dict({'name': 'sheet', 'mesh': file, 'pose': {'position': list(at)}}, **more)


def box(name, size, at=(0, 0, 0), friction=0.3, **more):
    return dict({'name': name, 'box': {'size': list(size)}, 'pose': {'position': list(at)}, 'friction': friction}, **more)


def ball(radius, at=(0, 0, 0), name='ball', friction=0.3, **more):
    return dict(
        {'name': name, 'sphere': {'radius': radius, 'segments': 24}, 'pose': {'position': list(at)}, 'friction': friction},
        **more)


def rod(radius, length, at=(0, 0, 0), name='rod', turn=(0, math.pi / 2, 0), friction=0.3, **more):
    """A cylinder along x, unless turned otherwise."""
    return dict(
        {
            'name': name, 'cylinder': {'radius': radius, 'length': length, 'segments': 16}, 'friction': friction,
            'pose': {'position': list(at), 'rpy': list(turn)}
        }, **more)


def floor(z=0.0, friction=0.3):
    return {'name': 'floor', 'plane': {'normal': [0, 0, 1], 'offset': z, 'size': 8}, 'friction': friction}


def keys(*time_and_place):
    return {'keys': [{'time': t, 'position': list(x)} for t, x in time_and_place]}


# ---- energy bounds: J, and why --------------------------------------------------------------------------


def falls(mass, height, why):
    return mass * GRAVITY * height, 'm g h: %s' % why


def moves(mass, speed, why):
    return 0.5 * mass * speed ** 2, 'm v^2 / 2: %s' % why


def both(*bounds):
    return sum(value for value, _ in bounds), '; '.join(why for _, why in bounds)


# ---- meshes ---------------------------------------------------------------------------------------------


def obj(points, faces, material):
    """OBJ text; material [m] of each vertex goes to vt, so the mesh may be strained at the start."""
    lines = ['v %.17g %.17g %.17g' % tuple(p) for p in points]
    lines += ['vt %.17g %.17g' % tuple(m) for m in material]
    lines += ['f ' + ' '.join('%d/%d' % (i + 1, i + 1) for i in face) for face in faces]
    return '\n'.join(lines) + '\n'


def lattice(width, height, nx, ny):
    """Material coordinates [(nx + 1)(ny + 1)] and triangles of a sheet of nx x ny cells."""
    material = [(width * (c / nx - 0.5), height * (r / ny - 0.5)) for r in range(ny + 1) for c in range(nx + 1)]
    faces = []
    for r in range(ny):
        for c in range(nx):
            a = r * (nx + 1) + c
            b, d, e = a + 1, a + nx + 1, a + nx + 2
            faces += [(a, b, e), (a, e, d)] if (r + c) % 2 else [(a, b, d), (b, e, d)]
    return material, faces


def bent(width, height, nx, ny, place):
    """A sheet of which the point (u, v) is at place(u, v, column, row)."""
    material, faces = lattice(width, height, nx, ny)
    points = [place(u, v, i % (nx + 1), i // (nx + 1)) for i, (u, v) in enumerate(material)]
    return obj(points, faces, material)


def spiral(length, height, n, pitch, inner):
    """A sheet rolled up: an Archimedean spiral whose layers are `pitch` apart, without strain along its chords."""
    angle, curve = 0.0, []
    for i in range(n + 1):
        radius = inner + pitch * angle / (2 * math.pi)
        curve.append((radius * math.cos(angle), radius * math.sin(angle)))
        angle += 2 * math.asin(min(1.0, length / n / (2 * radius)))
    rows = max(2, round(height * n / length))
    return bent(length, height, n, rows, lambda u, v, c, r: (curve[c][0], v, curve[c][1]))


def pleats(length, height, n, cells, apart):
    """A sheet of n pleats, each `cells` cells long, folded flat; the layers are `apart` at their open ends."""
    step = length / (n * cells)

    def place(u, v, c, r):
        fold, k = divmod(c, cells)
        return ((k if fold % 2 == 0 else cells - k) * step, v, c * apart / cells)

    return bent(length, height, n * cells, max(2, round(height / step)), place)


def tiny_edge(size, n, edge):
    """A sheet with one triangle of the given edge length in the middle of one of its triangles, tied to its corners."""
    material, faces = lattice(size, size, n, n)
    a, b, c = faces.pop(len(faces) // 2)
    x, y = [sum(material[i][k] for i in (a, b, c)) / 3 for k in (0, 1)]
    first = len(material)
    toward = [(material[i][0] - x, material[i][1] - y) for i in (a, b, c)]
    radius = edge / math.sqrt(3)
    material += [(x + radius * u / math.hypot(u, v), y + radius * v / math.hypot(u, v)) for u, v in toward]
    d, e, f = first, first + 1, first + 2
    faces += [(d, e, f), (a, b, e), (a, e, d), (b, c, f), (b, f, e), (c, a, d), (c, d, f)]
    return obj([(u, v, 0) for u, v in material], faces, material)


def graded(width, height, n, ratio):
    """A strip whose cells grow from left to right so that the area of the last is `ratio` times the first's."""
    q = ratio ** (1 / (n - 1))
    edges = [sum(q ** i for i in range(k)) for k in range(n + 1)]
    material, faces = lattice(width, height, n, 3)
    material = [(width * (edges[i % (n + 1)] / edges[n] - 0.5), v) for i, (u, v) in enumerate(material)]
    return obj([(u, v, 0) for u, v in material], faces, material)
