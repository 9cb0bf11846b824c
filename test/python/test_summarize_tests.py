"""The count of test cases at the end of a test run."""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "summarize_tests.py"

PASSED = '<testcase name="Zero" status="run" classname="Angle"/>'
FAILED = ('<testcase name="Wraps" status="run" classname="Angle">'
          '<failure message="expected 0"/></testcase>')
ERROR = '<testcase name="Wraps" classname="Angle"><error type="KeyError"/></testcase>'
SKIPPED = '<testcase name="Slow" status="run" classname="Angle"><skipped/></testcase>'
DISABLED = '<testcase name="DISABLED_Slow" status="notrun" classname="Angle"/>'


class SummarizeTests(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.results = Path(folder.name)

    def write(self, name, *cases):
        suite = "<testsuites><testsuite>{}</testsuite></testsuites>".format("".join(cases))
        (self.results / f"{name}.xml").write_text(suite)

    def write_ctest(self, exit_status=None, **statuses):
        """What CTest leaves of tests that it has run, or that failed, or are disabled."""
        tests = [{"name": name, "properties": [{"name": "DISABLED", "value": status == "disabled"},
                                               {"name": "TIMEOUT", "value": 60.0}]}
                 for name, status in statuses.items()]
        (self.results / "ctest.json").write_text(json.dumps({"kind": "ctestInfo", "tests": tests}))
        failed = [name for name, status in statuses.items() if status == "fail"]
        if failed:
            (self.results / "ctest_failed.log").write_text(
                "".join(f"{number}:{name}\n" for number, name in enumerate(failed, 1)))
        if exit_status is None:
            exit_status = 8 if failed else 0
        (self.results / "ctest_status").write_text(f"{exit_status}\n")

    def summarize(self):
        """The last line, and the exit status."""
        process = subprocess.run([sys.executable, str(SCRIPT), str(self.results)],
                                 stdout=subprocess.PIPE, universal_newlines=True)
        return process.stdout.splitlines()[-1], process.returncode

    def test_counts_cases_of_all_tests(self):
        self.write_ctest(angle="run", pose="run")
        self.write("angle", PASSED, PASSED)
        self.write("pose", PASSED)
        self.assertEqual(self.summarize(), ("3 passed, 0 failed", 0))

    def test_skipped_and_disabled_cases_are_not_counted(self):
        self.write_ctest(angle="run")
        self.write("angle", PASSED, SKIPPED, DISABLED)
        self.assertEqual(self.summarize(), ("1 passed, 0 failed", 0))

    def test_disabled_tests_need_no_result_file(self):
        self.write_ctest(angle="run", slow="disabled")
        self.write("angle", PASSED)
        self.assertEqual(self.summarize(), ("1 passed, 0 failed", 0))

    def test_failures_and_errors_fail(self):
        self.write_ctest(angle="fail")
        self.write("angle", PASSED, FAILED, ERROR)
        self.assertEqual(self.summarize(), ("1 passed, 2 failed", 1))

    def test_missing_result_file_fails(self):
        self.write_ctest(angle="run", crashed="fail", never_built="fail")
        self.write("angle", PASSED)
        self.assertEqual(self.summarize(), ("1 passed, 2 failed", 1))

    def test_truncated_result_file_fails(self):
        self.write_ctest(angle="fail")
        (self.results / "angle.xml").write_text("<testsuites><testsuite>")
        self.assertEqual(self.summarize(), ("0 passed, 1 failed", 1))

    def test_crash_after_the_last_case_fails(self):
        self.write_ctest(angle="fail")
        self.write("angle", PASSED)
        self.assertEqual(self.summarize(), ("1 passed, 1 failed", 1))

    def test_test_without_cases_fails(self):
        self.write_ctest(angle="run", pose="run")
        self.write("angle", PASSED)
        self.write("pose")
        self.assertEqual(self.summarize(), ("1 passed, 1 failed", 1))

    def test_rostest_counts_the_cases_of_its_nodes(self):
        self.write_ctest(**{"rostest-node": "fail"})
        self.write("rostest-node", '<testcase name="testpose" classname="rostest.RosTest"/>')
        self.write("rosunit-pose", PASSED, PASSED, FAILED)
        self.assertEqual(self.summarize(), ("2 passed, 1 failed", 1))

    def test_rostest_whose_node_died_fails(self):
        self.write_ctest(**{"rostest-node": "fail"})
        self.write("rostest-node", '<testcase name="testpose" classname="rostest.RosTest">'
                                   '<failure message="pose is not a node"/></testcase>')
        self.assertEqual(self.summarize(), ("0 passed, 1 failed", 1))

    def test_no_tests_at_all_fails(self):
        self.write_ctest()
        self.assertEqual(self.summarize(), ("0 passed, 0 failed", 1))

    def test_ctest_that_broke_off_fails(self):
        self.write_ctest(exit_status=137, angle="run")
        self.write("angle", PASSED)
        self.assertEqual(self.summarize(), ("1 passed, 1 failed", 1))

    def test_ctest_without_a_status_fails(self):
        self.write_ctest(angle="run")
        self.write("angle", PASSED)
        (self.results / "ctest_status").unlink()
        self.assertEqual(self.summarize(), ("0 passed, 1 failed", 1))

    def test_unreadable_list_of_tests_fails(self):
        self.write_ctest(angle="run")
        (self.results / "ctest.json").write_text("")
        self.assertEqual(self.summarize(), ("0 passed, 1 failed", 1))

    def test_no_ctest_result_fails(self):
        self.assertEqual(self.summarize(), ("0 passed, 1 failed", 1))


if __name__ == "__main__":
    unittest.main()
