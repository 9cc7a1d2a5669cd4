#!/usr/bin/python3
"""The demo's kinematics: src/demo/arm.py against its URDF."""
import math
import os
import random
import sys
import unittest

HERE = os.path.dirname(os.path.realpath(__file__))
SOURCE = os.environ.get('ROBOT_CLOTH_SOURCE', os.path.join(HERE, '../..'))
sys.path.insert(0, os.path.join(SOURCE, 'src/demo'))
import arm  # noqa: E402

URDF = os.path.join(SOURCE, 'config/robots/two_arm/two_arm.urdf')


def urdf():
    with open(URDF) as file:
        return file.read()


class ArmTest(unittest.TestCase):
    def setUp(self):
        self.robot = arm.Robot(urdf())

    def test_all_zero_stretches_the_arms_towards_each_other(self):
        # by hand from the URDF: column 0.92, shoulder 0.14, links 0.28 and 0.26, wrist 0.06, tool 0.111
        for side, sign in (('left', 1), ('right', -1)):
            t = self.robot.link_pose(side + '_tool', {})
            for value, expected in zip((row[3] for row in t), (0, sign * (0.92 - 0.14 - 0.54 - 0.171), 0.208)):
                self.assertAlmostEqual(value, expected, places=9)
            self.assertAlmostEqual(t[1][0], -sign, places=9)  # points inwards

    def test_inverse_kinematics_is_the_inverse_of_forward_kinematics(self):
        random.seed(7)
        reached = 0
        for side, sign in (('left', 1), ('right', -1)):
            for bend in (1, -1):
                one = arm.Arm(self.robot, side, bend)
                for _ in range(300):
                    target = (random.uniform(-0.4, 0.4), sign * random.uniform(0.1, 0.5), random.uniform(0.25, 0.8))
                    roll, gap = random.uniform(-3.3, 3.3), random.uniform(0, 0.045)
                    try:
                        joints = one.solve(target, roll, gap)
                    except arm.OutOfReach:
                        continue
                    reached += 1
                    t = self.robot.link_pose(side + '_tool', joints)
                    for i in range(3):
                        self.assertAlmostEqual(t[i][3], target[i], places=9)
                    self.assertAlmostEqual(t[1][0], -sign, places=9)
                    self.assertAlmostEqual(t[2][2], math.cos(roll), places=9)
                    self.assertGreaterEqual(bend * joints[side + '_elbow_joint'], 0)
        self.assertGreater(reached, 600)

    def test_a_mimic_finger_follows_its_finger(self):
        for gap in (0.0, 0.02, 0.045):
            q = {'left_finger_joint': gap}
            upper, lower = (self.robot.link_pose('left_' + n, q)[2][3] for n in ('finger', 'mimic_finger'))
            self.assertAlmostEqual(upper - lower, 2 * gap, places=12)

    def test_a_target_out_of_reach_is_refused_by_name(self):
        one = arm.Arm(self.robot, 'left', 1)
        with self.assertRaisesRegex(arm.OutOfReach, 'left arm.*reach is'):
            one.solve((2, 0.2, 0.4), 0, 0)
        with self.assertRaisesRegex(arm.OutOfReach, 'left_lift_joint'):
            one.solve((0, 0.2, 2), 0, 0)
        with self.assertRaisesRegex(arm.OutOfReach, 'left_finger_joint'):
            one.solve((0, 0.2, 0.4), 0, 0.1)

    def test_another_kind_of_robot_is_refused_by_the_joint_that_does_not_fit(self):
        with self.assertRaisesRegex(arm.BadRobot, 'left_elbow_joint'):
            arm.Arm(arm.Robot(urdf().replace('left_elbow_joint', 'left_bend_joint')), 'left', 1)
        with self.assertRaisesRegex(arm.BadRobot, '2 root links'):
            arm.Robot(urdf().replace('</robot>', '<link name="lost"/></robot>'))
        with self.assertRaisesRegex(arm.BadRobot, 'not a usable URDF'):
            arm.Robot('<robot><joint')

    def test_quaternion_turns_like_its_matrix(self):
        random.seed(3)
        for _ in range(200):
            axis = [random.gauss(0, 1) for _ in range(3)]
            size = math.sqrt(sum(a * a for a in axis))
            axis = [a / size for a in axis]
            angle = random.uniform(-math.pi, math.pi)
            x, y, z, w = arm.quaternion(arm.rotation(axis, angle))
            # the same rotation by its definition; q and -q are one
            expected = [a * math.sin(angle / 2) for a in axis] + [math.cos(angle / 2)]
            sign = 1 if sum(p * q for p, q in zip((x, y, z, w), expected)) > 0 else -1
            for p, q in zip((x, y, z, w), expected):
                self.assertAlmostEqual(p, sign * q, places=7)


if __name__ == '__main__':
    unittest.main(verbosity=2)
