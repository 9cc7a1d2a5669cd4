#!/usr/bin/python3
"""nodelet.test: two cloth nodes in namespaces, one of them a nodelet, do not disturb each other."""
import subprocess
import unittest

import roslib.packages
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

    def test_a_nodelet_that_cannot_start_says_why(self):
        program = roslib.packages.find_node('nodelet', 'nodelet')[0]
        run = subprocess.run([program, 'standalone', 'robot_cloth/ClothNodelet', '__name:=bare'], stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, universal_newlines=True, timeout=30)
        self.assertNotEqual(run.returncode, 0)
        self.assertIn('parameter /bare/scene is not set', run.stdout)


if __name__ == '__main__':
    rospy.init_node('test_nodelet')
    rostest.rosrun('robot_cloth', 'nodelet', Nodelet)
