#!/usr/bin/python3
"""The demo's collision geometry, as the independent check of intersections sees it: src/demo/shapes.py."""
import math
import os
import sys
import unittest

HERE = os.path.dirname(os.path.realpath(__file__))
SOURCE = os.environ.get('ROBOT_CLOTH_SOURCE', os.path.join(HERE, '../..'))
sys.path.insert(0, os.path.join(SOURCE, 'src/demo'))
import shapes  # noqa: E402


def volume(shape):
    """Signed, by the divergence theorem; positive when the triangles face outwards."""
    points, faces = shape
    total = 0.0
    for a, b, c in faces:
        p, q, r = points[a], points[b], points[c]
        total += (p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2])
                  + p[2] * (q[0] * r[1] - q[1] * r[0])) / 6
    return total


def is_closed(shape):
    edges = [edge for a, b, c in shape[1] for edge in ((a, b), (b, c), (c, a))]
    return len(set(edges)) == len(edges) and all((b, a) in set(edges) for a, b in edges)


class ShapesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open(os.path.join(SOURCE, 'config/robots/two_arm/two_arm.urdf')) as file:
            cls.links = shapes.collision_shapes(file.read(), SOURCE)

    def test_every_shape_is_closed_and_faces_outwards(self):
        for link, parts in self.links.items():
            for part in parts:
                self.assertTrue(is_closed(part), link)
                self.assertGreater(volume(part), 0, link)

    def test_primitives_have_their_volume(self):
        self.assertAlmostEqual(volume(shapes.box([0.2, 0.3, 0.4])), 0.024, places=12)
        # a 64-gon in a circle has the share sin(a) / a of its area, a = 2 pi / 64
        share = math.sin(2 * math.pi / 64) / (2 * math.pi / 64)
        self.assertAlmostEqual(volume(shapes.cylinder(0.1, 0.5, 64)), math.pi * 0.005 * share, places=12)

    def test_every_link_with_a_collision_element_is_there(self):
        self.assertEqual(len(self.links), 17)
        self.assertNotIn('left_tool', self.links)

    def test_collision_meshes_are_low_poly(self):
        for side in ('left', 'right'):
            for finger in ('finger', 'mimic_finger'):
                self.assertLess(len(self.links['%s_%s' % (side, finger)][0][1]), 200)
        self.assertLess(sum(len(part[1]) for parts in self.links.values() for part in parts), 2000)

    def test_collision_meshes_hold_the_visual_ones(self):
        folder = os.path.join(SOURCE, 'config/robots/two_arm/meshes')
        for name in ('upper_arm', 'forearm'):
            inner, _ = shapes.read_dae(os.path.join(folder, name + '.dae'))
            outer, faces = shapes.read_dae(os.path.join(folder, name + '_collision.dae'))
            for a, b, c in faces:  # convex: every point lies behind every face
                u = [outer[b][k] - outer[a][k] for k in range(3)]
                v = [outer[c][k] - outer[a][k] for k in range(3)]
                n = [u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3] for k in range(3)]
                size = math.sqrt(sum(x * x for x in n))
                for p in inner:  # 2e-6: points are written to six digits
                    self.assertLess(sum(n[k] * (p[k] - outer[a][k]) for k in range(3)) / size, 2e-6, name)


if __name__ == '__main__':
    unittest.main(verbosity=2)
