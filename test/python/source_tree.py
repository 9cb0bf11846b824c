"""The package's Python modules and tools, for tests that run without installation."""

import contextlib
import os
import subprocess
import sys
import tempfile
import unittest
from typing import Iterator

_ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(_ROOT, "python"))

from omnitag.command_line import InputError  # noqa: E402


class FileTest(unittest.TestCase):
    """A test with a directory of its own."""

    def setUp(self) -> None:
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = directory.name

    def path(self, name: str) -> str:
        return os.path.join(self.directory, name)

    def write(self, name: str, content: str) -> str:
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(content)
        return self.path(name)

    @contextlib.contextmanager
    def assert_error(self, *parts: str) -> Iterator[None]:
        """An InputError of one line that has all these parts."""
        with self.assertRaises(InputError) as caught:
            yield
        for part in parts:
            self.assertIn(part, str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))

    def run_tool(self, name: str, *arguments: str) -> subprocess.CompletedProcess:
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        return subprocess.run([sys.executable, os.path.join(_ROOT, "tools", name), *arguments],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment,
                              universal_newlines=True, check=False)

    def assert_refused(self, result: subprocess.CompletedProcess, *parts: str) -> None:
        """Status 1, nothing on standard output, one line on standard error with these parts."""
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        for part in parts:
            self.assertIn(part, result.stderr)
