#!/usr/bin/python3
"""The count of tests that closes `make test`: test/run_tests.py."""
import os
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))
import run_tests  # noqa: E402


class CountTest(unittest.TestCase):
    def count(self, text):
        results = list(run_tests.single_tests(text).values())
        return (sum(r in run_tests.PASSED for r in results), sum(r in run_tests.SKIPPED for r in results),
                sum(r not in run_tests.PASSED + run_tests.SKIPPED for r in results))

    def test_c_tests_are_counted_by_line(self):
        self.assertEqual(self.count('ok   a_holds\nFAIL b_holds\nskip c_holds: no data\nx.c:3: 1 = 2\nok\n'), (1, 1, 1))

    def test_gtest_is_counted_once_although_it_repeats_failures(self):
        self.assertEqual(self.count('[ RUN      ] A.b\n[       OK ] A.b (0 ms)\n[  FAILED  ] A.c (1 ms)\n[  SKIPPED ] A.d (0 ms)\n'
                                    '[  PASSED  ] 1 test.\n[  FAILED  ] 1 test, listed below:\n[  FAILED  ] A.c\n\n'), (1, 1, 1))

    def test_rostest_results_are_counted(self):
        self.assertEqual(self.count('[robot_cloth.rosunit-grasp/test_lift][passed]\n'
                                    '[robot_cloth.rosunit-grasp/test_drop][FAILURE]-----\n'), (1, 0, 1))

    def test_unittest_is_counted(self):
        self.assertEqual(self.count('test_a (__main__.T.test_a) ... ok\ntest_b (__main__.T.test_b) ... FAIL\n'
                                    'test_c (__main__.T.test_c) ... skipped \'no data\'\n'), (1, 1, 1))

    def test_other_words_are_not_counted(self):
        self.assertEqual(self.count('okay then\nit is ok\n[ROSTEST]----\n * RESULT: SUCCESS\n'), (0, 0, 0))


if __name__ == '__main__':
    unittest.main(verbosity=2)
