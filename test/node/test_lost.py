#!/usr/bin/python3
"""lost.test: a GPU that is lost in mid-run does not end the node (lose_device.c takes it away)."""
import os
import signal
import subprocess
import tempfile
import unittest

import roslib.packages
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from robot_cloth.msg import Event
from robot_cloth.srv import GetInfo, Grasp, LoadState, Step
from std_srvs.srv import Trigger

HERE = os.path.dirname(os.path.realpath(__file__))
SCENE = os.path.join(HERE, 'data/small_towel.yaml')
AT, STEPS = 12, 20  # the step in which the device goes, and of the whole run


class Node:
    """A node of its own, in lockstep, that steps one by one."""

    def __init__(self, name, **how):
        self.name, self.folder = name, tempfile.TemporaryDirectory()
        params = dict(scene=SCENE, use_robot=False, time=dict(mode='step'), state_folder=self.folder.name)
        params.update(how.pop('params', {}))
        rospy.set_param(name, params)
        self.events, self.engine = [], None
        self.listeners = [rospy.Subscriber(name + '/events', Event, self.events.append),
                          rospy.Subscriber('/diagnostics', DiagnosticArray, self.diagnosed)]
        env = dict(os.environ, ROSCONSOLE_FORMAT='|${message}|')
        if how:
            env.update(LD_PRELOAD=os.environ['CLOTH_LOSE_DEVICE'], **{k.upper(): str(v) for k, v in how.items()})
        node = roslib.packages.find_node('robot_cloth', 'cloth_node')[0]
        self.process = subprocess.Popen([node, '__name:=' + name[1:]], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        universal_newlines=True, env=env)
        self.step = self.service('step', Step)

    def service(self, name, kind):
        rospy.wait_for_service(self.name + '/' + name, 20)
        return rospy.ServiceProxy(self.name + '/' + name, kind)

    def diagnosed(self, message):
        for status in message.status:
            if status.name == self.name + ': engine':
                self.engine = status

    def diagnosis(self, level):
        """The engine's entry of /diagnostics, as soon as it is of this level."""
        for _ in range(100):
            if self.engine is not None and self.engine.level == level:
                break
            rospy.sleep(0.05)
        return self.engine

    def hold(self):
        answer = self.service('grasp', Grasp)(cloth='towel', how='ids', ids=[0, 1, 2])
        assert answer.success, answer.message

    def hashes(self, steps):
        return [self.step(steps=1).state_hash for _ in range(steps)]

    def end(self):
        self.process.send_signal(signal.SIGINT)
        out, _ = self.process.communicate(timeout=20)
        for listener in self.listeners:
            listener.unregister()
        self.folder.cleanup()
        return out


class Lost(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        node = Node('/sound')
        node.hold()
        cls.sound = node.hashes(STEPS)  # what would have been
        node.end()

    def test_the_cpu_goes_on_from_the_last_state(self):
        node = Node('/saved', lose_at=AT, lose_steps_only=1)
        node.hold()
        self.assertEqual(node.hashes(AT - 1), self.sound[:AT - 1])
        answer = node.step(steps=1)
        self.assertFalse(answer.success)
        for text in ('the device fell off', 'the CPU goes on from its last state'):
            self.assertIn(text, answer.message)
        self.assertEqual(answer.state_hash, self.sound[AT - 2])
        self.assertEqual(node.hashes(STEPS - AT + 1), self.sound[AT - 1:])
        engine = node.diagnosis(DiagnosticStatus.WARN)
        self.assertEqual(engine.level, DiagnosticStatus.WARN)
        self.assertIn('the CPU goes on', engine.message)
        self.assertEqual([e.kind for e in node.events if e.kind == 'fallback'], ['fallback'])
        self.assertIn('the CPU goes on', node.end())

    def test_what_no_device_knows_is_gone_on_with_from_what_was_kept(self):
        node = Node('/kept', lose_at=AT, params=dict(keep_every=0.001))
        node.hold()
        node.hashes(AT - 1)
        answer = node.step(steps=1)
        self.assertIn('the CPU goes on from its kept state', answer.message)
        self.assertIn(answer.state_hash, self.sound[:AT - 1])
        at = self.sound.index(answer.state_hash) + 1
        self.assertAlmostEqual(answer.time, at / 60)
        self.assertEqual(node.hashes(STEPS - at), self.sound[at:])
        node.end()

    def test_where_nothing_was_kept_it_begins_anew(self):
        node = Node('/blank', lose_at=AT, params=dict(keep_every=0.0))
        node.hold()
        node.hashes(AT - 1)
        answer = node.step(steps=1)
        self.assertIn('from the start: no state was left', answer.message)
        self.assertEqual(answer.time, 0)
        self.assertTrue(node.step(steps=3).success)
        node.end()

    def test_a_gpu_that_was_asked_for_is_not_replaced_but_the_node_lives(self):
        node = Node('/asked', lose_at=AT, lose_steps_only=1, lose_asked=1)
        node.hold()
        node.hashes(AT - 1)
        answer = node.step(steps=1)
        self.assertFalse(answer.success)
        for text in ('the device fell off', 'its last state is in ' + node.folder.name):
            self.assertIn(text, answer.message)
        again = node.step(steps=1)
        self.assertFalse(again.success)
        self.assertIn('~reload_model starts anew', again.message)
        self.assertEqual(node.diagnosis(DiagnosticStatus.ERROR).level, DiagnosticStatus.ERROR)
        self.assertIn('the scene is lost', node.engine.message)
        self.assertIsNone(node.process.poll())
        self.assertEqual(list(node.service('get_info', GetInfo)().cloths), ['towel'])
        answer = node.service('reload_model', Trigger)()
        self.assertTrue(answer.success, answer.message)
        answer = node.service('load_state', LoadState)(name='last_good_asked')
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(node.hashes(STEPS - AT + 1), self.sound[AT - 1:])
        node.end()

    def test_a_run_that_cannot_reach_its_end_ends_with_an_error(self):
        node = Node('/ending', lose_at=AT, lose_asked=1, params=dict(time=dict(mode='wall'), run_duration=5.0))
        out, _ = node.process.communicate(timeout=30)
        self.assertEqual(node.process.returncode, 1, out)
        self.assertIn('the scene is lost: the device fell off', out)


if __name__ == '__main__':
    rospy.init_node('test_lost')
    rostest.rosrun('robot_cloth', 'lost', Lost)
