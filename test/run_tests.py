#!/usr/bin/python3
"""Runs ctest in build folders and counts single tests.

    run_tests.py BUILD_FOLDER [BUILD_FOLDER...] [-- CTEST_ARGUMENT...]

Prints every failed and every skipped test and closes with the line "N passed, N failed", or
"N passed, N failed, N skipped". Exit code 1 on any failure, also if no test ran.

A ctest entry is one program with many tests. They are counted from what it prints:
  C tests      ok   NAME | FAIL NAME | skip NAME
  gtest        [       OK ] NAME | [  FAILED  ] NAME | [  SKIPPED ] NAME
  rostest      [package.rosunit-file/name][passed] and the like
  unittest     name (class) ... ok | FAIL | ERROR | skipped
A program that prints none of these counts as one; one that fails although none of its tests did (a
crash, a time limit, a leak) counts as one failure more.
"""
import os
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

PATTERNS = (
    # result group, name group
    re.compile(r'^(?P<result>ok|FAIL|skip)\s{1,4}(?P<name>\S.*)$'),
    re.compile(r'^\[\s+(?P<result>OK|FAILED|SKIPPED)\s+\] (?P<name>[\w/]+\.[\w/]+)(?: \(|,|$)'),
    re.compile(r'^\[(?P<name>[\w.-]+rosunit-[^\]]+)\]\[(?P<result>passed|FAILURE|ERROR)\]'),
    re.compile(r'^(?P<name>test\w* \([\w.]+\)).*\.\.\. (?P<result>ok|FAIL|ERROR|skipped)\b'),
)
PASSED = ('ok', 'OK', 'passed')
SKIPPED = ('skip', 'SKIPPED', 'skipped')


def single_tests(output):
    """{name: result} of the tests that a program printed; a failure outweighs a pass of the same name."""
    found = {}
    for line in output.splitlines():
        for pattern in PATTERNS:
            match = pattern.match(line.strip())
            if match:
                name, result = match.group('name').strip(), match.group('result')
                if name not in found or found[name] in PASSED + SKIPPED:
                    found[name] = result
                break
    return found


def run_ctest(folder, arguments):
    """[(program, status, output, seconds)] of one build folder."""
    with tempfile.TemporaryDirectory() as scratch:
        report = os.path.join(scratch, 'report.xml')
        subprocess.run(['ctest', '--test-dir', folder, '--output-junit', report, '--output-on-failure',
                        '--test-output-size-passed', '10000000', '--test-output-size-failed', '10000000']
                       + arguments, check=False)
        if not os.path.exists(report):
            return []
        return [(case.get('name'), case.get('status'), case.findtext('system-out') or '', float(case.get('time') or 0))
                for case in ElementTree.parse(report).getroot().iter('testcase')]


def main():
    arguments = sys.argv[1:]
    extra = []
    if '--' in arguments:
        split = arguments.index('--')
        arguments, extra = arguments[:split], arguments[split + 1:]
    if not arguments:
        sys.exit(__doc__)
    passed, failed, skipped = 0, [], []
    for folder in arguments:
        programs = run_ctest(folder, extra)
        if not programs:
            failed.append('%s: no test ran' % folder)
        for program, status, output, _ in programs:
            label = '%s: %s' % (folder, program)
            if status in ('notrun', 'disabled'):
                skipped.append(label) if 'Skipped' in output or status == 'disabled' else failed.append(label + ': not run')
                continue
            tests = single_tests(output)
            bad = [name for name, result in tests.items() if result not in PASSED + SKIPPED]
            failed += ['%s: %s' % (label, name) for name in bad]
            skipped += ['%s: %s' % (label, name) for name, result in tests.items() if result in SKIPPED]
            passed += sum(1 for result in tests.values() if result in PASSED)
            if status != 'run' and not bad:
                failed.append('%s: the program failed (%s)' % (label, status))
            elif not tests:
                passed += 1
    print()
    for name in skipped:
        print('skipped: ' + name)
    for name in failed:
        print('FAILED: ' + name)
    # the tail that a log reader looks for
    print('%d passed, %d failed%s' % (passed, len(failed), ', %d skipped' % len(skipped) if skipped else ''))
    return 1 if failed or not passed else 0


if __name__ == '__main__':
    sys.exit(main())
