#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""count_instructions.py with hosts and counters replaced by small programs that tell given numbers."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parent / "count_instructions.py"
# Called as the counter before a host: NAME of the host's folder and whether it renders make the number.
NUMBER = 'case "$*" in *old/pm_host*--help*) n=100;; *new/pm_host*--help*) n=300;; ' \
         '*old/pm_host*) n=1100;; *new/pm_host*) n=${NEW:-1320};; *) n=5;; esac\n'  # fmt: skip
PERF = NUMBER + 'while [ "$1" != -o ]; do shift; done\necho "$n,,instructions:u,1,100.00,," >"$2"\n'
NO_PERF = 'while [ "$1" != -o ]; do shift; done\necho "<not supported>,,instructions:u,0,100.00,," >"$2"\n'
VALGRIND = NUMBER + 'echo "==1== I   refs:      0,00$n"\n'


class CountInstructions(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.base = pathlib.Path(folder.name)
        for name, text in (("perf", PERF), ("valgrind", VALGRIND), ("c++", "")):
            self.program(name, text)

    def program(self, name, text):
        path = self.base / name
        path.write_text("#!/bin/sh\n" + text)
        path.chmod(0o755)

    def count(self, *options, **environment):
        hosts = [str(self.base / which / "pm_host") for which in ("old", "new")]
        variables = dict(os.environ, PATH=f"{self.base}:{os.environ['PATH']}", **environment)
        return subprocess.run([sys.executable, "-B", str(SCRIPT), *hosts, "a.obj", *options], env=variables,
                              capture_output=True, text=True)  # fmt: skip

    def test_starts_are_taken_off(self):
        done = self.count()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("by perf", done.stdout)
        self.assertIn("| a | 0.0000 | 0.0000 | 1.0200 | 1.0200 to 1.0200 |", done.stdout)

    def test_the_limit(self):
        self.assertEqual(self.count("--limit", "3").returncode, 0)
        done = self.count("--limit", "3", NEW="1340")
        self.assertEqual(done.returncode, 1)
        self.assertIn("1.0400 times as many; at most 1.0300", done.stdout)

    def test_valgrind_where_perf_counts_nothing(self):
        self.program("perf", NO_PERF)
        done = self.count()
        self.assertIn("by valgrind", done.stdout)
        self.assertIn("| 1.0200 |", done.stdout)
        done = self.count("--counter", "perf")
        self.assertEqual(done.returncode, 2)
        self.assertIn("perf counts no instructions on this machine", done.stderr)

    def test_what_fails_is_told(self):
        self.program("perf", NO_PERF)
        self.program("valgrind", "echo its own words; exit 3\n")
        done = self.count()
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, "(?s)ended with 3: .*its own words")
        self.assertEqual(self.count("--counter", "valgrind", NEW="300").returncode, 2)


if __name__ == "__main__":
    unittest.main()
