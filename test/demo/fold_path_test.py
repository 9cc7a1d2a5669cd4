#!/usr/bin/python3
"""The demo's motion: src/demo/fold_path.py on the demo's robot and scene."""
import math
import os
import struct
import sys
import unittest
import xml.etree.ElementTree as ElementTree

HERE = os.path.dirname(os.path.realpath(__file__))
SOURCE = os.environ.get('ROBOT_CLOTH_SOURCE', os.path.join(HERE, '../..'))
sys.path.insert(0, os.path.join(SOURCE, 'src/demo'))
import arm  # noqa: E402
import fold_path  # noqa: E402
import yaml  # noqa: E402

URDF = os.path.join(SOURCE, 'config/robots/two_arm/two_arm.urdf')
RATE = 100.0  # Hz, that of the joint states


def load():
    with open(URDF) as file:
        robot = arm.Robot(file.read())
    with open(os.path.join(SOURCE, 'config/scenes/fold.yaml')) as file:
        scene = yaml.safe_load(file)
    return robot, scene


def collision_points(robot_text, folder):
    """{link: points [m] in the link's frame}: corners that the convex hull of each <collision> lies within."""
    out = {}
    for link in ElementTree.fromstring(robot_text).findall('link'):
        points = []
        for collision in link.findall('collision'):
            origin = collision.find('origin')
            place = arm.pose([float(v) for v in origin.get('xyz').split()],
                             [float(v) for v in origin.get('rpy', '0 0 0').split()])
            shape = collision.find('geometry')[0]
            if shape.tag == 'box':
                half = [float(v) / 2 for v in shape.get('size').split()]
            elif shape.tag == 'cylinder':
                half = [float(shape.get('radius'))] * 2 + [float(shape.get('length')) / 2]
            else:
                low, high = mesh_bounds(os.path.join(folder, os.path.basename(shape.get('filename'))))
                place = arm.product(place, arm.translation(*((a + b) / 2 for a, b in zip(low, high))))
                half = [(b - a) / 2 for a, b in zip(low, high)]
            for i in range(8):
                corner = [h if i >> k & 1 else -h for k, h in enumerate(half)]
                points.append([sum(place[r][k] * corner[k] for k in range(3)) + place[r][3] for r in range(3)])
        out[link.get('name')] = points
    return out


def mesh_bounds(path):
    if path.endswith('.stl'):
        with open(path, 'rb') as file:
            data = file.read()
        count, = struct.unpack_from('<I', data, 80)
        points = [struct.unpack_from('<3f', data, 84 + 50 * i + 12 + 12 * k) for i in range(count) for k in range(3)]
    else:
        text = next(e for e in ElementTree.parse(path).iter() if e.get('id') == 'points-array').text.split()
        points = [[float(v) for v in text[i:i + 3]] for i in range(0, len(text), 3)]
    return [min(p[k] for p in points) for k in range(3)], [max(p[k] for p in points) for k in range(3)]


class FoldPathTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot, cls.scene = load()
        cls.path = fold_path.FoldPath(cls.robot, fold_path.task_from_scene(cls.scene))
        cls.times = [i / RATE for i in range(int(cls.path.duration * RATE) + 2)]
        cls.positions = [cls.path.positions(t) for t in cls.times]

    def test_joints_stay_within_their_position_and_velocity_limits(self):
        for t, before, after in zip(self.times, self.positions, self.positions[1:]):
            for name, value in after.items():
                joint = self.robot.joint(name)
                self.assertTrue(joint.lower <= value <= joint.upper, '%s = %g at %g s' % (name, value, t))
                self.assertLess(abs(value - before[name]) * RATE, joint.velocity, '%s at %g s' % (name, t))

    def test_velocities_are_the_slope_of_the_positions(self):
        for t, before, here, after in zip(self.times[1:], self.positions, self.positions[1:], self.positions[2:]):
            for name, speed in self.path.velocities(t).items():
                # the velocity lies between the mean slopes before and after; 0.05 for where segments meet
                slopes = ((here[name] - before[name]) * RATE, (after[name] - here[name]) * RATE)
                self.assertTrue(min(slopes) - 0.05 <= speed <= max(slopes) + 0.05, '%s at %g s' % (name, t))

    def test_the_motion_is_continuous_and_starts_and_ends_at_rest(self):
        for name in self.positions[0]:
            speeds = [(b[name] - a[name]) * RATE for a, b in zip(self.positions, self.positions[1:])]
            for a, b in zip([0] + speeds, speeds + [0]):
                self.assertLess(abs(b - a) * RATE, 40)  # rad/s^2 or m/s^2: a jump would be a hundred times this
        for value, expected in zip(self.path.velocities(-1.0).values(), [0] * 12):
            self.assertEqual(value, expected)

    def test_it_returns_to_where_it_started(self):
        for name, value in self.path.positions(self.path.duration + 5).items():
            self.assertAlmostEqual(value, self.positions[0][name], places=9)

    def test_no_mimic_joint_is_published(self):
        self.assertEqual(len(self.positions[0]), 12)
        for name in self.positions[0]:
            self.assertIsNone(self.robot.joint(name).mimics)

    def test_fingers_close_and_leave_slowly(self):
        limits = dict(close=0.1, open=0.1, retract=0.1)
        for t in self.times:
            part = self.path.segment_at(t)[0]
            if part.name in limits:
                a, b = self.path.grip(t), self.path.grip(t + 1e-3)
                speed = max(math.dist(a[:3], b[:3]), abs(a.half_gap - b.half_gap)) / 1e-3
                self.assertLessEqual(speed, limits[part.name], '%s at %g s' % (part.name, t))

    def test_the_swing_is_between_a_half_and_0_8_metres_a_second(self):
        fastest = max(math.dist(self.path.grip(t)[:3], self.path.grip(t + 1e-3)[:3]) / 1e-3 for t in self.times)
        self.assertTrue(0.5 <= fastest <= 0.8, fastest)

    def test_what_is_held_is_turned_over(self):
        held, laid = (self.robot.link_pose('left_tool', self.path.positions(self.path.moment(name)))
                      for name in ('hold', 'rest'))
        self.assertAlmostEqual(held[2][2], 1, places=9)
        self.assertAlmostEqual(laid[2][2], -1, places=9)
        self.assertGreater(laid[0][3] - held[0][3], 0.4)
        over = self.robot.link_pose('left_tool', self.path.positions(self.path.moment('swing')))
        self.assertGreater(over[0][2], 0.5)  # upper side towards +x on the way, not through the table

    def test_pads_keep_cloth_unsqueezed_and_grippers_do_not_stretch_it(self):
        thickness = self.scene['params']['thickness']
        width = self.scene['cloths'][0]['grid']['size'][1]
        for t in self.times:
            grip = self.path.grip(t)
            self.assertGreaterEqual(2 * grip.half_gap, 2 * thickness, 'at %g s' % t)
            if self.path.moment('hold', 0) <= t <= self.path.moment('open', 0):
                self.assertLessEqual(2 * grip.y, width - 2 * self.path.numbers['inset_y'] + 1e-9)

    def test_nothing_of_the_robot_comes_near_table_or_itself(self):
        with open(URDF) as file:
            links = collision_points(file.read(), os.path.join(os.path.dirname(URDF), 'meshes'))
        boxes = []
        for body in self.scene['bodies']:
            half = [s / 2 for s in body['box']['size']]
            boxes.append((body['name'], [c - h for c, h in zip(body['pose']['position'], half)],
                          [c + h for c, h in zip(body['pose']['position'], half)]))
        moving = [name for name in links if name not in ('base_link', 'left_column', 'right_column')]
        for t in self.times[::5]:
            joints = self.path.positions(t)
            bounds = {}
            for name in moving:
                if not links[name]:
                    continue
                place = self.robot.link_pose(name, joints)
                points = [[sum(place[r][k] * p[k] for k in range(3)) + place[r][3] for r in range(3)]
                          for p in links[name]]
                bounds[name] = ([min(p[k] for p in points) for k in range(3)],
                                [max(p[k] for p in points) for k in range(3)])
            for name, (low, high) in bounds.items():
                for box, box_low, box_high in boxes:
                    gap = max(max(bl - h, l - bh) for l, h, bl, bh in zip(low, high, box_low, box_high))
                    self.assertGreater(gap, 0.01, '%s is near %s at %g s' % (name, box, t))
                self.assertGreater(low[2], 0.05, '%s is near the base at %g s' % (name, t))
                if name.startswith('left'):
                    self.assertGreater(low[1], 0.1, '%s is near the right arm at %g s' % (name, t))

    def test_it_works_from_another_base(self):
        moved = fold_path.FoldPath(self.robot, self.path.task, arm.translation(0.02, 0.0, 0.03))
        t = self.path.moment('swing')
        a = self.robot.link_pose('left_tool', self.path.positions(t))
        b = self.robot.link_pose('left_tool', moved.positions(t))
        for p, q, offset in zip(a, b, (0.02, 0, 0.03)):
            self.assertAlmostEqual(p[3] - q[3], offset, places=9)

    def test_what_cannot_be_reached_is_refused_with_segment_and_time(self):
        with self.assertRaisesRegex(arm.OutOfReach, 'segment "approach"|t = '):
            fold_path.FoldPath(self.robot, self.path.task._replace(table_z=2.0))
        with self.assertRaisesRegex(ValueError, 'no number "hight"'):
            fold_path.FoldPath(self.robot, self.path.task, hight=1)

    def test_a_scene_that_cannot_be_folded_is_refused(self):
        for scene, text in (({}, 'no "cloths"'), ({'cloths': [{'name': 'towel'}], 'bodies': [{'name': 'table'}]}, 'grid')):
            with self.assertRaisesRegex(ValueError, text):
                fold_path.task_from_scene(scene)


if __name__ == '__main__':
    unittest.main(verbosity=2)
