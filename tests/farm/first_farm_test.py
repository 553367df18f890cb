#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""The first farm of docs/farm.md, word for word: its lines are run as they are, and end with the bytes of a
local render.

usage: first_farm_test.py PM_HOST
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

from cluster import environment, missing_programs, wait_for
from job import ROOT, SCENE, Job, is_alive

ALL = os.environ.get("PM_FARM") == "all"


def script():
    text = (ROOT / "docs" / "farm.md").read_text(encoding="utf-8")
    return re.search(r"^## The first picture.*?```sh\n(.*?)```", text, re.DOTALL | re.MULTILINE).group(1)


class FirstFarm(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="pm_home.", ignore_cleanup_errors=True)
        self.addCleanup(folder.cleanup)
        self.home = pathlib.Path(folder.name)
        path = f"{HOST.parent}:{os.environ['PATH']}"
        self.variables = dict(environment(HOME=str(self.home), XDG_CACHE_HOME=str(self.home / "cache")), PATH=path)
        self.addCleanup(self.end_all)

    def processes(self):
        """Of the farm, by their files."""
        return [int(file.read_text()) for file in (self.home / "pm_farm").glob("*.pid") if file.read_text().strip()]

    def end_all(self):
        ours = self.processes()
        subprocess.run(["sh", "-c", "kill $(cat *.pid)"], cwd=self.home / "pm_farm", capture_output=True)
        wait_for(lambda: not any(map(is_alive, ours)), "the farm's end", 30)

    def test_its_lines_make_a_picture(self):
        done = subprocess.run(["bash", "-e", "-c", script()], cwd=ROOT, env=self.variables, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(self.processes()), 4, "munged, slurmctld and two slurmd")
        folder = self.home / "pm_farm"
        subprocess.run([HOST, SCENE, "--size", "640x480", "-o", "local.exr", "-o", "local.png", "-q"], cwd=self.home,
                       env=self.variables, check=True)
        for suffix in ("exr", "png"):
            self.assertTrue((folder / f"box.{suffix}").read_bytes() == (self.home / f"local.{suffix}").read_bytes())
        attempts = Job(folder / "job").attempts()
        self.assertEqual({a.machine for a in attempts if a.code == 0}, {"n1", "n2"})
        self.assertTrue((folder / "job" / "farm.html").exists())


if __name__ == "__main__":
    HOST = pathlib.Path(sys.argv.pop(1)).resolve()
    if missing_programs():
        print("not tried: Slurm is not installed: " + " ".join(missing_programs()))
        sys.exit(1 if ALL else 77)
    unittest.main(verbosity=2)
