#!/usr/bin/python3
"""time.test: a simulated clock that runs, stops, jumps; after each reset the topics go on."""
import os
import sys
import threading
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import one_arm  # noqa: E402

import rospy  # noqa: E402
import rostest  # noqa: E402
from diagnostic_msgs.msg import DiagnosticArray  # noqa: E402
from robot_cloth.srv import Step  # noqa: E402
from rosgraph_msgs.msg import Clock  # noqa: E402
from sensor_msgs.msg import PointCloud2  # noqa: E402
from std_srvs.srv import SetBool, Trigger  # noqa: E402


class SimulatedClock(threading.Thread):
    """/clock at 100 Hz of wall time."""

    def __init__(self):
        super().__init__(daemon=True)
        self.publisher = rospy.Publisher('/clock', Clock, queue_size=10)
        self.now, self.rate = 100.0, 1.0
        self.start()

    def run(self):
        while not rospy.is_shutdown():
            self.publisher.publish(Clock(clock=rospy.Time.from_sec(self.now)))
            time.sleep(0.01)
            self.now += 0.01 * self.rate


class Time(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.states, cls.events = one_arm.states(), one_arm.events()
        cls.vertices = one_arm.Listener('cloth/towel/vertices', PointCloud2)
        cls.diagnostics = one_arm.Listener('/diagnostics', DiagnosticArray)
        cls.clock = None

    def last(self):
        return self.states.messages[-1]

    def goes_on(self, epoch):
        """Topics come after the change that began this epoch, and time grows."""
        first = self.states.until(lambda m: m.epoch == epoch and m.step >= 1)
        self.assertIsNotNone(first, 'no state in epoch %d' % epoch)
        seen = self.vertices.count()
        self.assertIsNotNone(self.states.until(lambda m: m.epoch == epoch and m.time > first.time + 0.2))
        self.assertIsNotNone(self.vertices.until(lambda m: True, start=seen), 'vertices stopped')

    def stamps_grow(self):
        """Within an epoch: no message of a new one is stamped with the clock of the old one."""
        for a, b in zip(self.states.messages, self.states.messages[1:]):
            if a.epoch == b.epoch:
                self.assertLessEqual(a.header.stamp.to_sec(), b.header.stamp.to_sec() + 1e-6, b)

    def test_1_without_a_clock_it_waits_and_says_so(self):
        found = self.diagnostics.until(lambda m: any('waiting for /clock' in s.message for s in m.status))
        self.assertIsNotNone(found)
        self.assertFalse([m for m in self.states.messages if m.step > 0])
        self.assertTrue(one_arm.service('pause', SetBool)(False).success, 'services answer all the same')

    def test_2_the_clock_drives_it(self):
        type(self).clock = SimulatedClock()
        self.goes_on(0)
        self.assertAlmostEqual(self.last().header.stamp.to_sec(), self.clock.now, delta=1.0)

    def test_3_a_stopped_clock_stops_the_cloth(self):
        self.clock.rate = 0.0
        time.sleep(0.5)
        before = self.last().step
        time.sleep(0.5)
        self.assertEqual(self.last().step, before)
        self.clock.rate = 1.0
        self.goes_on(0)

    def test_4_pause_and_go_on_without_catching_up(self):
        pause = one_arm.service('pause', SetBool)
        self.assertTrue(pause(True).success)
        self.assertIsNotNone(self.states.until(lambda m: m.paused))
        t = self.last().time
        time.sleep(1.0)
        self.assertTrue(pause(False).success)
        after = self.states.until(lambda m: m.time > t and not m.paused)
        self.assertLess(after.time, t + 0.1)
        self.assertEqual(self.last().time_skipped, 0)

    def test_5_topics_go_on_after_each_reset(self):
        reset = one_arm.service('reset', Trigger)
        for _ in range(3):
            epoch = self.last().epoch
            answer = reset()
            self.assertTrue(answer.success, answer.message)
            again = self.states.until(lambda m: m.epoch == epoch + 1 and m.step >= 1)
            self.assertIsNotNone(again)
            self.assertLess(again.time, 0.5)
            self.goes_on(epoch + 1)

    def test_6_a_backward_jump_resets(self):
        epoch = self.last().epoch
        self.clock.now = 50.0
        self.assertIsNotNone(self.events.until(lambda e: e.kind == 'time_jump', start=0))
        self.goes_on(epoch + 1)
        self.assertLess(self.last().header.stamp.to_sec(), 90)
        self.stamps_grow()

    def test_7_microseconds_backward_are_no_jump(self):
        epoch = self.last().epoch
        for _ in range(20):
            self.clock.now -= 0.0101 if self.clock.rate == 0 else 0.002
            time.sleep(0.02)
        self.goes_on(epoch)
        self.assertEqual(self.last().epoch, epoch)

    def test_8_a_forward_jump_does_not_pile_up(self):
        t, count = self.last().time, self.events.count()
        self.clock.now += 1000
        self.assertIsNotNone(self.events.until(lambda e: e.kind == 'time_jump' and 'ahead' in e.text, start=count))
        self.goes_on(self.last().epoch)
        self.assertLess(self.last().time, t + 20)
        self.assertIsNotNone(self.states.until(lambda m: m.header.stamp.to_sec() > 1000))
        self.stamps_grow()

    def test_9_step_is_refused_with_the_reason(self):
        answer = one_arm.service('step', Step)(steps=1)
        self.assertFalse(answer.success)
        self.assertIn('time/mode is clock', answer.message)


if __name__ == '__main__':
    rospy.init_node('test_time', disable_rostime=True)
    rostest.rosrun('robot_cloth', 'time', Time)
