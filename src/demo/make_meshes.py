#!/usr/bin/python3
"""Writes the meshes of config/robots/two_arm: run once after a change, commit what it writes.

    src/demo/make_meshes.py [OUTPUT_FOLDER]

Every part is a loft: rings of equally many points, joined by quads and closed by two fans. So every
mesh is closed and its triangles face outwards; both are checked before anything is written.
Lengths are metres. Visual meshes are round, collision meshes are low-poly and hold the visual ones.
"""
import math
import os
import struct
import sys


def loft(rings):
    """Triangles ((x, y, z) x 3) of a closed solid through `rings`, counter-clockwise seen from the end."""
    triangles = []
    count = len(rings[0])
    for low, high in zip(rings, rings[1:]):
        for i in range(count):
            j = (i + 1) % count
            triangles.append((low[i], low[j], high[j]))
            triangles.append((low[i], high[j], high[i]))
    for i in range(1, count - 1):
        triangles.append((rings[0][0], rings[0][i + 1], rings[0][i]))
        triangles.append((rings[-1][0], rings[-1][i], rings[-1][i + 1]))
    return triangles


def check_closed(name, triangles):
    """Each directed edge once and its reverse once, no zero area, volume positive."""
    edges = set()
    volume = 0.0
    for a, b, c in triangles:
        for edge in ((a, b), (b, c), (c, a)):
            if edge in edges:
                raise SystemExit('%s: edge %s is used twice' % (name, edge))
            edges.add(edge)
        cross = [(b[(k + 1) % 3] - a[(k + 1) % 3]) * (c[(k + 2) % 3] - a[(k + 2) % 3])
                 - (b[(k + 2) % 3] - a[(k + 2) % 3]) * (c[(k + 1) % 3] - a[(k + 1) % 3]) for k in range(3)]
        if sum(v * v for v in cross) < 1e-18:
            raise SystemExit('%s: triangle without area at %s' % (name, a))
        volume += sum(cross[k] * a[k] for k in range(3)) / 6
    if any((b, a) not in edges for a, b in edges) or volume <= 0:
        raise SystemExit('%s: not closed or inside out (volume %g)' % (name, volume))


def stadium(length, radius0, radius1, segments):
    """Outline of two discs, at x = 0 and x = length, and their common tangents; counter-clockwise."""
    lean = math.asin((radius0 - radius1) / length)
    points = []
    for centre, radius, start, end in ((length, radius1, -math.pi / 2 + lean, math.pi / 2 - lean),
                                       (0.0, radius0, math.pi / 2 - lean, 3 * math.pi / 2 + lean)):
        for i in range(segments + 1):
            angle = start + (end - start) * i / segments
            points.append((centre + radius * math.cos(angle), radius * math.sin(angle)))
    return points


def arm_link(length, radius0, radius1, thickness, bevel, segments):
    """A link between two parallel vertical axes, `thickness` high, centred on z = 0."""
    half = thickness / 2
    levels = [(-half, 0.0), (half, 0.0)]
    if bevel > 0:
        levels = [(-half, bevel), (-half + 0.3 * bevel, 0.3 * bevel), (-half + bevel, 0.0),
                  (half - bevel, 0.0), (half - 0.3 * bevel, 0.3 * bevel), (half, bevel)]
    return loft([[(x, y, z) for x, y in stadium(length, radius0 - inset, radius1 - inset, segments)]
                 for z, inset in levels])


def finger():
    """A finger along +x; the pad is the plane z = 0 from x = 0.040 to x = 0.070, outside is +z.

    Its inner edges are bevelled and its tip is short, so that cloth bends around them.
    """
    def ring(x, low, high, half_width, bevel):
        return [(x, y, z) for y, z in (
            (half_width - bevel, low), (half_width, low + bevel), (half_width, high - bevel),
            (half_width - bevel, high), (bevel - half_width, high), (-half_width, high - bevel),
            (-half_width, low + bevel), (bevel - half_width, low))]
    return loft([ring(0.000, 0.004, 0.022, 0.014, 0.002), ring(0.032, 0.004, 0.017, 0.016, 0.002),
                 ring(0.040, 0.000, 0.014, 0.016, 0.003), ring(0.070, 0.000, 0.010, 0.016, 0.003),
                 ring(0.0745, 0.0035, 0.007, 0.012, 0.001)])


def rounded_box(size, radius, segments):
    """A box centred on the origin with its vertical edges rounded and top and bottom bevelled."""
    x, y, z = (s / 2 for s in size)
    bevel = radius / 3
    rings = []
    for level, inset in ((-z, bevel), (-z + bevel, 0.0), (z - bevel, 0.0), (z, bevel)):
        ring = []
        for cx, cy, start in ((x, -y, -90), (x, y, 0), (-x, y, 90), (-x, -y, 180)):
            for i in range(segments + 1):
                angle = math.radians(start + 90.0 * i / segments)
                ring.append((math.copysign(abs(cx) - radius, cx) + (radius - inset) * math.cos(angle),
                             math.copysign(abs(cy) - radius, cy) + (radius - inset) * math.sin(angle), level))
        rings.append(ring)
    return loft(rings)


def write_stl(path, triangles):
    with open(path, 'wb') as out:
        out.write(b'robot_cloth two_arm, metres'.ljust(80, b' '))
        out.write(struct.pack('<I', len(triangles)))
        for triangle in triangles:
            out.write(struct.pack('<12fH', 0, 0, 0, *[c for corner in triangle for c in corner], 0))


DAE = '''<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset>
    <created>2024-01-01T00:00:00Z</created><modified>2024-01-01T00:00:00Z</modified>
    <unit name="meter" meter="1"/><up_axis>Z_UP</up_axis>
  </asset>
  <library_effects><effect id="shell-effect"><profile_COMMON><technique sid="common"><phong>
    <ambient><color>{colour}</color></ambient><diffuse><color>{colour}</color></diffuse>
    <specular><color>0.25 0.25 0.25 1</color></specular><shininess><float>30</float></shininess>
  </phong></technique></profile_COMMON></effect></library_effects>
  <library_materials><material id="shell"><instance_effect url="#shell-effect"/></material></library_materials>
  <library_geometries><geometry id="part"><mesh>
    <source id="points"><float_array id="points-array" count="{point_numbers}">{points}</float_array>
      <technique_common><accessor source="#points-array" count="{point_count}" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common></source>
    <source id="normals"><float_array id="normals-array" count="{normal_numbers}">{normals}</float_array>
      <technique_common><accessor source="#normals-array" count="{normal_count}" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common></source>
    <vertices id="vertices"><input semantic="POSITION" source="#points"/></vertices>
    <triangles count="{triangle_count}" material="shell">
      <input semantic="VERTEX" source="#vertices" offset="0"/><input semantic="NORMAL" source="#normals" offset="1"/>
      <p>{indices}</p></triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="scene"><node id="node">
    <instance_geometry url="#part"><bind_material><technique_common>
      <instance_material symbol="shell" target="#shell"/>
    </technique_common></bind_material></instance_geometry>
  </node></visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
'''


def corner_normals(triangles, crease):
    """Per corner: the mean of the face normals around that point that are within `crease` of this face."""
    faces = []
    around = {}
    for index, (a, b, c) in enumerate(triangles):
        u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
        n = [u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3] for k in range(3)]
        size = math.sqrt(sum(x * x for x in n))
        faces.append(([x / size for x in n], size))
        for point in (a, b, c):
            around.setdefault(point, []).append(index)
    normals = []
    for index, triangle in enumerate(triangles):
        own = faces[index][0]
        for point in triangle:
            near = [faces[i] for i in around[point] if sum(p * q for p, q in zip(faces[i][0], own)) > math.cos(crease)]
            total = [sum(n[k] * size for n, size in near) for k in range(3)]
            length = math.sqrt(sum(x * x for x in total))
            normals.append(tuple(round(x / length, 4) for x in total))
    return normals


def write_dae(path, triangles, colour):
    points, normals = {}, {}
    indices = []
    for corner, normal in zip((p for t in triangles for p in t), corner_normals(triangles, math.radians(35))):
        indices.append(points.setdefault(corner, len(points)))
        indices.append(normals.setdefault(normal, len(normals)))
    def text(table, form):
        return ' '.join(form % value for entry in table for value in entry)
    with open(path, 'w') as out:
        out.write(DAE.format(colour=colour, points=text(points, '%.6g'), point_count=len(points),
                             point_numbers=3 * len(points), normals=text(normals, '%.4g'),
                             normal_count=len(normals), normal_numbers=3 * len(normals),
                             triangle_count=len(triangles), indices=' '.join(map(str, indices))))


WHITE, DARK = '0.92 0.92 0.90 1', '0.16 0.17 0.19 1'
PARTS = (
    # file, mesh, colour of a DAE
    ('finger.stl', finger(), None),
    ('upper_arm_collision.dae', arm_link(0.28, 0.050, 0.045, 0.064, 0, 6), WHITE),
    ('upper_arm.dae', arm_link(0.28, 0.048, 0.043, 0.064, 0.008, 24), WHITE),
    ('forearm_collision.dae', arm_link(0.26, 0.044, 0.038, 0.052, 0, 6), WHITE),
    ('forearm.dae', arm_link(0.26, 0.042, 0.036, 0.052, 0.007, 24), WHITE),
    ('carriage.dae', rounded_box((0.15, 0.13, 0.13), 0.018, 6), DARK),
    ('palm.dae', rounded_box((0.05, 0.064, 0.13), 0.010, 6), DARK),
)


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.join(here, '../../config/robots/two_arm/meshes')
    for name, triangles, colour in PARTS:
        triangles = [tuple(tuple(round(c, 6) + 0.0 for c in p) for p in t) for t in triangles]
        check_closed(name, triangles)
        path = os.path.join(folder, name)
        if colour is None:
            write_stl(path, triangles)
        else:
            write_dae(path, triangles, colour)
        print('%-26s %4d triangles' % (name, len(triangles)))


if __name__ == '__main__':
    main()
