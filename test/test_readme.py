#!/usr/bin/env python3
"""The tables of README.md are those of the code: parameters as `cloth params` prints them, stages of stages.inl.

usage: test_readme.py COMMAND        COMMAND is the built `cloth`
"""
import os
import re
import subprocess
import sys

TOP = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..')


def between(text, begin):
    return re.search(r'<!-- %s.*?-->\n(.*?)<!-- end -->' % begin, text, re.S).group(1).strip().splitlines()


def parameters_are_those_of_the_command(readme, command):
    return between(readme, 'parameters') == subprocess.check_output([command, 'params'], text=True).strip().splitlines()


def stages_are_those_of_the_engine(readme, _):
    with open(os.path.join(TOP, 'src/stages.inl')) as f:
        stages = re.findall(r'CLOTH_STAGE\((\w+), "([^"]+)", "([^"]+)"\)', f.read())
    rows = [tuple(cell.strip(' `') for cell in row.strip('|').split(' | ')) for row in between(readme, 'stages')[2:]]
    return [tuple(c.strip() for c in r) for r in rows] == stages and all(os.path.exists(os.path.join(TOP, f)) for _, f, _ in stages)


def main():
    with open(os.path.join(TOP, 'README.md')) as f:
        readme = f.read()
    failures = 0
    for test in (parameters_are_those_of_the_command, stages_are_those_of_the_engine):
        good = test(readme, sys.argv[1])
        print('%s %s' % ('ok  ' if good else 'FAIL', test.__name__))
        failures += not good
    return failures != 0


if __name__ == '__main__':
    sys.exit(main())
