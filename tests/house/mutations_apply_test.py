#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""The mutations of tests/mutations fit the sources of today: patches apply, tests that they name exist.
Whether these fail is told by ./dev mutations."""
import os
import pathlib
import re
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "mutations"))
import mutations  # noqa: E402

PATCH = """# Light is lost
# on its way.
# Killed by: pm_test_a Suite.Name
# Killed by: farm.farm_test
diff --git a/integrator/a.cpp b/integrator/a.cpp
--- a/integrator/a.cpp
+++ b/integrator/a.cpp
@@ -1,2 +1,1 @@
 int a;
-int b;
"""


def gtests():
    """Program and test of each that the lists of tests/ have."""
    for lists in ROOT.glob("tests/**/CMakeLists.txt"):
        for program, rest in re.findall(r"^pm_test\((\w+)\s(.*?)\)", lists.read_text(encoding="utf-8"), re.M | re.S):
            for source in re.findall(r"(?<![\w/}])[\w/]+\.cpp", rest):
                text = (lists.parent / source).read_text(encoding="utf-8")
                for suite, test in re.findall(r"\bTEST(?:_[PF])?\(\s*(\w+),\s*(\w+)", text):
                    yield program, f"{suite}.{test}"


class Patches(unittest.TestCase):
    all = mutations.all_mutations()

    def test_all_apply(self):
        for mutation in self.all:
            with self.subTest(mutation.name):
                self.assertEqual(mutations.apply(mutation.patch, ROOT, "--check"), "")

    def test_all_name_tests_that_exist(self):
        known = set(gtests())
        for mutation in self.all:
            for killer in mutation.killers:
                with self.subTest(f"{mutation.name}: {killer}"):
                    if killer.program:
                        self.assertIn((killer.program, killer.test), known)
                    else:
                        self.assertTrue((ROOT / f"tests/{killer.test.replace('.', '/')}.py").is_file())

    def test_all_break_one_file_of_the_code(self):
        for mutation in self.all:
            with self.subTest(mutation.name):
                self.assertEqual(len(mutation.files), 1)
                self.assertRegex(mutation.files[0], r"^(integrator|scheduler|plugin|host_shim)/.*\.(cpp|h)$")


class Runner(unittest.TestCase):
    def folder_with(self, text):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        pathlib.Path(folder.name, "name.patch").write_text(text, encoding="utf-8")
        return pathlib.Path(folder.name)

    def test_reads_the_head_of_a_patch(self):
        (read,) = mutations.all_mutations(self.folder_with(PATCH))
        self.assertEqual(read.name, "name")
        self.assertEqual(read.what, "Light is lost on its way.")
        self.assertEqual(list(map(str, read.killers)), ["pm_test_a Suite.Name", "farm.farm_test"])
        self.assertEqual(read.targets, ["pm_host", "pm_plugin", "pm_test_a"])
        self.assertEqual(read.files, ("integrator/a.cpp",))

    def test_refuses_heads_that_lack_something(self):
        for lost in ("# Light is lost\n# on its way.\n", "# Killed by: pm_test_a Suite.Name\n# Killed by: farm.farm_test\n",
                     "+++ b/integrator/a.cpp\n", " Suite.Name"):  # fmt: skip
            self.assertIn(lost, PATCH)
            with self.subTest(lost), self.assertRaises(mutations.Fault):
                mutations.all_mutations(self.folder_with(PATCH.replace(lost, "")))

    def test_breaks_and_mends(self):
        folder = self.folder_with(PATCH)
        (folder / "integrator").mkdir()
        source = folder / "integrator/a.cpp"
        source.write_text("int a;\nint b;\n")
        time = source.stat().st_mtime_ns
        (folder / "old.o").write_text("")
        os.utime(folder / "old.o", (1, 1))
        (read,) = mutations.all_mutations(folder)
        checkout = mutations.Checkout(folder, folder, 1)
        with self.assertRaises(KeyboardInterrupt), checkout.broken(read):
            self.assertEqual(source.read_text(), "int a;\n")
            (folder / "new.o").write_text("")
            raise KeyboardInterrupt
        self.assertEqual(source.read_text(), "int a;\nint b;\n")
        self.assertEqual(source.stat().st_mtime_ns, time)
        self.assertEqual([path.name for path in folder.glob("*.o")], ["old.o"])
        source.write_text("int b;\n")
        with self.assertRaises(mutations.Fault), checkout.broken(read):
            pass
        self.assertEqual(source.read_text(), "int b;\n")

    def test_tells_failures_from_all_else(self):
        def told(*cases):
            return mutations.outcome_of_gtest({"testsuites": [{"testsuite": [case]} for case in cases]})

        passed, skipped = {"result": "COMPLETED"}, {"result": "SKIPPED"}
        failed = {"result": "COMPLETED", "failures": [{"failure": "no"}]}
        self.assertEqual(told(), "is not there")
        self.assertEqual(told(passed, passed), "passes")
        self.assertEqual(told(passed, failed), "fails")
        self.assertEqual(told(skipped), "skips")
        line = "1/1 Test #7: farm.farm_test ...................{}    1.50 sec"
        self.assertEqual(mutations.outcome_of_ctest(line.format("   Passed")), "passes")
        self.assertEqual(mutations.outcome_of_ctest(line.format("***Failed")), "fails")
        self.assertEqual(mutations.outcome_of_ctest(line.format("***Skipped")), "skips")
        self.assertEqual(mutations.outcome_of_ctest(line.format("***Timeout")), "ends by Timeout")
        self.assertEqual(mutations.outcome_of_ctest("No tests were found!!!"), "is not there")

    def test_copies_what_git_knows(self):
        root = self.folder_with(PATCH)
        for command in (["init", "-q"], ["add", "name.patch"]):
            mutations.run(["git", *command], root)
        (root / "unknown").write_text("")
        copy = root / "copy"
        for stale in ("", "build"):
            (copy / stale).mkdir(parents=True, exist_ok=True)
            (copy / stale / "stale.h").write_text("")
        mutations.copy_sources(root, copy)
        self.assertEqual([p.name for p in copy.rglob("*") if p.is_file()], ["name.patch"])
        time = (copy / "name.patch").stat().st_mtime_ns
        mutations.copy_sources(root, copy)
        self.assertEqual((copy / "name.patch").stat().st_mtime_ns, time)


if __name__ == "__main__":
    unittest.main()
