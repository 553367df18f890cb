#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""What ./dev test NAME builds and runs."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[1] / "run/named_tests.py"


class NamedTests(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="pm named tests ")
        self.addCleanup(folder.cleanup)
        self.programs = pathlib.Path(folder.name) / "programs.txt"
        warps = pathlib.Path(folder.name.replace(" ", "_") + ".cpp")
        self.addCleanup(warps.unlink, missing_ok=True)
        warps.write_text("TEST(Warps, Triangle) {}\nTEST_P(Lobes, AddUp) {}\n")
        keys = pathlib.Path(folder.name.replace(" ", "_") + "2.cpp")
        self.addCleanup(keys.unlink, missing_ok=True)
        keys.write_text("TEST_F(ObjKeys,\n       areRead) {}\n")
        self.programs.write_text(
            f"pm_test_warps;pm_test_warps;;{warps}\npm_test_ingest;pm_test_ingest;1;{keys}\n"
            "house.docs_test;pm_host pm_plugin;;\nhouse.house_rules;;;\n")  # fmt: skip

    def ask(self, *names):
        done = subprocess.run([sys.executable, "-B", str(SCRIPT), str(self.programs), *names],
                              capture_output=True, text=True)  # fmt: skip
        return done.returncode, [line for line in done.stdout.splitlines() if line], done.stderr

    def test_a_program_by_its_name(self):
        for name in ("pm_test_warps", "warps"):
            self.assertEqual(self.ask(name)[1], ["build pm_test_warps", r"ctest ^pm_test_warps\."])

    def test_a_script_and_what_it_needs(self):
        self.assertEqual(self.ask("docs_test")[1], ["build pm_host pm_plugin", r"ctest ^house\.docs_test$"])
        self.assertEqual(self.ask("house_rules")[1], ["build", r"ctest ^house\.house_rules$"])

    def test_cases_by_an_expression(self):
        self.assertEqual(self.ask("Warps.Tri")[1], ["build pm_test_warps", r"ctest ^pm_test_warps\.(.*/)?Warps\.Triangle"])

    def test_cases_of_a_program_whose_cases_share_a_process(self):
        self.assertEqual(self.ask("areRead")[1], ["build pm_test_ingest", "run pm_test_ingest *ObjKeys.areRead*"])

    def test_several_names(self):
        build, run = self.ask("warps", "docs_test")[1]
        self.assertEqual(build, "build pm_test_warps pm_host pm_plugin")
        self.assertEqual(run, r"ctest ^pm_test_warps\.|^house\.docs_test$")

    def test_a_name_of_nothing(self):
        status, lines, text = self.ask("wraps")
        self.assertEqual((status, lines), (2, []))
        self.assertIn("no test is called 'wraps'; programs: pm_test_warps", text)


if __name__ == "__main__":
    unittest.main()
