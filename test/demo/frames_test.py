#!/usr/bin/python3
"""frames.test: what fold_motion.py publishes and what robot_state_publisher makes of it."""
import os
import sys
import threading
import time
import unittest

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.join(HERE, '../../src/demo'))
import arm  # noqa: E402

import rospy  # noqa: E402
import rostest  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_msgs.msg import Bool  # noqa: E402
from tf2_msgs.msg import TFMessage  # noqa: E402


def matrix(transform):
    q, p = transform.rotation, transform.translation
    x, y, z, w = q.x, q.y, q.z, q.w
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), p.x],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), p.y],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), p.z], [0, 0, 0, 1.0]]


class Frames(unittest.TestCase):
    """Listens to one whole fold; then looks at what came."""
    heard = None

    def setUp(self):
        if Frames.heard is None:
            Frames.heard = self.listen()
        self.joints, self.moving, self.fixed = Frames.heard
        self.robot = arm.Robot(rospy.get_param('/robot_description'))

    @staticmethod
    def listen():
        joints, moving, fixed = [], [], {}
        done = threading.Event()

        def on_fixed(message):
            for t in message.transforms:
                fixed[t.child_frame_id] = (t.header.frame_id, matrix(t.transform))
        rospy.Subscriber('joint_states', JointState, joints.append, queue_size=1000)
        rospy.Subscriber('/tf', TFMessage, moving.append, queue_size=1000)
        rospy.Subscriber('/tf_static', TFMessage, on_fixed, queue_size=10)
        rospy.Subscriber('fold_motion/done', Bool, lambda m: done.set() if m.data else None)
        deadline = time.monotonic() + 60
        while not done.is_set() and time.monotonic() < deadline:
            time.sleep(0.1)
        return list(joints), list(moving), fixed

    def test_the_fold_came_to_its_end_with_finite_joint_states_on_a_grid(self):
        self.assertGreater(len(self.joints), 600)  # 100 Hz over 8 s and more at double speed
        stamps = [m.header.stamp.to_sec() for m in self.joints]
        for a, b in zip(stamps, stamps[1:]):
            self.assertGreater(b, a)
            self.assertAlmostEqual(round(b / 0.01) * 0.01, b, places=5)
        for message in self.joints:
            self.assertEqual(len(message.name), len(message.position))
            self.assertEqual(len(message.name), len(message.velocity))
            self.assertNotIn('left_mimic_finger_joint', message.name)

    def test_robot_state_publisher_agrees_on_every_link(self):
        by_stamp = {m.header.stamp: dict(zip(m.name, m.position)) for m in self.joints}
        links = [joint.child for joint in self.robot.joints.values()]
        compared = 0
        for message in self.moving:
            positions = by_stamp.get(message.transforms[0].header.stamp)
            if positions is None:
                continue
            tree = dict(self.fixed)
            for t in message.transforms:
                tree[t.child_frame_id] = (t.header.frame_id, matrix(t.transform))
            for link in links:
                pose, frame = arm.IDENTITY, link
                while frame != 'base_link':
                    parent, t = tree[frame]
                    pose, frame = arm.product(t, pose), parent
                expected = self.robot.link_pose(link, positions)
                for row in range(3):
                    for column in range(4):  # 1e-6: quaternions in tf are normalised doubles
                        self.assertAlmostEqual(pose[row][column], expected[row][column], delta=1e-6, msg=link)
            compared += 1
        self.assertGreater(compared, 100)

    def test_the_robot_stands_where_the_parameter_says(self):
        parent, t = self.fixed['base_link']
        self.assertEqual(parent, 'world')
        for row, expected in zip(t, (0.02, 0.01, 0.03)):
            self.assertAlmostEqual(row[3], expected)


if __name__ == '__main__':
    rospy.init_node('frames_test')
    rostest.rosrun('robot_cloth', 'frames', Frames)
