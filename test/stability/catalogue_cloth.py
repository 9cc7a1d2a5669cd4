"""The catalogue: materials, meshes, starts, stacks and rest."""
import math

from entry import Case, add, TOWEL_MASS, drape, DRAPE
from shapes import (DENSITY, ball, bent, both, box, falls, floor, graded, hung, keys,
                    lattice, mesh_cloth, moves, obj, pleats, rod, scene, sheet, spiral, tiny_edge)

add('stiffness_membrane',
    'stretch and shear from 10 to 1e7 N/m: six decades',
    '',
    DRAPE, [
        Case('%g N/m' % k, drape({'stretch_warp': k, 'stretch_weft': k, 'shear': k / 5}), 1)
        for k in (10, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7)
    ],
    quick=True)
add('stiffness_anisotropic', 'warp 1e2 and 1e4 times as stiff as weft and shear', '', DRAPE,
    [Case('%g' % k, drape({'stretch_warp': 100 * k, 'stretch_weft': 100, 'shear': 20, 'poisson': 0}), 0.6) for k in (1e2, 1e4)])
add('stiffness_bending', 'bending from 1e-8 to 1e-2 N m: six decades; a board and a veil', '', DRAPE,
    [Case('%g N m' % k, drape({'bend_warp': k, 'bend_weft': k}), 1) for k in (1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)])
add('stiffness_contact', 'contact springs over six decades', '', DRAPE,
    [Case('%g' % k, drape(contact_stiffness=k), 1) for k in (0.01, 0.1, 1, 10, 100, 1000, 10000)])
add('density', '1 g/m^2 to 100 kg/m^2: five decades of mass', '', falls(100 * 0.09, 0.25, 'falls to the floor, at 100 kg/m^2'),
    [Case('%g kg/m^2' % d, drape({'density': d}), 1, energy=falls(d * 0.09, 0.25, '')) for d in (1e-3, 1e-2, 0.1, 1, 10, 100)])
add('damping', 'none to ten seconds', '', DRAPE, [
    Case('%g s' % d, drape({'damping_stretch': d, 'damping_bend': d, 'damping_mass': 100 * d}), 1)
    for d in (0, 1e-4, 1e-2, 1, 10)
])
_light, _heavy = {'density': 1e-3}, {'density': 10}
for _upper, _lower in ((_light, _heavy), (_heavy, _light)):
    _kind = 'light_on_heavy' if _upper is _light else 'heavy_on_light'
    add('mass_ratio_' + _kind, 'neighbours in contact whose masses differ by 1e4', '',
        falls(10.001 * 0.04, 0.25, 'both fall to the floor'), [
            Case(
                '1e4',
                scene([
                    sheet(0.2, 10, (0, 0, 0.15), name='lower', material='lower'),
                    sheet(0.2, 10, (0.01, 0, 0.2), (0.1, 0.1, 0.2), name='upper', material='upper')
                ], [ball(0.05, (0, 0, 0.06)), floor()],
                      materials={'lower': _lower, 'upper': _upper}), 1)
        ])
add('mass_ratio_graded', 'one mesh whose vertices weigh 1 to 1e4 from left to right', '',
    falls(DENSITY * 0.5 * 0.1, 0.3, 'swings down by half its length'), [
        Case('1e4', scene([mesh_cloth(groups={'held': {'box': [[-0.26, -1, -1], [-0.2499, 1, 1]]}}, pins=[{'group': 'held'}])]),
             1, {'mesh.obj': graded(0.5, 0.1, 16, 1e4)})
    ])
add('slivers', 'triangles of aspect 1000: 0.5 m long, 0.5 mm wide, with a thickness of six of them', '',
    falls(DENSITY * 0.5 * 0.02, 0.25, 'falls to the floor'), [
        Case(
            'over a rod',
            scene([sheet([0.5, 0.02], [1, 40], (0, 0, 0.22), pattern='alternating')],
                  [rod(0.03, 0.4,
                       (0, 0, 0.1), turn=(math.pi / 2, 0, 0)), floor()]), 1),
        Case(
            'hanging',
            scene([
                sheet([0.02, 0.5], [40, 1], (0, 0, 0.3), (math.pi / 2, 0, 0),
                      pattern='alternating',
                      groups={'held': {'side': 'top'}},
                      pins=[{'group': 'held'}])
            ]), 1)
    ])


def goes_along(run):
    """Impacts that are none would hold the small triangle, at the end of the list, where it is, and the cloth hang on it."""
    height = run.positions('sheet', run.written()[-1])[-1][2]
    return [('the_triangle_falls_with_the_cloth', height < 0.2, 'ends at %.3g m of 0.33' % height)]


add('tiny_edges', 'a triangle with edges of 1e-6 m in a cloth of 1 m: in float a rounding is 6 % of it', 'the triangle falls with it',
    falls(DENSITY, 0.36, 'falls to the floor'), [
        Case('%g m' % edge, scene([mesh_cloth(at=(0.02, 0.01, 0.33))],
                                  [ball(0.15, (0, 0, 0.16)), floor()]), 1, {'mesh.obj': tiny_edge(1, 12, edge)}, also=goes_along)
        for edge in (1e-3, 1e-4, 1e-5, 1e-6)
    ],
    quick=True)
add('compressed', 'squeezed in its plane to 30, 3 and 0.1 % of its size at the start, in one direction and in both',
    'it spreads again', (2 * 2000 * 0.09, 'E h A: strain energy of the start'), [
        Case(
            '%g x %g' % (a, b), scene([mesh_cloth(at=(0, 0, 0.1))], [floor()]), 0.5, {
                'mesh.obj': bent(
                    0.3, 0.3, 10, 10, lambda u, v, c, r, a=a, b=b: (a * u, b * v, 1e-3 * ((c * 7 + r * 3) % 5) * min(a, b)))
            }) for a, b in ((0.3, 1), (0.03, 1), (1e-3, 1), (0.3, 0.3), (0.03, 0.03), (1e-3, 1e-3))
    ])
add('stretched', 'pulled to three times its size at the start, then let go', '',
    (2 * 0.5 * 2000 * 16 * 0.09, 'E h A / 2 times Green strain squared, twice'), [
        Case('%g' % k, scene([mesh_cloth(at=(0, 0, 0.1))], [floor()]), 0.5,
             {'mesh.obj': bent(0.3, 0.3, 10, 10, lambda u, v, c, r, k=k: (k * u, v, 0))}) for k in (1.5, 3)
    ])


def inverted(every):
    """Every n-th vertex inside the sheet is pulled past its neighbours, in the plane: its triangles turn over."""
    material, faces = lattice(0.3, 0.3, 10, 10)
    points = [[u, v, 0] for u, v in material]
    for i in range(len(points)):
        c, r = i % 11, i // 11
        if 0 < c < 10 and 0 < r < 10 and (c + 3 * r) % every == 0:
            points[i][0] += 0.047
    return obj(points, faces, material)


for _untangle in (False, True):
    add('inverted_' + ('untangled' if _untangle else 'kept'),
        'triangles turned over in the plane of the cloth at the start: they overlap',
        'no more pairs intersect than at the start' if not _untangle else 'nothing intersects at the end',
        (2 * 2000 * 0.09, 'E h A: strain energy of the start'), [
            Case('every %dth' % n, scene([mesh_cloth(at=(0, 0, 0.2))], [floor()], untangle=_untangle), 2 if _untangle else 0.5,
                 {'mesh.obj': inverted(n)}) for n in (7, 3, 2)
        ],
        tangled='worked out' if _untangle else 'kept',
        open={'it_is_worked_out': 'a few pairs may stay: 4 of 272 where every seventh vertex is turned over, in float'} if _untangle else None)
add('mirrored',
    'the mesh is the mirror image of its material: every triangle is inside out',
    '',
    DRAPE, [
        Case('all', scene([mesh_cloth(at=(0, 0, 0.2))], [ball(0.08, (0, 0, 0.1)), floor()]), 1,
             {'mesh.obj': bent(0.3, 0.3, 14, 14, lambda u, v, c, r: (-u, v, 0))})
    ],
    quick=True)
add('one_triangle',
    'the smallest cloths there are: a triangle, a square',
    '',
    falls(0.3 * 0.01, 0.2, 'falls to the floor'), [
        Case('triangle', scene([mesh_cloth(at=(0, 0, 0.15))], [ball(0.05, (0, 0, 0.06)), floor()]), 1,
             {'mesh.obj': obj([(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0)], [(0, 1, 2)], [(0, 0), (0.1, 0), (0, 0.1)])}),
        Case('square', scene([sheet(0.1, 1, (0, 0, 0.15))], [ball(0.05, (0, 0, 0.06)), floor()]), 1)
    ],
    quick=True)
add('thickness', 'from 1e-5 m, a tenth of a hair, to 0.05 m, twice the edges', '', DRAPE, [
    Case('%g m' % t, drape(thickness=t, at=0.25), 1, energy=falls(TOWEL_MASS, 0.28, '')) for t in (1e-5, 1e-4, 1e-3, 0.01, 0.05)
])
add('friction', 'none, and ten times the load', '', DRAPE, [
    Case('%g' % mu,
         scene([sheet(0.3, 14, (0.02, 0.01, 0.22))],
               [ball(0.08, (0, 0, 0.1), friction=mu), floor(friction=mu)], friction=mu), 1) for mu in (0, 10)
])

# ---- cloth let go, stacked, at rest ---------------------------------------------------------------------


def walls(inner, shut, hold, end):
    """Six plates around the origin whose faces close in from `inner` to `shut` m and open again."""
    plates, thick = [], 0.04
    for axis in range(3):
        for side in (-1, 1):
            far, near = [0.0] * 3, [0.0] * 3
            far[axis], near[axis] = side * (inner + thick / 2), side * (shut + thick / 2)
            size = [0.5] * 3
            size[axis] = thick
            plates.append(
                box('plate_%s%d' % ('mp'[side > 0], axis),
                    size,
                    far,
                    motion=keys((0, far), (0.8, near), (hold, near), (end, far))))
    return plates


add(
    'balled_up_and_released', 'six plates press a towel of 0.3 m into a cube of 0.12 m and fly apart', '',
    both(moves(TOWEL_MASS, 2 * 0.9, 'all of it at twice the speed of the plates'),
         falls(TOWEL_MASS, 0.3, 'falls as deep as it is large')),
    [Case('plates', scene([sheet(0.3, 16, (0, 0, 0.01), (0.2, 0.1, 0.3))], walls(0.23, 0.06, 0.9, 1.0)), 1.5)])
add(
    'rolled_up_and_released', 'a towel rolled into a spiral with layers 1.5 mm apart, at a thickness of 3 mm', '',
    both((0.5 * TOWEL_MASS * (0.003 * 60 * 3) ** 2, 'all of it at three thicknesses a step'),
         falls(TOWEL_MASS, 0.1, 'falls to the floor')), [
             Case('spiral',
                  scene([mesh_cloth(at=(0, 0, 0.1))], [floor()]),
                  1, {'mesh.obj': spiral(0.3, 0.1, 60, 0.0015, 0.006)},
                  tells=('contacts_self', ))
         ])
add(
    'pleated_and_released', 'twelve pleats pressed flat, 1 mm apart, at a thickness of 3 mm', '',
    both((0.5 * TOWEL_MASS * (0.003 * 60 * 3) ** 2, 'all of it at three thicknesses a step'),
         falls(TOWEL_MASS, 0.1, 'falls to the floor')), [
             Case('pleats',
                  scene([mesh_cloth(at=(0, 0, 0.05))], [floor()]),
                  1, {'mesh.obj': pleats(0.48, 0.1, 12, 4, 0.001)},
                  tells=('contacts_self', ))
         ])


def stack(n):
    return scene([
        sheet(0.12, 5, (0.001 * (i % 3), 0.001 * (i % 2), 0.004 + 0.0033 * i), (0, 0, 0.1 * (i % 4)), name='layer_%d' % i)
        for i in range(n)
    ], [floor()])


for _name, _n, _seconds in (('ten_layers', 10, 0.4), ('fifty_layers', 50, 1)):
    add(_name,
        '%d sheets stacked: the load of all passes through every layer' % _n,
        '',
        falls(_n * DENSITY * 0.0144, 0.0015 * _n, 'what the stack falls by its own slack, and half as much again for corners'),
        [Case(str(_n), stack(_n), _seconds, written=12)],
        quick=_n == 10)


def at_rest(run):
    """Creep and energy over the last nine tenths of a long rest."""
    steps = run.written()
    first = next(step for step in steps if step >= len(run.rows) // 10)
    names = [name for name, kind in run.kinds().items() if kind == 'cloth']
    creep = max(math.dist(a, b) for name in names for a, b in zip(run.positions(name, first), run.positions(name, steps[-1])))
    rest = [row['energy_kinetic'] for row in run.rows[len(run.rows) // 10:]]
    early, late = max(rest[:len(rest) // 2]), max(rest[len(rest) // 2:])
    return [('nothing_creeps', creep <= 1e-3, 'creep %.3g m, bound 0.001 m' % creep),
            ('no_energy_is_gained', late <= max(2 * early, 1e-9), 'kinetic energy %.2g J late, %.2g J early' % (late, early))]


REST = [('on a table', scene([sheet(0.3, 8, (0, 0, 0.052))], [box('table', (0.22, 0.22, 0.1), friction=0.5)])),
        ('folded', scene([mesh_cloth(at=(0, 0, 0.02))], [floor(friction=0.5)])), ('hanging', scene([hung(0.3, 8)]))]
REST_FILES = {'mesh.obj': pleats(0.24, 0.12, 2, 6, 0.012)}
for _name, _seconds in (('ten_minutes_at_rest', 600), ('half_a_minute_at_rest', 30)):
    add(_name, 'errors of every step add up: on a table, folded, hanging',
        'after a tenth of the time: creep below 1 mm, no energy gained',
        falls(DENSITY * 0.09, 0.15, 'its rim sinks by half its size'), [
            Case(label, what, _seconds, REST_FILES if label == 'folded' else None, written=12, also=at_rest)
            for label, what in REST
        ])
