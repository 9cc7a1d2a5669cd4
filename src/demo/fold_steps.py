#!/usr/bin/python3
"""Folds the towel step by step: asks the node (time/mode step) for each step with the joint states in it.

So nothing depends on how fast the machine is: this is how the pictures are taken, and how a test looks at
every step. Also publishes the joint states, for robot_state_publisher and RViz.

Parameters (private), beside those of fold_motion.py that say what to fold (scene, base, fold/NAME, settle):
  node           namespace of the cloth node (cloth)
  time_step      s of a step; that of the scene
  meshes         folder that gets OBJ files of cloth, links and boxes; empty: none
  meshes_every   steps between two sets of meshes
  moments        {name: [segment of the fold, share of it]}: where to hold still, say ~moment = name, and
                 go on when the parameter ~seen is that name; empty: nowhere
  tail           s simulated after the fold
"""
import os
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import arm  # noqa: E402
import fold_motion  # noqa: E402
import shapes  # noqa: E402

import rospkg  # noqa: E402
import rospy  # noqa: E402
import yaml  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_msgs.msg import String  # noqa: E402
from tf2_msgs.msg import TFMessage  # noqa: E402
from robot_cloth.msg import Topology  # noqa: E402
from robot_cloth.srv import GetState, Step  # noqa: E402


class Meshes:
    """Writes what the simulation shows at a step, from the URDF and the joint states of that step."""

    def __init__(self, folder, scene, robot, urdf, base, node):
        self.robot, self.base = robot, base
        self.cloth = scene['cloths'][0]['name']
        self.boxes = shapes.scene_boxes(scene)
        links = shapes.collision_shapes(urdf, rospkg.RosPack().get_path('robot_cloth'))
        self.parts = {'%s-%d' % (link, i): (link, part) for link, parts in links.items() for i, part in enumerate(parts)}
        self.folder = shapes.Folder(folder, [self.cloth], list(self.boxes) + list(self.parts))
        self.state = rospy.ServiceProxy(node + '/get_state', GetState, persistent=True)
        numbers = rospy.wait_for_message('%s/%s/topology' % (node, self.cloth), Topology, 30).triangles
        self.triangles = [numbers[i:i + 3] for i in range(0, len(numbers), 3)]

    def write(self, step, joints):
        answer = self.state(cloth=self.cloth, velocities=False)
        if not answer.success:
            raise RuntimeError(answer.message)
        x = answer.positions
        self.folder.write(self.cloth, step, [x[i:i + 3] for i in range(0, len(x), 3)], self.triangles)
        for name, (points, faces) in self.boxes.items():
            self.folder.write(name, step, points, faces)
        for name, (link, part) in self.parts.items():
            points, faces = shapes.moved(part, arm.product(self.base, self.robot.link_pose(link, joints)))
            self.folder.write(name, step, points, faces)


class FoldSteps(fold_motion.FoldMotion):
    def __init__(self):
        super().__init__()
        self.node = rospy.get_param('~node', 'cloth')
        with open(rospy.get_param('~scene')) as file:
            scene = yaml.safe_load(file)
        self.time_step = float(rospy.get_param('~time_step', (scene.get('params') or {}).get('time_step', 1 / 60)))
        self.moments = sorted((self.path.moment(*place), name)
                              for name, place in (rospy.get_param('~moments', None) or {}).items())
        self.moment = rospy.Publisher('~moment', String, queue_size=1, latch=True)
        self.every = max(1, int(rospy.get_param('~meshes_every', 1)))
        self.meshes = None
        if rospy.get_param('~meshes', ''):
            rospy.wait_for_service(self.node + '/step', 60)
            urdf = rospy.get_param(rospy.search_param('robot_description'))
            self.meshes = Meshes(rospy.get_param('~meshes'), scene, self.path.arms[0][0].robot, urdf, self.base, self.node)

    def hold_still(self, name, joints):
        """Wait until whoever looks has seen this moment."""
        self.moment.publish(name)
        deadline = time.monotonic() + 120
        while rospy.get_param('~seen', '') != name and not rospy.is_shutdown():
            self.show(joints)
            time.sleep(0.05)
            if time.monotonic() > deadline:
                raise RuntimeError('nobody set %s to "%s"' % (rospy.resolve_name('~seen'), name))

    def show(self, joints):
        message = JointState()
        message.header.stamp = rospy.Time.now()
        message.name = sorted(joints)
        message.position = [joints[name] for name in message.name]
        self.joints.publish(message)
        return message

    def run(self):
        self.tf.publish(TFMessage([self.base_transform()]))
        self.done.publish(False)
        rospy.wait_for_service(self.node + '/step', 60)
        step = rospy.ServiceProxy(self.node + '/step', Step, persistent=True)
        end = self.settle + self.path.duration / self.speed + float(rospy.get_param('~tail', 1.0))
        count = int(end / self.time_step)
        answer = None
        for i in range(1, count + 1):
            if rospy.is_shutdown():
                return
            t = (i * self.time_step - self.settle) * self.speed
            joints = self.path.positions(t)
            # frames are kept by the node; with the request they cannot come late, as /tf_static can
            answer = step(steps=1, joints=self.show(joints), frames=[self.base_transform()] if i == 1 else [])
            if not answer.success:
                raise RuntimeError('step %d: %s' % (i, answer.message))
            self.say(self.path.segment_at(t)[0].name if 0 <= t <= self.path.duration else 'home')
            if self.meshes and i % self.every == 0:
                self.meshes.write(i, joints)
            while self.moments and t >= self.moments[0][0]:
                self.hold_still(self.moments.pop(0)[1], joints)
        rospy.loginfo('fold: %d steps of %g s done, state hash %016x', count, self.time_step, answer.state_hash)
        rospy.set_param('~state_hash', '%016x' % answer.state_hash)
        self.done.publish(True)
        time.sleep(0.2)
        while self.stay and not rospy.is_shutdown():
            time.sleep(0.1)


def main():
    rospy.init_node('fold_motion')
    try:
        FoldSteps().run()
    except (fold_motion.StartError, arm.BadRobot, arm.OutOfReach, ValueError, RuntimeError,
            rospy.ServiceException) as error:
        rospy.logfatal('fold_steps: %s', error)
        return 2
    except rospy.ROSInterruptException:
        pass
    return 0


if __name__ == '__main__':
    sys.exit(main())
