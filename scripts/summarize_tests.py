#!/usr/bin/env python3
"""Counts the test cases of a CTest run, and ends with the line `N passed, N failed`.

The folder given holds what CTest told: its list of tests, `ctest.json`, its exit status,
`ctest_status`, and where one failed, `ctest_failed.log`; and for each CTest test NAME the cases that
it ran, `NAME.xml`, in the JUnit format; beside `rostest-NAME.xml`, the cases of each of its nodes are
in `rosunit-NODE.xml`. A test without such a file (it crashed, or could not be started), one that ran
no case, and one that ended with an error though its cases passed each count as one failure, and so
does CTest where it ended with an error though no test failed.
Exit status 0 only where something passed and nothing failed.
"""

import argparse
import json
import sys
from pathlib import Path
from typing import List, Set, Tuple
from xml.etree import ElementTree


def count_cases(path: Path) -> Tuple[int, List[str]]:
    """The number of passed test cases in a JUnit file, and the names of those that failed.

    Skipped and disabled cases are neither.
    """
    passed = 0
    failed = []
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        name = case.get("name", "")
        if case.find("failure") is not None or case.find("error") is not None:
            failed.append(f"{case.get('classname', '')}.{name}")
        elif path.name.startswith("rostest-") and _node_results(path, name).exists():
            node_passed, node_failed = count_cases(_node_results(path, name))
            passed += node_passed
            failed += node_failed
        elif case.find("skipped") is None and case.get("status") != "notrun":
            passed += 1
    return passed, failed


def _node_results(rostest: Path, case: str) -> Path:
    """Where rostest leaves what a test node, its case `testNODE`, has written."""
    return rostest.with_name(f"rosunit-{case[len('test'):]}.xml")


def enabled_tests(listing: Path) -> List[str]:
    """The names of the tests in what `ctest --show-only=json-v1` wrote, without disabled ones."""
    names = []
    for test in json.loads(listing.read_text(encoding="utf-8"))["tests"]:
        properties = {entry["name"]: entry["value"] for entry in test.get("properties", [])}
        if not properties.get("DISABLED", False):
            names.append(test["name"])
    return names


def failed_tests(log: Path) -> Set[str]:
    """The names in CTest's list of failed tests, of lines NUMBER:NAME; it writes none without."""
    if not log.exists():
        return set()
    return {line.partition(":")[2] for line in log.read_text(encoding="utf-8").splitlines()}


def summarize(results: Path) -> Tuple[int, List[str]]:
    """The number of passed test cases of a CTest run, and a line for each failure."""
    passed = 0
    failures = []
    ended_with_error = failed_tests(results / "ctest_failed.log")
    for name in enabled_tests(results / "ctest.json"):
        try:
            test_passed, test_failed = count_cases(results / f"{name}.xml")
        except (FileNotFoundError, ElementTree.ParseError):
            failures.append(f"{name}: ended without a result file")
            continue
        passed += test_passed
        failures += [f"{name}: {case}" for case in test_failed]
        if not test_failed and name in ended_with_error:
            failures.append(f"{name}: ended with an error, though its cases passed")
        elif not test_failed and test_passed == 0:
            failures.append(f"{name}: ran no test case")
    status = (results / "ctest_status").read_text(encoding="utf-8").strip()
    if status != "0" and not failures:
        failures.append(f"CTest ended with status {status}, though no test failed")
    return passed, failures


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=Path, help="folder with ctest.json and NAME.xml")
    arguments = parser.parse_args()
    try:
        passed, failures = summarize(arguments.results)
    except (FileNotFoundError, ValueError, KeyError) as error:
        passed, failures = 0, [f"{arguments.results}: no result of CTest: {error}"]
    for failure in failures:
        print(f"failed: {failure}")
    print(f"{passed} passed, {len(failures)} failed")
    return 0 if passed and not failures else 1


if __name__ == "__main__":
    sys.exit(main())
