#!/usr/bin/python3
"""What can be checked without a master: message names against the report, launch files, the parameter file."""
import glob
import os
import re
import unittest

import genmsg
import yaml
from roslaunch.config import load_config_default

HERE = os.path.dirname(os.path.realpath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
TYPES = {'double': 'float64', 'int': 'int32', 'int64_t': 'int64', 'uint64_t': 'uint64'}


def read(path):
    with open(os.path.join(ROOT, path)) as file:
        return file.read()


class Files(unittest.TestCase):
    def test_state_carries_every_field_of_the_report(self):
        wanted = [(name, TYPES[kind]) for kind, name in
                  re.findall(r'^CLOTH_REPORT\((\w+), (\w+),', read('src/report.inl'), re.M)]
        wanted += [('ms_' + name, 'float64') for name in re.findall(r'^CLOTH_STAGE\((\w+),', read('src/stages.inl'), re.M)]
        self.assertGreater(len(wanted), 30)
        spec = genmsg.msg_loader.load_msg_from_string(genmsg.MsgContext.create_default(), read('msg/State.msg'),
                                                      'robot_cloth/State')
        self.assertEqual(list(zip(spec.names, spec.types))[-len(wanted):], wanted)

    def test_messages_with_a_header_begin_with_it(self):
        # rosbag play --rate-control-topic looks for these very words at the start of the definition
        for path in glob.glob(os.path.join(ROOT, 'msg/*.msg')):
            text = read(path)
            if re.search(r'^Header ', text, re.M):
                self.assertTrue(text.startswith('Header header\n'), path)

    def test_launch_files_parse(self):
        os.environ.setdefault('ROS_MASTER_URI', 'http://localhost:11311')
        scene = os.path.join(HERE, 'data/small_towel.yaml')
        paths = sorted(glob.glob(os.path.join(ROOT, 'launch/*.launch')))
        self.assertTrue(paths)
        for path in paths:
            with self.subTest(os.path.basename(path)):
                config = load_config_default([(path, ['scene:=' + scene])], None, verbose=False)
                self.assertFalse(config.config_errors)
                self.assertIn('cloth', [n.name for n in config.nodes])
        for path in sorted(glob.glob(os.path.join(HERE, '*.test'))):
            with self.subTest(os.path.basename(path)):
                self.assertFalse(load_config_default([path], None, verbose=False).config_errors)

    def test_launch_arguments_are_documented(self):
        for path in glob.glob(os.path.join(ROOT, 'launch/*.launch')):
            for name, rest in re.findall(r'^  <arg name="(\w+)"([^>]*(?:"[^"]*"[^>]*)*)/>', read(path), re.M):
                self.assertIn('doc=', rest, '%s: argument %s' % (path, name))

    def test_parameter_file_holds_the_defaults(self):
        flat = {}

        def flatten(prefix, value):
            if isinstance(value, dict):
                for k, v in value.items():
                    flatten(prefix + '/' + k if prefix else k, v)
            else:
                flat[prefix] = value
        flatten('', yaml.safe_load(read('config/params/node.yaml')))
        defaults = {name: yaml.safe_load(value) for name, value in
                    re.findall(r'^CLOTH_SETTING\(\w+, \w+, "([^"]+)", ("[^"]*"|[^",]+),', read('src/node/settings.inl'), re.M)}
        for name, value in flat.items():
            self.assertIn(name, defaults)
            self.assertEqual(value, defaults[name], name)

    def test_gripper_files_parse(self):
        for path in glob.glob(os.path.join(ROOT, 'config/grippers/*.yaml')):
            for gripper in yaml.safe_load(read(path))['grippers']:
                self.assertTrue({'name', 'joint', 'frame', 'region', 'links'} <= set(gripper), path)

    def test_parameter_table_of_the_guide_is_that_of_the_code(self):
        guide = read('doc/ros.md')
        for name, value in re.findall(r'^CLOTH_SETTING\(\w+, \w+, "([^"]+)", ("[^"]*"|[^",]+),', read('src/node/settings.inl'), re.M):
            self.assertRegex(guide, r'\| `~%s` \| [^|]*\| %s' % (re.escape(name), re.escape('`%s`' % value.strip('"') if value != '""' else '')))


if __name__ == '__main__':
    unittest.main(verbosity=2)
