#!/usr/bin/python3
"""inputs.test: joint states and frames as bad drivers send them; the cloth goes on and /diagnostics says what was wrong."""
import os
import sys
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import one_arm  # noqa: E402

import rospy  # noqa: E402
import rostest  # noqa: E402
import tf2_msgs.msg  # noqa: E402
from diagnostic_msgs.msg import DiagnosticArray  # noqa: E402
from robot_cloth.msg import GraspCommand  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402


class Inputs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.states, cls.events = one_arm.states(), one_arm.events()
        cls.diagnostics = one_arm.Listener('/diagnostics', DiagnosticArray)
        cls.joints = rospy.Publisher('joint_states', JointState, queue_size=100)
        cls.tf = rospy.Publisher('/tf_static', tf2_msgs.msg.TFMessage, queue_size=1, latch=True)
        end = time.monotonic() + 20
        while cls.joints.get_num_connections() == 0 and time.monotonic() < end:
            time.sleep(0.05)

    def robot(self, fits):
        """The robot's entry of /diagnostics, as (message, {key: value}), once it fits; else None."""
        def entries(m):
            return [(s.message, {v.key: v.value for v in s.values}) for s in m.status if s.name.endswith(': robot')]
        found = self.diagnostics.until(lambda m: any(fits(*e) for e in entries(m)), 10, max(0, self.diagnostics.count() - 1))
        return found and entries(found)[0]

    def send(self, names, positions, stamp=None):
        m = JointState(name=names, position=positions)
        m.header.stamp = rospy.Time.now() if stamp is None else stamp
        self.joints.publish(m)

    def hold(self, seconds, **joints):
        m = one_arm.joint_state(**joints)
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.send(m.name, m.position)
            time.sleep(0.01)

    def goes_on(self):
        step = self.states.messages[-1].step
        self.assertIsNotNone(self.states.until(lambda m: m.step > step + 10), 'the simulation stands still')

    def test_1_missing_joints_are_named(self):
        self.send(['slide'], [0.0])
        self.assertIsNotNone(self.robot(lambda text, v: 'no joint_states yet for finger lift' in text))
        self.goes_on()

    def test_2_missing_transform_is_named(self):
        self.send(['lift', 'finger'], [0.0, 0.05])
        self.assertIsNotNone(self.robot(lambda text, v: 'no transform from world to base' in text))
        self.goes_on()

    def test_3_partial_messages_make_a_whole_robot(self):
        self.tf.publish([one_arm.base_frame()])
        found = self.robot(lambda text, v: 'not in the scene' not in text)
        self.assertIsNotNone(found)

    def test_4_nonsense_is_counted_and_left_out(self):
        now = rospy.Time.now()
        self.send(['slide', 'lift'], [0.0])
        self.send(['slide'], [float('nan')])
        self.send(['lift'], [float('inf')])
        self.send(['wheel'], [1.0])
        self.send(['slide'], [0.0], rospy.Time())
        self.send(['slide'], [0.0], now + rospy.Duration(1000))
        self.send(['slide'], [0.0], now - rospy.Duration(1000))
        self.send([], [])
        self.assertIsNotNone(self.robot(lambda text, v: 'last: stamp is 999.' in text and 'at most 0.5' in text))
        found = self.robot(lambda text, v: int(v['stamp old']) >= 1)
        self.assertIsNotNone(found)
        for key, count in (('unequal lengths', 1), ('not finite', 2), ('unknown joints', 1), ('stamp zero', 1),
                           ('stamp in the future', 1), ('stamp old', 1)):
            self.assertEqual(int(found[1][key]), count, key)
        self.assertIn('refused', found[0])
        self.goes_on()

    def test_5_a_leap_of_the_robot_is_a_teleport(self):
        self.hold(0.5)
        self.hold(0.5, slide=0.9)
        event = self.events.until(lambda e: e.kind == 'teleport', 10)
        self.assertIsNotNone(event)
        self.assertIn('speed_limit', event.text)
        self.goes_on()

    def test_6_a_driver_that_stops_leaves_the_robot_where_it_is(self):
        held = self.robot(lambda text, v: True)
        self.assertIsNotNone(held)
        time.sleep(1.0)
        later = self.robot(lambda text, v: int(v['steps with held joints']) > int(held[1]['steps with held joints']))
        self.assertIsNotNone(later)
        self.assertIsNotNone(self.robot(lambda text, v: 'no joint_states for finger lift slide' in text))
        self.goes_on()

    def test_7_frames_that_are_nonsense(self):
        bad = one_arm.base_frame(float('nan'))
        bad.child_frame_id = 'bad'
        ring = one_arm.base_frame()
        ring.header.frame_id = ring.child_frame_id = 'ring'
        self.tf.publish([bad, ring])
        commands = rospy.Publisher('cloth/grasp_command', GraspCommand, queue_size=10)
        while commands.get_num_connections() == 0:
            time.sleep(0.05)
        for frame in ('bad', 'ring', '/world/', ''):
            commands.publish(GraspCommand(id='x' + frame, frame_id=frame, how='nearest', region_frame='bad'))
        commands.publish(GraspCommand(command=77, id='what'))
        self.assertIsNotNone(self.events.until(lambda e: e.subject == 'what' and e.kind == 'grasp_failed'))
        failed = [e for e in self.events.messages if e.kind == 'grasp_failed']
        self.assertEqual(len(failed), 5)
        self.assertIn('no transform from world to bad', failed[0].text)
        self.goes_on()

    def test_8_one_value_out_of_all_reach_stops_nothing(self):
        self.hold(0.5, slide=0.9)
        for nonsense in 1e30, -1e308:
            self.hold(0.05, slide=nonsense)
            self.hold(0.5, slide=0.9)
        self.goes_on()
        self.assertFalse([e for e in self.events.messages if e.kind in ('rollback', 'pause')])

    def test_9_a_thousand_messages_at_once(self):
        for i in range(1000):
            self.send(['slide'], [0.9])
            if i % 100 == 0:
                time.sleep(0.01)
        self.goes_on()


if __name__ == '__main__':
    rospy.init_node('test_inputs')
    rostest.rosrun('robot_cloth', 'inputs', Inputs)
