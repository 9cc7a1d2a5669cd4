#!/usr/bin/python3
"""nodelet.test: two cloth nodes in namespaces, one of them a nodelet, do not disturb each other."""
import unittest

import rospy
import rostest
from robot_cloth.msg import State
from std_srvs.srv import Trigger


class Nodelet(unittest.TestCase):
    def test_both_run(self):
        for name in ('/a/cloth', '/b/cloth'):
            first = rospy.wait_for_message(name + '/state', State, 20)
            self.assertGreater(rospy.wait_for_message(name + '/state', State, 20).step, first.step)

    def test_a_reset_of_one_leaves_the_other(self):
        rospy.wait_for_service('/a/cloth/reset', 20)
        before = rospy.wait_for_message('/b/cloth/state', State, 20)
        self.assertTrue(rospy.ServiceProxy('/a/cloth/reset', Trigger)().success)
        self.assertEqual(rospy.wait_for_message('/a/cloth/state', State, 20).epoch, 1)
        after = rospy.wait_for_message('/b/cloth/state', State, 20)
        self.assertEqual(after.epoch, before.epoch)
        self.assertGreater(after.step, before.step)


if __name__ == '__main__':
    rospy.init_node('test_nodelet')
    rostest.rosrun('robot_cloth', 'nodelet', Nodelet)
