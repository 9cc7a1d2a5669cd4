#!/usr/bin/python3
"""towel.test: a robot grasps a towel, lifts it and lets go, as topics and services tell it."""
import math
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import one_arm  # noqa: E402

import rospy  # noqa: E402
import rostest  # noqa: E402
import tf2_msgs.msg  # noqa: E402
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus  # noqa: E402
from geometry_msgs.msg import WrenchStamped  # noqa: E402
from robot_cloth.msg import ClothMesh, CrossCheck, GraspCommand, Grasps, Topology  # noqa: E402
from robot_cloth.srv import GetInfo, GetState, Grasp, Release, RunCrossCheck  # noqa: E402
from sensor_msgs.msg import PointCloud2  # noqa: E402
from visualization_msgs.msg import Marker, MarkerArray  # noqa: E402

WEIGHT = 0.3 * 0.3 * 0.3 * 9.81  # N: density [kg/m^2] * area * g


class Towel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.tf = rospy.Publisher('/tf_static', tf2_msgs.msg.TFMessage, queue_size=1, latch=True)
        cls.tf.publish([one_arm.base_frame()])
        cls.events, cls.states = one_arm.events(), one_arm.states()
        cls.grasps = one_arm.Listener('cloth/grasps', Grasps)
        cls.vertices = one_arm.Listener('cloth/towel/vertices', PointCloud2)
        cls.get_state = staticmethod(one_arm.service('get_state', GetState))
        cls.driver = one_arm.Driver()

    def positions(self):
        answer = self.get_state()
        self.assertTrue(answer.success, answer.message)
        x = answer.positions
        return [x[i:i + 3] for i in range(0, len(x), 3)]

    def settle(self, seconds):
        now = self.states.messages[-1].time
        self.assertIsNotNone(self.states.until(lambda m: m.time >= now + seconds, 30))

    def test_1_waits_for_the_robot_then_runs(self):
        self.assertIsNotNone(self.states.until(lambda m: m.time > 1.0, 30), 'no state')
        topology = rospy.wait_for_message('cloth/towel/topology', Topology, 5)
        self.assertEqual(topology.vertex_count, 256)
        cloud = self.vertices.messages[-1]
        self.assertEqual((cloud.width, [f.name for f in cloud.fields]), (256, ['x', 'y', 'z']))
        info = one_arm.service('get_info', GetInfo)()
        self.assertEqual(sorted(info.links), ['inner_finger', 'outer_finger', 'palm'])

    def test_2_shows_what_it_simulates(self):
        bodies = {m.ns: m for m in rospy.wait_for_message('cloth/collision_markers', MarkerArray, 5).markers}
        self.assertEqual(sorted(bodies), ['body/inner_finger', 'body/outer_finger', 'body/palm', 'body/table'])
        palm, table = bodies['body/palm'], bodies['body/table']
        self.assertEqual((palm.header.frame_id, palm.frame_locked, palm.type), ('palm', True, Marker.TRIANGLE_LIST))
        self.assertEqual((table.header.frame_id, table.frame_locked, table.pose.position.z), ('world', False, 0.385))
        self.assertEqual(max(abs(p.x) for p in palm.points), 0.07)  # half the box
        markers = {m.ns: m for m in rospy.wait_for_message('cloth/markers', MarkerArray, 5).markers}
        cloth = markers['cloth/towel']
        self.assertEqual(len(cloth.points), len(cloth.colors))
        self.assertEqual(len(cloth.points), 2 * 3 * 2 * 15 * 15)  # both sides
        mesh = rospy.wait_for_message('cloth/towel/mesh', ClothMesh, 5).mesh
        self.assertEqual((len(mesh.vertices), len(mesh.triangles)), (256, 2 * 15 * 15))

    def test_3_says_why_a_grasp_failed(self):
        grasp = one_arm.service('grasp', Grasp)
        request = dict(frame_id='tool', how='radius', radius=0.01)
        far = grasp(region_frame='world', region=one_arm_pose(0, 0, 1.0), **request)
        self.assertFalse(far.success)
        self.assertRegex(far.message, r'nearest free vertex is 0\.\d+ m')
        for wrong, text in ((dict(frame_id='nowhere', how='ids', ids=[1]), 'nowhere'),
                            (dict(how='box'), 'size'), (dict(how='group', group='hem'), "no group 'hem'"),
                            (dict(how='squeeze'), 'nearest, radius, box, ids or group'),
                            (dict(how='ids', ids=[100000]), '100000'),
                            (dict(how='nearest', cloth='towle'), 'towel')):
            answer = grasp(**wrong)
            self.assertFalse(answer.success)
            self.assertIn(text, answer.message)
        again = one_arm.service('release', Release)(id='never')
        self.assertTrue(again.success, 'release is idempotent')
        self.assertIn('never', again.message)

    def test_4_closing_grasps_lifting_carries_opening_releases(self):
        self.driver.go(0.5, finger=0.004)
        event = self.events.until(lambda e: e.kind in ('grasp', 'grasp_failed') and e.subject == 'gripper', 10)
        self.assertIsNotNone(event, 'the closing gripper did nothing')
        self.assertEqual(event.kind, 'grasp', event.text)
        held = self.grasps.until(lambda m: len(m.grasps) == 1)
        self.assertIsNotNone(held)
        ids = list(held.grasps[0].vertices)
        self.assertEqual((held.grasps[0].frame_id, held.grasps[0].gripper), ('tool', 'gripper'))
        before = self.positions()
        self.driver.go(1.5, slide=0.25, lift=0.35)
        self.settle(1.5)
        after = self.positions()
        for v in ids:  # rigid: exactly the motion of the frame
            for axis, move in ((0, 0.25), (1, 0.0), (2, 0.35)):
                self.assertAlmostEqual(after[v][axis] - before[v][axis], move, delta=1e-4)
        # palm and fingers carry a part of the towel, the grasp the rest (test_lockstep.py has the sharp test)
        wrench = one_arm.Listener('cloth/grasps/gripper/wrench', WrenchStamped)
        self.assertIsNotNone(wrench.until(lambda m: True, 10))
        self.settle(2.0)
        forces = [m.wrench.force.z for m in wrench.messages[-60:]]
        self.assertEqual(wrench.messages[-1].header.frame_id, 'tool')
        self.assertTrue(0.1 * WEIGHT < sum(forces) / len(forces) < 1.5 * WEIGHT, forces)  # it still swings
        self.assertGreater(min(p[2] for p in after), 0.2)
        before = self.positions()
        self.driver.go(0.3, finger=0.05)
        self.assertIsNotNone(self.events.until(lambda e: e.kind == 'release' and e.subject == 'gripper', 10))
        self.assertIsNotNone(self.grasps.until(lambda m: not m.grasps, start=self.grasps.count() - 1))
        self.assertEqual(sum(bytearray(self.get_state().held)), 0)
        self.settle(0.5)
        after = self.positions()
        # it may stay hung over the fingers, but it is no longer tied to them
        self.assertGreater(max(math.dist(before[v], after[v]) for v in ids), 2e-3)

    def test_5_a_command_topic_grasps_too(self):
        publisher = rospy.Publisher('cloth/grasp_command', GraspCommand, queue_size=1, latch=True)
        publisher.publish(GraspCommand(id='pin', how='ids', ids=[0, 1]))
        self.assertIsNotNone(self.grasps.until(lambda m: [g.id for g in m.grasps] == ['pin'], 10))
        before = self.positions()[0]
        self.settle(0.3)
        self.assertEqual(self.positions()[0], before, 'held in the world frame')
        publisher.publish(GraspCommand(command=GraspCommand.RELEASE, id='pin'))
        self.assertIsNotNone(self.events.until(lambda e: e.kind == 'release' and e.subject == 'pin', 10))

    def test_6_fcl_finds_no_missed_pair(self):
        answer = one_arm.service('crosscheck', RunCrossCheck)(margin=0.01)
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(answer.result.missed, 0)
        checks = one_arm.Listener('cloth/crosscheck', CrossCheck)
        self.assertIsNotNone(checks.until(lambda c: True, 15), 'no periodic check')
        refused = one_arm.service('crosscheck', RunCrossCheck)(margin=3)
        self.assertFalse(refused.success)
        diagnostics = one_arm.Listener('/diagnostics', DiagnosticArray)
        found = diagnostics.until(lambda m: any('cross-check' in s.name for s in m.status), 10)
        self.assertIsNotNone(found)
        for s in found.status:
            if 'cross-check' in s.name:
                values = {v.key: v.value for v in s.values}
                self.assertEqual(values['pairs missed'], '0')
                self.assertGreater(float(values['checks']), 0)
            self.assertNotEqual(s.level, DiagnosticStatus.ERROR, s.message)

    def test_7_everything_published_is_finite(self):
        self.assertTrue(all(math.isfinite(m.stretch_max) and math.isfinite(m.energy_kinetic)
                            for m in self.states.messages))
        times = [m.time for m in self.states.messages]
        self.assertEqual(times, sorted(times))


def one_arm_pose(x, y, z):
    from geometry_msgs.msg import Pose
    pose = Pose()
    pose.position.x, pose.position.y, pose.position.z = x, y, z
    return pose


if __name__ == '__main__':
    rospy.init_node('test_towel')
    rostest.rosrun('robot_cloth', 'towel', Towel)
