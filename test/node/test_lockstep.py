#!/usr/bin/python3
"""lockstep.test: only ~step advances, and the same requests give the same state hash."""
import math
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import one_arm  # noqa: E402

import rospy  # noqa: E402
import rostest  # noqa: E402
from robot_cloth.srv import GetState, Grasp, LoadState, Release, SaveState, SetObstacle, SetState, Step  # noqa: E402
from geometry_msgs.msg import Pose, WrenchStamped  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_srvs.srv import SetBool, Trigger  # noqa: E402

WEIGHT = 0.3 * 0.3 * 0.3 * 9.81  # N: density [kg/m^2] * area * g


class Lockstep(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.step = staticmethod(one_arm.service('step', Step))
        cls.reset = staticmethod(one_arm.service('reset', Trigger))
        cls.get_state = staticmethod(one_arm.service('get_state', GetState))
        cls.states = one_arm.states()

    def fold(self, slide):
        """Hashes of a run that closes on the hanging cloth and pulls."""
        self.assertTrue(self.reset().success)
        hashes = []
        requests = (dict(steps=30, joints=one_arm.joint_state(), frames=[one_arm.base_frame()]),
                    dict(steps=20, joints=one_arm.joint_state(finger=0.004)),
                    dict(steps=40, joints=one_arm.joint_state(slide=slide, lift=0.2, finger=0.004)),
                    dict(steps=5))
        for request in requests:
            answer = self.step(**request)
            self.assertTrue(answer.success, answer.message)
            self.assertEqual(answer.steps_done, request['steps'])
            hashes.append(answer.state_hash)
        return hashes

    def test_same_requests_same_hash_twice(self):
        first = self.fold(0.2)
        held = sum(bytearray(self.get_state().held))
        self.assertGreater(held, 0, 'the gripper holds nothing: the hash would prove little')
        self.assertEqual(first, self.fold(0.2))
        other = self.fold(0.201)
        self.assertEqual(first[:2], other[:2])
        self.assertNotEqual(first[2], other[2], 'a hash that does not see the robot proves nothing')

    def test_only_step_advances(self):
        # more steps than any other test asks for after a reset: their states, which may still be on
        # their way on a busy machine, cannot be taken for the last of these
        answer = self.step(steps=120)
        self.assertIsNotNone(self.states.until(lambda m: m.step == answer.step), 'its state never came')
        rospy.sleep(0.5)
        self.assertEqual(self.states.messages[-1].step, answer.step)  # topics keep the order
        self.assertEqual(self.step(steps=0).step, answer.step)

    def test_a_step_tells_what_is_wrong(self):
        h = self.get_state().state_hash
        bad = JointState(name=['slide', 'lift'], position=[0])
        self.assertIn('2 names but 1', self.step(steps=1, joints=bad).message)
        self.assertIn('did you mean lift', self.step(steps=1, joints=JointState(name=['lfit'], position=[0])).message)
        self.assertIn('not finite', self.step(steps=1, joints=JointState(name=['lift'], position=[float('nan')])).message)
        frame = one_arm.base_frame()
        frame.transform.rotation.w = float('nan')
        self.assertIn('base', self.step(steps=1, frames=[frame]).message)
        self.assertEqual(self.get_state().state_hash, h, 'nothing changed')

    def test_robot_without_joint_states_is_not_in_the_scene(self):
        self.reset()
        answer = self.step(steps=1, joints=JointState(name=['slide'], position=[0]))
        self.assertTrue(answer.success)
        self.assertIn('no joint_states yet for finger lift', answer.message)

    def test_a_robot_that_is_placed_into_the_cloth_is_told_with_its_links(self):
        events = one_arm.events()
        self.reset()
        answer = self.step(steps=1, joints=one_arm.joint_state(finger=0.02), frames=[one_arm.base_frame(z=0.36)])
        self.assertTrue(answer.success, answer.message)
        event = events.until(lambda e: e.kind == 'teleport' and 'placed into the cloth' in e.text, 10)
        self.assertIsNotNone(event)
        self.assertRegex(event.text, r'triangles: inner_finger outer_finger;')

    def test_paused_refuses_and_goes_on(self):
        pause = one_arm.service('pause', SetBool)
        self.assertTrue(pause(True).success)
        self.assertIn('paused', self.step(steps=1).message)
        self.assertTrue(pause(False).success)
        self.assertTrue(self.step(steps=1).success)

    def test_saved_state_continues_with_the_same_hash(self):
        save, load = one_arm.service('save_state', SaveState), one_arm.service('load_state', LoadState)
        self.fold(0.1)
        self.assertTrue(save(name='mid.state').success)
        self.step(steps=2, joints=one_arm.joint_state(slide=0.1, lift=0.2, finger=0.004))
        wanted = self.step(steps=10).state_hash
        answer = load(name='mid.state')
        self.assertTrue(answer.success, answer.message)
        self.step(steps=2, joints=one_arm.joint_state(slide=0.1, lift=0.2, finger=0.004))
        self.assertEqual(self.step(steps=10).state_hash, wanted)
        for name in ('../mid.state', '/etc/passwd', '', '.hidden'):
            self.assertIn('file name', load(name=name).message)
        h = self.get_state().state_hash
        self.assertFalse(load(name='missing.state').success)
        with open(save(name='cut.state').path, 'r+b') as file:
            file.truncate(40)
        self.assertFalse(load(name='cut.state').success)
        self.assertEqual(self.get_state().state_hash, h, 'a refused state leaves the running one')

    def test_set_state_moves_vertices_and_refuses_nonsense(self):
        set_state = one_arm.service('set_state', SetState)
        self.reset()
        x = list(self.get_state().positions)
        x[2::3] = [z + 0.1 for z in x[2::3]]
        self.assertTrue(set_state(positions=x).success)
        # single precision holds 7 digits of a coordinate below 1 m
        self.assertLess(max(abs(a - b) for a, b in zip(self.get_state().positions, x)), 1e-6)
        self.assertIn('3 x 256', set_state(positions=x[:-1]).message)
        x[0] = float('inf')
        self.assertFalse(set_state(positions=x).success)

    def test_obstacle_moves(self):
        obstacle = one_arm.service('set_obstacle', SetObstacle)
        pose = Pose()
        pose.position.x, pose.position.z = 2.0, 0.385
        self.assertIn('table', obstacle(body='tabel', pose=pose).message)
        self.assertIn('link', obstacle(body='palm', pose=pose).message)
        self.reset()
        self.assertTrue(obstacle(body='table', pose=pose, place=True).success)
        self.step(steps=60)
        lowest = min(self.get_state().positions[2::3])
        self.assertLess(lowest, 0.0, 'without its table the towel falls')
        self.reset()

    def test_reload_starts_anew(self):
        self.fold(0.2)
        answer = one_arm.service('reload_model', Trigger)()
        self.assertTrue(answer.success, answer.message)
        again = self.step(steps=30, joints=one_arm.joint_state(), frames=[one_arm.base_frame()])
        self.assertEqual(again.state_hash, self.fold(0.2)[0])

    def test_grasp_in_a_frame_that_the_request_brings(self):
        self.reset()
        hook = one_arm.base_frame(0, 0, 0.5)
        hook.child_frame_id = 'hook'
        self.step(steps=1, frames=[hook])
        grasp = one_arm.service('grasp', Grasp)(id='hook', frame_id='hook', how='nearest')
        self.assertTrue(grasp.success, grasp.message)
        v = grasp.vertices[0]
        before = self.get_state().positions[3 * v:3 * v + 3]
        hook.transform.translation.z = 0.52
        self.step(steps=1, frames=[hook])
        after = self.get_state().positions[3 * v:3 * v + 3]
        self.assertAlmostEqual(after[2] - before[2], 0.02, delta=1e-6)  # rigid, in single precision
        self.reset()

    def test_wrench_of_a_hanging_towel_is_its_weight_in_the_frame_of_the_grasp(self):
        self.reset()
        away = Pose()
        away.position.x, away.position.z = 2.0, 0.385
        self.assertTrue(one_arm.service('set_obstacle', SetObstacle)(body='table', pose=away, place=True).success)
        hook = one_arm.base_frame(0, 0, 0.5)
        hook.child_frame_id = 'hook'
        hook.transform.rotation.x, hook.transform.rotation.w = math.sqrt(0.5), math.sqrt(0.5)  # its y is up
        self.step(steps=1, frames=[hook])
        self.assertTrue(one_arm.service('grasp', Grasp)(id='hook', frame_id='hook', how='radius', radius=0.2, limit=4).success)
        wrench = one_arm.Listener('cloth/grasps/hook/wrench', WrenchStamped)
        rospy.sleep(0.5)  # until the node knows the subscriber
        self.step(steps=300)
        for _ in range(300):  # one at a time: many steps at once are faster than messages
            end = self.step(steps=1).time
        self.assertIsNotNone(wrench.until(lambda m: m.header.stamp.to_sec() > end - 1e-3), 'the last never came')
        last = wrench.messages[-240:]
        self.assertEqual(len(last), 240)
        force = [sum(getattr(m.wrench.force, a) for m in last) / len(last) for a in 'xyz']
        # a mean over 4 s: swinging at 0.3 m/s moves it by m v / t, 3 % of the weight
        for mean, wanted in zip(force, (0, WEIGHT, 0)):
            self.assertAlmostEqual(mean, wanted, delta=0.05 * WEIGHT)
        self.assertEqual(last[-1].header.frame_id, 'hook')
        before = self.get_state().positions
        self.assertTrue(one_arm.service('release', Release)(frame_id='hook').success)
        self.step(steps=30)
        fallen = [a - b for a, b in zip(before[2::3], self.get_state().positions[2::3])]
        self.assertGreater(min(fallen), 0.5, 'what is released falls: g t^2 / 2 = 1.2 m, less what swung upwards')
        self.reset()


if __name__ == '__main__':
    rospy.init_node('test_lockstep')
    rostest.rosrun('robot_cloth', 'lockstep', Lockstep)
