#!/usr/bin/python3
"""start.test: what cannot work fails at start, with exit code 2 and a message that names the fix."""
import os
import signal
import subprocess
import sys
import unittest

import roslib.packages
import rosgraph
import rospy
import rostest

HERE = os.path.dirname(os.path.realpath(__file__))
SCENE = os.path.join(HERE, 'data/small_towel.yaml')
URDF = os.path.join(HERE, 'data/one_arm.urdf')
GRIPPER = dict(name='g', joint='finger', close_below=0.1, open_above=0.2, frame='tool', region=dict(size=[1, 1, 1]))


class Start(unittest.TestCase):
    def setUp(self):
        self.node = roslib.packages.find_node('robot_cloth', 'cloth_node')[0]

    def run_node(self, params, seconds=20, description=None, end=signal.SIGINT):
        """(exit code, everything it printed); exit code None: it was still running, and was ended by the signal `end`."""
        server = rosgraph.Master('/test_start')
        for name in ('/start_test', '/robot_description'):
            if server.hasParam(name):
                server.deleteParam(name)
        rospy.set_param('/start_test', params)
        if description is not None:
            rospy.set_param('/robot_description', description)
        process = subprocess.Popen([self.node, '__name:=start_test'], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   universal_newlines=True, env=dict(os.environ, ROSCONSOLE_FORMAT='|${message}|'))
        try:
            out, _ = process.communicate(timeout=seconds)
            return process.returncode, out
        except subprocess.TimeoutExpired:
            process.send_signal(end)
            out, _ = process.communicate(timeout=20)
            return None, out

    def refuses(self, *texts, description=None, **params):
        params.setdefault('use_robot', False)
        params.setdefault('scene', SCENE)
        code, out = self.run_node({k: v for k, v in params.items() if v is not None}, description=description)
        self.assertEqual(code, 2, out)
        for text in texts:
            self.assertIn(text, out)

    def test_scene_missing(self):
        self.refuses('/start_test/scene is not set', scene=None)
        self.refuses('/start_test/scene', 'no_such.yaml', scene='/no_such.yaml')

    def test_unknown_key_names_the_nearest(self):
        self.refuses('/start_test/wrld_frame is not known', 'did you mean /start_test/world_frame', wrld_frame='map')
        self.refuses('publish/marker_rte', 'publish/marker_rate', publish=dict(marker_rte=1.0))
        self.refuses('thicknes', "thickness", params=dict(thicknes=0.003))

    def test_wrong_type(self):
        self.refuses('/start_test/run_duration must be a number, but it is a string', run_duration='long')
        self.refuses('/start_test/use_robot must be true or false', use_robot=1)
        self.refuses('/start_test/crosscheck/every must be an int', crosscheck=dict(every=1.5))
        self.refuses('/start_test/params/thickness must be a number', params=dict(thickness='0.003'))
        self.refuses('/start_test/params/gravity must be a list of 3 numbers', params=dict(gravity=[0, 1]))
        self.refuses('/start_test/time must be a dictionary with keys such as time/mode', 'a string (step)', time='step')
        self.refuses('/start_test/params must be a dictionary', params=[1])

    def test_out_of_range(self):
        self.refuses('/start_test/crosscheck/margin is 3 m', '[1e-05, 0.1] m', crosscheck=dict(margin=3.0))
        self.refuses('/start_test/params/thickness', '0.05', params=dict(thickness=3.0))
        self.refuses("/start_test/time/mode is 'clok'", "did you mean 'clock'", time=dict(mode='clok'))
        self.refuses('joint_states', 'use clock', time=dict(mode='joint_states'))
        self.refuses('/start_test/world_frame is empty', world_frame='')

    def test_grippers(self):
        self.refuses('grippers[0]/region/size is missing', grippers=[{k: v for k, v in GRIPPER.items() if k != 'region'}])
        self.refuses('grippers[0]/joitn', 'did you mean', grippers=[dict(GRIPPER, joitn='x')])
        self.refuses('the gap is the hysteresis', grippers=[dict(GRIPPER, open_above=0.05)])

        self.refuses('region/center is nan m', grippers=[dict(GRIPPER, region=dict(size=[1, 1, 1], center=[0, 0, float('nan')]))])
        self.refuses("grippers 0 and 1 are both named 'g'", grippers=[GRIPPER, GRIPPER])
        self.refuses('grippers[0]/cloth', "no cloth 'towl'", 'towel', grippers=[dict(GRIPPER, cloth='towl')])

    def test_grippers_of_another_robot(self):
        with open(URDF) as file:
            robot = dict(use_robot=True, description=file.read())
        self.refuses("grippers[0]/joint: the robot has no joint 'fingr'; did you mean finger?",
                     grippers=[dict(GRIPPER, joint='fingr')], **robot)
        self.refuses("grippers[0]/joint: joint 'tool_mount' is fixed", grippers=[dict(GRIPPER, joint='tool_mount')], **robot)
        self.refuses("grippers[0]/links: the robot has no link 'iner_finger'; did you mean inner_finger?",
                     grippers=[dict(GRIPPER, links=['iner_finger'])], **robot)

    def test_gripper_in_another_unit_is_told(self):
        with open(URDF) as file:
            urdf = file.read()
        for close, open_, says in ((6.0, 10.0, 'never opens'), (-1.0, 0.01, 'never closes')):
            gripper = dict(GRIPPER, close_below=close, open_above=open_)
            code, out = self.run_node(dict(scene=SCENE, run_duration=0.05, time=dict(mode='wall'), grippers=[gripper]),
                                      description=urdf)
            self.assertEqual(code, 0, out)
            self.assertIn('joint finger goes from 0 to 0.06 m', out)
            self.assertIn(says, out)

    def test_clock_that_it_cannot_own(self):
        self.refuses('time/publish_clock', time=dict(mode='clock', publish_clock=True))

    def test_robot(self):
        self.refuses('robot_description is not set', 'use_robot', use_robot=True, robot_timeout=0.5)
        self.refuses('robot_description is empty', use_robot=True, robot_timeout=0.5, description='')
        self.refuses('robot_description', use_robot=True, description='<robot name="x"><link')
        with open(URDF) as file:
            urdf = file.read()
        self.refuses('robot_description', use_robot=True, description=urdf.replace('name="tool"', 'name="palm"', 1))

    def test_interrupt_while_it_waits_for_the_robot(self):
        code, out = self.run_node(dict(scene=SCENE, robot_timeout=600.0), seconds=2)
        self.assertIsNone(code, out)
        self.assertIn('shut down while waiting', out)

    def test_terminated_it_says_goodbye(self):
        code, out = self.run_node(dict(scene=SCENE, use_robot=False, time=dict(mode='wall')), seconds=3, end=signal.SIGTERM)
        self.assertIsNone(code, out)
        self.assertIn('summary of the run', out)
        services = rosgraph.Master('/test_start').getSystemState()[2]
        self.assertFalse([name for name, _ in services if name.startswith('/start_test/')], 'still registered at the master')

    def test_good_ends_with_a_summary(self):
        code, out = self.run_node(dict(scene=SCENE, use_robot=False, run_duration=0.5, time=dict(mode='wall')))
        self.assertEqual(code, 0, out)
        for text in ('summary of the run', 'steps                 30', 'real-time factor', 'worst stretch'):
            self.assertIn(text, out)

    def test_every_parameter_is_logged_with_unit_and_default(self):
        code, out = self.run_node(dict(scene=SCENE, use_robot=False, run_duration=0.1, time=dict(mode='wall'),
                                       params=dict(thickness=0.002)))
        self.assertEqual(code, 0, out)
        self.assertRegex(out, r'~params/thickness = 0\.002 m\|')
        self.assertRegex(out, r'~robot_friction = 0\.4 1 \(default\)\|')

    def test_scene_parameters_override_the_file(self):
        code, out = self.run_node(dict(scene=SCENE, use_robot=False, run_duration=0.5, time=dict(mode='wall'),
                                       params=dict(time_step=0.05, devices='cpu,cpu', effects=dict(damping=False))))
        self.assertEqual(code, 0, out)
        self.assertIn('steps                 10', out)


if __name__ == '__main__':
    rospy.init_node('test_start')
    rostest.rosrun('robot_cloth', 'start', Start)
