#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""The dev script with apt, sudo, CMake and Ninja replaced by small programs that write down how
they were called: nothing is installed or built here."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

DEV = pathlib.Path(__file__).resolve().parents[2] / "dev"
LOG = 'echo "$(basename "$0") $*" >>"$DEV_TEST_LOG"\n'
TOOLS = {
    "dpkg-query": 'for p in $INSTALLED; do echo "installed $p"; done; echo "not-installed gone"\n',
    "apt-get": LOG + 'echo noise; echo "E: the text of apt" >&2; exit "${APT_STATUS:-0}"\n',
    "id": 'echo "${USER_ID:-0}"\n',
    "sudo": LOG + '[ "${SUDO_WORKS:-0}" = 1 ] || exit 1; shift; exec "$@"\n',
    # As cmake --preset NAME makes build/NAME; --install is only written down.
    "cmake": LOG + '[ "$1" != --preset ] || { mkdir -p "build/$2" && touch "build/$2/build.ninja"; }\n',
    "clang++": "",
    "ninja": LOG + 'echo "ninja speaks"; exit "${NINJA_STATUS:-0}"\n',
    "ctest": LOG + 'echo "100% tests passed, 0 tests failed out of 3"\n'
                   'echo "$TSAN_OPTIONS" >>"$DEV_TEST_LOG"\n',
}
HOST = 'printf "%s|" "$PWD" "$@"; exit "${HOST_STATUS:-0}"\n'


class DevScript(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="pm dev test ")
        self.addCleanup(folder.cleanup)
        base = pathlib.Path(folder.name).resolve()
        self.root, self.work, self.tools = base / "the repository", base / "a folder", base / "tools"
        self.log = base / "log"
        for path in (self.root / "build/release/bin", self.work, self.tools):
            path.mkdir(parents=True)
        shutil.copy(DEV, self.root / "dev")
        (self.root / "CMakePresets.json").write_text("{}")
        for name, text in TOOLS.items():
            self.program(self.tools / name, text)
        self.program(self.root / "build/release/bin/pm_host", HOST)
        lists = re.findall(r"^(?:\w+_)?packages=\((.*?)\)", DEV.read_text(), re.DOTALL | re.MULTILINE)
        self.assertEqual(len(lists), 4)
        self.packages = " ".join(lists).split()

    @staticmethod
    def program(path, text):
        path.write_text("#!/bin/sh\n" + text)
        path.chmod(0o755)

    def dev(self, *arguments, missing=(), **environment):
        self.log.write_text("")
        installed = " ".join(p for p in self.packages if p not in missing)
        # What the suite itself was called with is not this test's.
        outer = {name: value for name, value in os.environ.items() if name != "PM_TOGETHER"}
        variables = dict(outer, PATH=f"{self.tools}:{os.environ['PATH']}", INSTALLED=installed,
                         DEV_TEST_LOG=str(self.log), **environment)  # fmt: skip
        done = subprocess.run([str(self.root / "dev"), *arguments], cwd=self.work, env=variables,
                              stdin=subprocess.DEVNULL, capture_output=True, text=True)  # fmt: skip
        self.calls = self.log.read_text().splitlines()
        return done

    def host_arguments(self, *arguments):
        done = self.dev("render", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        folder, *rest = done.stdout.split("|")[:-1]
        self.assertEqual(folder, str(self.work))
        return rest

    def test_alone_lists_the_verbs(self):
        done = self.dev()
        self.assertEqual(done.returncode, 0)
        for verb in ("setup", "build", "render", "test", "mutations", "bench", "format", "lint", "install"):
            self.assertRegex(done.stdout, rf"(?m)^  {verb}\b")
        self.assertEqual(self.dev("rendr").returncode, 2)

    def test_render_names_the_pictures_when_the_user_does_not(self):
        self.assertEqual(self.host_arguments("some where/box.v2.obj", "--size", "8x8"),
                         ["some where/box.v2.obj", "--size", "8x8", "-o", "box.v2.exr",
                          "-o", "box.v2.png"])  # fmt: skip

    def test_render_leaves_the_arguments_alone(self):
        for arguments in (["a.obj", "-o", "x y.exr"], ["a.obj", "--output=x.png"], ["-ox.exr", "a.obj"],
                          ["a.obj", "--output", "x.png"], ["--help"], [], ["*", "$HOME", ""]):  # fmt: skip
            self.assertEqual(self.host_arguments(*arguments), arguments)

    def test_render_hands_on_the_exit_code(self):
        self.assertEqual(self.dev("render", "a.obj", HOST_STATUS="3").returncode, 3)

    def test_nothing_is_set_up_twice(self):
        self.dev("render", "a.obj")
        self.assertEqual([c.split()[0] for c in self.calls], ["cmake", "ninja"])
        self.assertTrue(self.calls[1].endswith("pm_host pm_plugin"), self.calls)
        self.dev("render", "a.obj")
        self.assertEqual([c.split()[0] for c in self.calls], ["ninja"])

    def test_render_and_install_build_neither_tests_nor_benches(self):
        program = "cmake --preset release -D PM_BUILD_TESTS=OFF -D PM_BUILD_BENCHMARKS=OFF"
        tests = ("libgtest-dev", "libbenchmark-dev")
        for verb in (["render", "a.obj"], ["install", "--prefix", "p"]):
            self.setUp()
            for turn in range(2):
                done = self.dev(*verb, missing=tests)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual(f"{program} -D CMAKE_UNITY_BUILD=ON" in self.calls, turn == 0, self.calls)
                (ninja,) = (c for c in self.calls if c.startswith("ninja"))
                self.assertTrue(ninja.endswith(" pm_host pm_plugin"), ninja)
                self.assertNotIn("apt-get", " ".join(self.calls))

    def test_files_together_or_not(self):
        for value, option in (("0", " -D CMAKE_UNITY_BUILD=OFF"), ("1", " -D CMAKE_UNITY_BUILD=ON"), ("", "")):
            self.setUp()
            self.dev("test", PM_TOGETHER=value)
            self.assertIn(f"cmake --preset release -D PM_BUILD_TESTS=ON{option}", self.calls)
        self.setUp()
        self.dev("render", "a.obj", PM_TOGETHER="0")
        self.assertTrue(self.calls[0].endswith("CMAKE_UNITY_BUILD=OFF"), self.calls)

    def test_tests_are_configured_after_a_render_and_stay(self):
        self.dev("render", "a.obj")
        self.dev("test", missing=("libgtest-dev",))
        self.assertIn("apt-get install -y --no-install-recommends libgtest-dev", self.calls)
        self.assertIn("cmake --preset release -D PM_BUILD_TESTS=ON", self.calls)
        for verb in ("test", "render"):
            self.dev(verb)
            self.assertNotIn("cmake", " ".join(self.calls))

    def test_presets_that_changed_are_configured_again(self):
        self.dev("test")
        stamp = self.root / "build/release/.configured"
        os.utime(stamp, (0, 0))
        self.dev("test")
        self.assertIn("cmake --preset release -D PM_BUILD_TESTS=ON", self.calls)

    def test_sanitizers_have_builds_of_their_own(self):
        (self.root / "tests").mkdir()
        for name in ("asan", "tsan"):
            done = self.dev("test", f"--{name}", "-R", "x", missing=("clang",))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("apt-get install -y --no-install-recommends clang", self.calls)
            self.assertIn(f"cmake --preset {name} -D PM_BUILD_TESTS=ON", self.calls)
            self.assertIn(f"ctest --test-dir {self.root}/build/{name} ", " ".join(self.calls))
            self.assertTrue(self.calls[-2].endswith("-R x"), self.calls)
        self.assertIn(f"suppressions={self.root}/tests/tsan_suppressions.txt:", self.calls[-1])

    def test_farms_are_tried_with_slurm(self):
        done = self.dev("test", "--farm", "--verbose", missing=("slurmctld", "munge"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("apt-get install -y --no-install-recommends slurmctld munge", self.calls)
        self.assertTrue(any(c.startswith("ninja") and c.endswith(" pm_host pm_plugin pm_test_farm")
                            for c in self.calls), self.calls)
        self.assertIn("-R ^(farm|pm_test_farm)\\. --verbose", " ".join(self.calls))

    def test_missing_packages_as_root(self):
        done = self.dev("setup", missing=("cmake", "libosd-dev"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.calls, ["apt-get -qq update",
                         "apt-get install -y --no-install-recommends cmake libosd-dev"])  # fmt: skip
        self.assertIn("installing 2 missing packages: cmake libosd-dev", done.stderr)
        self.assertNotIn("noise", done.stdout + done.stderr)

    def test_missing_packages_through_sudo_without_a_terminal(self):
        done = self.dev("setup", missing=("cmake",), USER_ID="1000", SUDO_WORKS="1")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(self.calls[0].startswith("sudo -n "), self.calls)
        self.assertIn("apt-get install -y --no-install-recommends cmake", self.calls)

    def test_the_line_to_type_when_sudo_or_apt_fails(self):
        for variables in ({"USER_ID": "1000"}, {"APT_STATUS": "100"}):
            done = self.dev("render", "a.obj", missing=("cmake", "g++"), **variables)
            self.assertEqual((done.returncode, done.stdout), (1, ""))
            self.assertIn("\napt-get update && apt-get install -y --no-install-recommends g++ cmake\n",
                          done.stderr)  # fmt: skip
            self.assertNotIn("ninja", " ".join(self.calls))
        self.assertIn("E: the text of apt", done.stderr)

    def test_a_failing_build_renders_nothing(self):
        done = self.dev("render", "a.obj", NINJA_STATUS="1")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("ninja speaks", done.stderr)

    def test_test_keeps_the_closing_line(self):
        done = self.dev("test", "-R", "x")
        self.assertEqual(done.stdout, "100% tests passed, 0 tests failed out of 3\n")
        self.assertIn("--output-on-failure --no-tests=error", self.calls[-2])
        self.assertTrue(self.calls[-2].endswith("-R x"))


    def named(self, *arguments):
        """ninja's and ctest's calls for tests of these names."""
        (self.root / "tests/run").mkdir(parents=True, exist_ok=True)
        shutil.copy(DEV.parent / "tests/run/named_tests.py", self.root / "tests/run")
        (self.root / "build/release/tests").mkdir(exist_ok=True)
        (self.root / "build/release/tests/programs.txt").write_text("house.docs_test;pm_host pm_plugin;;\n")
        done = self.dev("test", *arguments)
        return done, [c for c in self.calls if c.startswith(("ninja", "ctest"))]

    def test_named_tests_alone_are_built_and_run(self):
        done, (ninja, ctest) = self.named("docs_test", "-V")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(ninja.endswith(" pm_host pm_plugin"), ninja)
        self.assertTrue(ctest.endswith(r" -R ^house\.docs_test$ -V"), ctest)

    def test_a_name_of_no_test_builds_nothing(self):
        done, calls = self.named("dosc_test")
        self.assertEqual((done.returncode, calls), (1, []))
        self.assertIn("no test is called 'dosc_test'", done.stderr)

    def test_fast_tests_alone(self):
        _, (ninja, ctest) = self.named("--fast")
        self.assertTrue(ninja.endswith(" pm_fast_tests"), ninja)
        self.assertIn(" -L ^fast$", ctest)

    def test_all_tests_without_a_name(self):
        _, (ninja, ctest) = self.named()
        self.assertTrue(ninja.endswith(" pm_tests"), ninja)
        self.assertNotIn(" -R ", ctest)


if __name__ == "__main__":
    unittest.main()
