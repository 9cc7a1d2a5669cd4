#!/usr/bin/python3
"""Writes the bodies of config/scenes that no primitive makes: run once after a change, commit what it writes.

    src/demo/make_scene_meshes.py [OUTPUT_FOLDER]

Each file is one or more closed solids that face outwards; both are checked before anything is written.
Lengths are metres, z is up.
"""
import math
import os
import sys

from make_meshes import check_closed, loft


def turned(profile, segments):
    """Solid of revolution about z: `profile` is a closed outline of (r, z), counter-clockwise with r to the
    right and z up; no point lies on the axis."""
    def point(k, i):
        angle = 2 * math.pi * (i % segments) / segments
        radius, z = profile[k % len(profile)]
        return (radius * math.cos(angle), radius * math.sin(angle), z)

    triangles = []
    for k in range(len(profile)):
        for i in range(segments):
            a, b = point(k, i), point(k, i + 1)
            c, d = point(k + 1, i + 1), point(k + 1, i)
            triangles += [(a, b, c), (a, c, d)]
    return triangles


def funnel():
    """A bowl of 0.55 m radius over a neck of 0.1 m, 15 mm thick; the neck's upper end is at z = 0."""
    return [turned([(0.10, -0.30), (0.115, -0.30), (0.115, -0.01), (0.57, 0.25), (0.55, 0.25), (0.10, 0.0)], 64)]


def spike(x, y, z, radius, height, segments):
    ring = [(x + radius * math.cos(2 * math.pi * i / segments), y + radius * math.sin(2 * math.pi * i / segments), z - height)
            for i in range(segments)]
    triangles = [(ring[i], ring[(i + 1) % segments], (x, y, z)) for i in range(segments)]
    return triangles + [(ring[0], ring[i + 1], ring[i]) for i in range(1, segments - 1)]


def needles():
    """10 x 10 needles 0.1 m apart, 0.1 m high, tips at z = 0."""
    return [spike(0.1 * i - 0.45, 0.1 * j - 0.45, 0.0, 0.008, 0.1, 6) for i in range(10) for j in range(10)]


def knives():
    """Nine blades 60 mm apart, 0.6 m long in y, 50 mm deep, edges up at z = 0."""
    blades = []
    for i in range(9):
        x = 0.06 * (i - 4)
        section = [(x - 0.004, -0.05), (x + 0.004, -0.05), (x, 0.0)]
        blades.append(loft([[(u, y, v) for u, v in section] for y in (0.3, -0.3)]))
    return blades


def finger():
    """A finger of 0.12 m that hangs down from its knuckle at the origin, 24 mm thick, rounded at its end."""
    rings = []
    for z, radius in ((-0.12, 0.004), (-0.117, 0.008), (-0.11, 0.011), (0.0, 0.012)):
        rings.append([(radius * math.cos(2 * math.pi * i / 12), radius * math.sin(2 * math.pi * i / 12), z)
                      for i in range(12)])
    return [loft(rings)]


def write_obj(path, what, solids):
    lines, count = [], 0
    for triangles in solids:
        numbers = {}  # of this solid's corners
        for triangle in triangles:
            for corner in triangle:
                if corner not in numbers:
                    count += 1
                    numbers[corner] = count
                    lines.append('v %.9g %.9g %.9g' % corner)
        lines += ['f %d %d %d' % tuple(numbers[corner] for corner in triangle) for triangle in triangles]
    with open(path, 'w') as out:
        out.write('\n'.join(['# ' + what, '# written by src/demo/make_scene_meshes.py'] + lines) + '\n')


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(__file__), '../../config/meshes')
    for make in (funnel, needles, knives, finger):
        solids = make()
        for solid in solids:
            check_closed(make.__name__, solid)
        write_obj(os.path.join(folder, make.__name__ + '.obj'), ' '.join(make.__doc__.split()), solids)


if __name__ == '__main__':
    main()
