#!/usr/bin/python3
"""Publishes the joint states of two_arm folding a towel, as the driver of a real robot would.

100 messages a second of ROS time on the topic joint_states: names, positions, velocities; mimic joints
are left out, as most drivers do. Also latches the transform of the world to the robot's root link, the
present segment of the fold (~phase) and whether it is over (~done). A clock that runs back starts the
fold again.

Parameters (private):
  scene          scene file with the towel and the table; required
  speed          1 is the speed that fold_path.py was made for; in (0, 3]
  loop           false: once. true: again and again, calling the service `reset_service` in between
  wait_for       topic that must have brought a message before the fold starts; empty: start at once
  wait_timeout   wall time to wait for it, s
  settle         time at the home position before and after the fold, s
  stay           stay (and keep publishing) after the end instead of exiting
  base           where the robot stands in the scene: [x, y, z], m
  fold/NAME      overrides a number of fold_path.FOLD
"""
import os
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import arm  # noqa: E402
import fold_path  # noqa: E402

import rospy  # noqa: E402
import yaml  # noqa: E402
from geometry_msgs.msg import TransformStamped  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_msgs.msg import Bool, String  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402
from tf2_msgs.msg import TFMessage  # noqa: E402

PERIOD = 0.01  # s


class StartError(Exception):
    """What keeps the fold from starting; the text names the parameter to fix."""


def number(name, default, least, most):
    value = rospy.get_param('~' + name, default)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not least <= value <= most:
        raise StartError('%s is %r, needs a number from %g to %g' % (rospy.resolve_name('~' + name), value, least, most))
    return float(value)


def read_scene():
    path = rospy.get_param('~scene', '')
    if not path:
        raise StartError('%s is not set: the scene file with towel and table' % rospy.resolve_name('~scene'))
    try:
        with open(path) as file:
            return fold_path.task_from_scene(yaml.safe_load(file))
    except (OSError, yaml.YAMLError, ValueError, KeyError, TypeError) as error:
        raise StartError('%s = %s: %s' % (rospy.resolve_name('~scene'), path, error))


def read_robot(timeout=30.0):
    deadline = time.monotonic() + timeout
    while not rospy.is_shutdown():
        name = rospy.search_param('robot_description')
        if name:
            return arm.Robot(rospy.get_param(name))
        if time.monotonic() > deadline:
            raise StartError('no parameter robot_description after %g s; fold.launch sets it' % timeout)
        time.sleep(0.1)
    raise StartError('interrupted')


class FoldMotion:
    def __init__(self):
        base = rospy.get_param('~base', [0, 0, 0])
        if not isinstance(base, list) or len(base) != 3:
            raise StartError('%s is %r, needs [x, y, z]' % (rospy.resolve_name('~base'), base))
        robot = read_robot()
        self.base = arm.translation(*base)
        self.path = fold_path.FoldPath(robot, read_scene(), self.base, **rospy.get_param('~fold', {}))
        self.root = robot.root
        self.speed = number('speed', 1.0, 1e-3, 3.0)
        self.settle = number('settle', 1.0, 0.0, 60.0)
        self.loop = rospy.get_param('~loop', False)
        self.stay = rospy.get_param('~stay', False)
        self.world = rospy.get_param('~world_frame', 'world')
        self.joints = rospy.Publisher('joint_states', JointState, queue_size=100)
        self.tf = rospy.Publisher('/tf_static', TFMessage, queue_size=1, latch=True)
        self.phase = rospy.Publisher('~phase', String, queue_size=10, latch=True)
        self.done = rospy.Publisher('~done', Bool, queue_size=1, latch=True)
        self.spoken = None

    def base_transform(self):
        t = TransformStamped()
        t.header.stamp, t.header.frame_id, t.child_frame_id = rospy.Time.now(), self.world, self.root
        at, turn = t.transform.translation, t.transform.rotation
        at.x, at.y, at.z = (self.base[i][3] for i in range(3))
        turn.x, turn.y, turn.z, turn.w = arm.quaternion(self.base)
        return t

    def say(self, name):
        if name != self.spoken:
            self.spoken = name
            self.phase.publish(name)
            rospy.loginfo('fold: %s', name)

    def send(self, stamp, t):
        """Publish the joint states of time t of the fold."""
        positions, velocities = self.path.positions(t), self.path.velocities(t)
        message = JointState()
        message.header.stamp = rospy.Time.from_sec(stamp)
        message.name = sorted(positions)
        message.position = [positions[name] for name in message.name]
        message.velocity = [velocities[name] * self.speed for name in message.name]
        self.joints.publish(message)

    def ticks(self):
        """Stamps on the grid of PERIOD as ROS time passes them; None where the clock ran back."""
        last = None
        while not rospy.is_shutdown():
            now = rospy.Time.now().to_sec()
            tick = int(now / PERIOD)
            if now > 0 and last is not None and tick < last - 1:
                last = tick
                yield None
            elif now > 0 and (last is None or tick > last):
                # like a driver that was held up: no burst of old messages beyond a tenth of a second
                first = tick if last is None else max(last + 1, tick - int(0.1 / PERIOD))
                for i in range(first, tick + 1):
                    yield i * PERIOD
                last = tick
            time.sleep(PERIOD / 4)

    def run(self):
        self.tf.publish(TFMessage([self.base_transform()]))
        self.done.publish(False)
        waiting = self.wait_for_node()
        start = None
        for stamp in self.ticks():
            if stamp is None:
                rospy.logwarn('fold: the clock ran back, starting again')
                start = None
                continue
            if start is None:
                if waiting():
                    self.say('waiting')
                    self.send(stamp, 0.0)
                    continue
                start = stamp + self.settle
            t = (stamp - start) * self.speed
            self.send(stamp, min(max(t, 0.0), self.path.duration))
            if t >= self.path.duration + self.settle * self.speed:
                if self.loop:
                    self.reset_cloth()
                    start = None
                    continue
                self.say('done')
                self.done.publish(True)
                if not self.stay:
                    time.sleep(0.2)  # let the last messages out
                    return
            elif t >= 0:
                self.say(self.path.segment_at(t)[0].name)

    def wait_for_node(self):
        """A function that says whether the fold must still wait for the topic `wait_for`."""
        topic = rospy.get_param('~wait_for', '')
        if not topic:
            return lambda: False
        heard = []
        subscriber = rospy.Subscriber(topic, rospy.AnyMsg, lambda message: heard.append(1) if not heard else None)
        deadline = time.monotonic() + number('wait_timeout', 60.0, 0.0, 3600.0)

        def waiting():
            if heard:
                subscriber.unregister()
                return False
            if time.monotonic() > deadline:
                raise StartError('nothing came on %s in time (parameter %s)'
                                 % (subscriber.resolved_name, rospy.resolve_name('~wait_timeout')))
            return True
        return waiting

    def reset_cloth(self):
        name = rospy.get_param('~reset_service', 'cloth/reset')
        try:
            answer = rospy.ServiceProxy(name, Trigger)()
            rospy.loginfo('fold: %s: %s', name, answer.message)
        except rospy.ServiceException as error:
            rospy.logwarn('fold: %s failed: %s', name, error)


def main():
    rospy.init_node('fold_motion')
    try:
        FoldMotion().run()
    except (StartError, arm.BadRobot, arm.OutOfReach, ValueError) as error:
        rospy.logfatal('fold_motion: %s', error)
        return 2
    except rospy.ROSInterruptException:
        pass
    return 0


if __name__ == '__main__':
    sys.exit(main())
