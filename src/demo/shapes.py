"""Collision geometry of a URDF and of a scene's boxes as triangles, and OBJ files of them. No ROS needed.

Kept apart from the node's own mesh loading on purpose: what checks the node must not share its code.
A shape is (points [[x, y, z], ...] in m, triangles [[i, j, k], ...] counter-clockwise from outside).
"""
import math
import os
import struct
import xml.etree.ElementTree as ElementTree

import arm

BOX_FACES = ((0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
             (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5))


def box(size):
    points = [[s / 2 if i >> k & 1 else -s / 2 for k, s in enumerate(size)] for i in range(8)]
    return points, [list(face) for face in BOX_FACES]


def cylinder(radius, length, sides=32):
    """Along z, centred; its corners lie on the cylinder, so it is nowhere larger."""
    points = [[radius * math.cos(2 * math.pi * i / sides), radius * math.sin(2 * math.pi * i / sides), z]
              for z in (-length / 2, length / 2) for i in range(sides)] + [[0, 0, -length / 2], [0, 0, length / 2]]
    faces = []
    for i in range(sides):
        j = (i + 1) % sides
        faces += [[i, j, sides + j], [i, sides + j, sides + i], [2 * sides, j, i], [2 * sides + 1, sides + i, sides + j]]
    return points, faces


def welded(corners):
    """A shape from triangles given by their corners; equal corners become one point."""
    index, faces = {}, []
    for corner in corners:
        faces.append(index.setdefault(tuple(corner), len(index)))
    return [list(p) for p in index], [faces[i:i + 3] for i in range(0, len(faces), 3)]


def read_stl(path):
    with open(path, 'rb') as file:
        data = file.read()
    count, = struct.unpack_from('<I', data, 80)
    if len(data) != 84 + 50 * count:
        raise ValueError('%s is not a binary STL' % path)
    return welded(struct.unpack_from('<3f', data, 96 + 50 * i + 12 * k) for i in range(count) for k in range(3))


def read_dae(path):
    """A Collada file as make_meshes.py writes it: one mesh, metres, z up."""
    root = ElementTree.parse(path)
    by_id = {e.get('id'): e for e in root.iter() if e.get('id')}
    numbers = [float(v) for v in by_id['points-array'].text.split()]
    points = [numbers[i:i + 3] for i in range(0, len(numbers), 3)]
    triangles = next(e for e in root.iter() if e.tag.endswith('}triangles'))
    stride = len([e for e in triangles if e.tag.endswith('}input')])
    indices = [int(v) for v in next(e for e in triangles if e.tag.endswith('}p')).text.split()][::stride]
    return welded(points[i] for i in indices)


def moved(shape, t):
    points, faces = shape
    return [[t[r][0] * x + t[r][1] * y + t[r][2] * z + t[r][3] for r in range(3)] for x, y, z in points], faces


def collision_shapes(urdf, package_folder):
    """{link: [shape in the link's frame]} of every <collision>; meshes of package://NAME/ from package_folder."""
    out = {}
    for link in ElementTree.fromstring(urdf).findall('link'):
        for collision in link.findall('collision'):
            origin = collision.find('origin')
            numbers = [[float(v) for v in (origin.get(key) if origin is not None and origin.get(key) else '0 0 0').split()]
                       for key in ('xyz', 'rpy')]
            geometry = collision.find('geometry')[0]
            if geometry.tag == 'box':
                shape = box([float(v) for v in geometry.get('size').split()])
            elif geometry.tag == 'cylinder':
                shape = cylinder(float(geometry.get('radius')), float(geometry.get('length')))
            elif geometry.tag == 'mesh':
                path = os.path.join(package_folder, geometry.get('filename').split('/', 3)[3])
                shape = read_stl(path) if path.endswith('.stl') else read_dae(path)
            else:
                raise ValueError('link "%s": no shape for <%s>' % (link.get('name'), geometry.tag))
            out.setdefault(link.get('name'), []).append(moved(shape, arm.pose(*numbers)))
    return out


def scene_boxes(scene):
    """{body: shape in the scene frame} of the boxes of a parsed scene file."""
    out = {}
    for body in scene.get('bodies') or []:
        place = body.get('pose') or {}
        if 'box' in body:
            out[body['name']] = moved(box(body['box']['size']),
                                      arm.pose(place.get('position', (0, 0, 0)), place.get('rpy', (0, 0, 0))))
    return out


class Folder:
    """A folder of meshes as `cloth run --mesh-every` writes it: NAME_STEP.obj, and what each NAME is in meshes.csv."""

    def __init__(self, path, cloths, bodies):
        os.makedirs(path, exist_ok=True)
        self.path = path
        with open(os.path.join(path, 'meshes.csv'), 'w') as out:
            out.write('kind,file,name\n')
            out.writelines('%s,%s,%s\n' % (kind, name, name) for kind, names in (('cloth', cloths), ('body', bodies))
                           for name in names)

    def write(self, name, step, points, triangles):
        lines = ['# %s step %d' % (name, step)]
        lines += ['v %.9g %.9g %.9g' % tuple(p) for p in points]
        lines += ['f %d %d %d' % (a + 1, b + 1, c + 1) for a, b, c in triangles]
        with open(os.path.join(self.path, '%s_%06d.obj' % (name, step)), 'w') as out:
            out.write('\n'.join(lines) + '\n')
