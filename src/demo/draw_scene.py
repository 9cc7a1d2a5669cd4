#!/usr/bin/python3
"""Draws one step of a run as PNG, from the OBJ files that `cloth run --mesh-every` wrote. Needs nothing but Python.

    draw_scene.py DIR STEP OUT.png [--eye X Y Z] [--at X Y Z] [--size W H] [--without NAME ...]

Cloths are coloured, each side in its own; bodies are grey. Perspective, z up, one light, no edges.
"""
import argparse
import csv
import math
import os
import struct
import zlib

FRONT = ((120, 170, 235), (140, 215, 150), (240, 150, 130))
BACK = ((235, 190, 120), (220, 150, 200), (160, 160, 240))
BODY = (185, 185, 185)
LIGHT = (0.37, -0.47, 0.80)
FIELD_OF_VIEW = 35  # degrees


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(dot(a, a)) or 1
    return tuple(x / length for x in a)


def read_obj(path):
    vertices, triangles = [], []
    with open(path) as file:
        for line in file:
            if line.startswith('v '):
                vertices.append(tuple(float(word) for word in line.split()[1:4]))
            elif line.startswith('f '):
                triangles.append(tuple(int(word.split('/')[0]) - 1 for word in line.split()[1:4]))
    return vertices, triangles


class Picture:
    def __init__(self, size, eye, at):
        self.width, self.height = size
        self.eye = eye
        self.ahead = unit(minus(at, eye))
        self.right = unit(cross(self.ahead, (0, 0, 1)))
        self.up = cross(self.right, self.ahead)
        self.scale = self.height / 2 / math.tan(math.radians(FIELD_OF_VIEW) / 2)
        self.depth = [math.inf] * (self.width * self.height)
        self.pixel = bytearray(b'\xff' * (3 * self.width * self.height))

    def project(self, vertex):
        ray = minus(vertex, self.eye)
        depth = dot(ray, self.ahead)
        if depth < 1e-3:
            return None
        return (self.width / 2 + self.scale * dot(ray, self.right) / depth,
                self.height / 2 - self.scale * dot(ray, self.up) / depth, depth)

    def draw(self, vertices, triangles, front, back):
        points = [self.project(vertex) for vertex in vertices]
        for triangle in triangles:
            corners = [points[v] for v in triangle]
            if None in corners:
                continue
            a, b, c = (vertices[v] for v in triangle)
            normal = unit(cross(minus(b, a), minus(c, a)))
            colour = front if dot(normal, minus(self.eye, a)) > 0 else back
            shade = 0.35 + 0.65 * abs(dot(normal, LIGHT))
            self.fill(corners, bytes(min(255, int(shade * channel)) for channel in colour))

    def fill(self, corners, colour):
        (x0, y0, z0), (x1, y1, z1), (x2, y2, z2) = corners
        area = (y1 - y2) * (x0 - x2) + (x2 - x1) * (y0 - y2)
        if abs(area) < 1e-9:
            return
        rows = range(max(0, math.floor(min(y0, y1, y2))), min(self.height - 1, math.ceil(max(y0, y1, y2))) + 1)
        columns = range(max(0, math.floor(min(x0, x1, x2))), min(self.width - 1, math.ceil(max(x0, x1, x2))) + 1)
        for y in rows:
            for x in columns:
                u = ((y1 - y2) * (x - x2) + (x2 - x1) * (y - y2)) / area
                v = ((y2 - y0) * (x - x2) + (x0 - x2) * (y - y2)) / area
                if min(u, v, 1 - u - v) < -1e-9:
                    continue
                depth, i = u * z0 + v * z1 + (1 - u - v) * z2, y * self.width + x
                if depth < self.depth[i]:
                    self.depth[i] = depth
                    self.pixel[3 * i:3 * i + 3] = colour

    def write(self, path):
        def chunk(kind, data):
            return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))

        row = 3 * self.width
        lines = b''.join(b'\0' + bytes(self.pixel[row * y:row * (y + 1)]) for y in range(self.height))
        header = struct.pack('>IIBBBBB', self.width, self.height, 8, 2, 0, 0, 0)
        with open(path, 'wb') as file:
            file.write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', header) + chunk(b'IDAT', zlib.compress(lines, 9)) + chunk(b'IEND', b''))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('folder')
    parser.add_argument('step', type=int)
    parser.add_argument('out')
    parser.add_argument('--eye', type=float, nargs=3, default=(-1.2, -1.4, 1.0))
    parser.add_argument('--at', type=float, nargs=3, default=(0, 0, 0))
    parser.add_argument('--size', type=int, nargs=2, default=(300, 220))
    parser.add_argument('--without', nargs='*', default=())
    arguments = parser.parse_args()
    picture, cloths = Picture(arguments.size, arguments.eye, arguments.at), 0
    with open(os.path.join(arguments.folder, 'meshes.csv'), newline='') as file:
        rows = [row for row in csv.DictReader(file) if row['file'] not in arguments.without]
    for row in rows:
        mesh = read_obj(os.path.join(arguments.folder, '%s_%06d.obj' % (row['file'], arguments.step)))
        colours = (BODY, BODY)
        if row['kind'] == 'cloth':
            colours = (FRONT[cloths % 3], BACK[cloths % 3])
            cloths += 1
        picture.draw(*mesh, *colours)
    picture.write(arguments.out)


if __name__ == '__main__':
    main()
