#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""pm_host farm without a cluster: commands for any farm manager, and GNU parallel on this machine.

usage: farm_test.py PM_HOST [TEST...]
"""
import json
import os
import pathlib
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

from cluster import environment, wait_for
from job import SCENE, Farm, Job, children, is_alive

OPTIONS = ("--size", "64x48", "--bucket-size", "8", "--passes", "2", "--photons", "3000", "--aa", "2")
ALL = os.environ.get("PM_FARM") == "all"
needs_parallel = unittest.skipIf(shutil.which("parallel") is None, "GNU parallel is not installed")


class Farms(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="pm farm ", ignore_cleanup_errors=True)
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.variables = environment(XDG_CACHE_HOME=str(self.folder / "cache"))

    def host(self, *words, code=0):
        done = subprocess.run([HOST, *words], cwd=self.folder, env=self.variables, capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def local(self, *more, options=OPTIONS):
        self.host(SCENE, *options, "-o", "local.exr", "-o", "local.png", "-q", *more)
        return (self.folder / "local.exr").read_bytes(), (self.folder / "local.png").read_bytes()

    def farm(self, engine, *more, options=OPTIONS, **names):
        farm = Farm(HOST, self.folder, self.variables, engine, [*options, *more], **names)
        self.addCleanup(lambda: farm.process and farm.process.poll() is None and farm.process.kill())
        return farm

    def assert_same_bytes(self, farm, pictures):
        self.assertEqual(farm.start().wait(), 0, farm.said())
        # Not assertEqual, which takes minutes to tell where they differ.
        self.assertTrue((farm.output.read_bytes(), (self.folder / "farm.png").read_bytes()) == pictures, farm.said())

    def test_commands_make_the_bytes_of_a_local_render(self):
        farm = self.farm("commands", "--runs", "3", "-o", "farm.png")
        self.assertEqual(farm.start().wait(), 0, farm.said())
        lines = farm.printed.splitlines()
        self.assertEqual([line for line in lines if line.startswith("#")],
                         ["# stage 1: photons", "# stage 2: runs of buckets", "# stage 3: pictures"])
        commands = [line for line in lines if not line.startswith("#")]
        self.assertEqual(len(commands), 1 + 3 + 1)
        self.assertEqual(farm.job.attempts(), [], "nothing is started")
        self.assertIn("4 tasks for machines that aren't known yet, instruction set ", farm.said())
        for command in commands:  # in any folder
            subprocess.run(command, shell=True, check=True, env=self.variables, capture_output=True)
        self.assertTrue((farm.output.read_bytes(), (self.folder / "farm.png").read_bytes()) == self.local())
        # The list is the same again, and the plan holds no other picture.
        again = self.farm("commands", "--runs", "3", "-o", "farm.png")
        self.assertEqual(again.start().wait(), 0, again.said())
        self.assertEqual(again.printed.splitlines(), lines)
        other = self.farm("commands", "--runs", "3", "-o", "farm.png", "--seed", "5")
        self.assertEqual(other.start().wait(), 2)
        self.assertIn("--seed: not given there, 5 here", other.said())

    ODD = "a{}b v{1} {=$_=9=} {#}{%} 'q\" #2 %d %j \\ $HOME `id` ï<é>"

    def odd_scene(self):
        """A scene whose name and folder look like patterns of all kinds."""
        folder = self.folder / self.ODD
        folder.mkdir()
        for file in SCENE.parent.iterdir():
            shutil.copy(file, folder)
        return (folder / SCENE.name).rename(folder / "part #2 {} %04d.obj")

    @needs_parallel
    def test_names_are_no_patterns(self):
        scene = self.odd_scene()
        small = ("--size", "16x16", "--bucket-size", "8", "--passes", "1", "--photons", "500", "-q")
        self.host(str(scene), *small, "-o", "local.exr")
        job = self.folder / ("job " + self.ODD)
        name = scene.stem + ".exr"  # in the working folder
        self.host("farm", str(scene), *small, "--engine", "parallel", "--job", str(job), "--runs", "2")
        self.assertTrue((self.folder / name).read_bytes() == (self.folder / "local.exr").read_bytes())
        self.assertEqual(len(list((job / "parts").iterdir())), 2)
        self.assertEqual([a.code for a in Job(job).attempts()], [0] * 3)
        broken = self.host("farm", str(scene), *small, "--engine", "parallel", "--job", "a\nb", code=2)
        self.assertIn("line break", broken.stderr)

    def test_sbatch_gets_the_path_of_its_log(self):
        """As its page tells: %% for %, but where there is a backslash nothing is filled in, and it is dropped."""
        fake = self.folder / "bin"
        fake.mkdir()
        for program in ("sinfo", "srun"):
            (fake / program).write_text("#!/bin/sh\n")
            (fake / program).chmod(0o755)
        self.variables["PATH"] = f"{fake}:{self.variables['PATH']}"
        for job, written in (("%j %A#", "%%j %%A#"), ("%j\\a", "%j\\\\a"), ("plain", "plain")):
            done = self.host("farm", str(SCENE), *OPTIONS, "--engine", "slurm", "--job", job, "--runs", "2",
                             "--dry-run", "-o", "dry.exr")
            wanted = f"--output={self.folder}/{written}/logs/slurm.log"
            lines = [shlex.split(line) for line in done.stdout.splitlines() if line.startswith("sbatch")]
            self.assertTrue(lines and all(wanted in words for words in lines), done.stdout)

    @needs_parallel
    def test_each_run_may_trace_its_photons(self):
        farm = self.farm("parallel", "--runs", "3", "--photons-each", "-o", "farm.png")
        self.assert_same_bytes(farm, self.local())
        self.assertEqual([a.code for a in farm.job.attempts()], [0] * 3)
        self.assertEqual(list(farm.job.folder.rglob("*.pmphotons")), [])
        once = self.farm("parallel", "--runs", "3", "-o", "farm.png")
        self.assertEqual(once.start().wait(), 2, "another plan")
        self.assertIn("--photons-each", once.said())

    def test_runs_cost_about_the_same(self):
        farm = self.farm("commands", "--runs", "4")
        farm.start().wait()
        runs = [task for task in json.loads((farm.job.folder / "plan.json").read_text())["tasks"]
                if task["kind"] == "run"]
        self.assertEqual([run["firstBucket"] for run in runs[1:]], [run["lastBucket"] for run in runs[:-1]])
        self.assertEqual((runs[0]["firstBucket"], runs[-1]["lastBucket"]), (0, 48))
        costs = [run["predictedThreadSeconds"] for run in runs]
        self.assertLess(max(costs), 2 * sum(costs) / len(costs), costs)

    def test_dry_run_does_nothing(self):
        farm = self.farm("commands", "--runs", "2", "--dry-run")
        self.assertEqual(farm.start().wait(), 0, farm.said())
        self.assertIn("thread-seconds predicted", farm.printed)
        self.assertIn("--photon-map" if "photons" not in farm.printed else "photons", farm.printed)
        self.assertFalse(farm.job.folder.exists())
        self.assertFalse(farm.output.exists())

    def test_paths_have_no_photons(self):
        farm = self.farm("commands", "--runs", "2", "--integrator", "path")
        self.assertEqual(farm.start().wait(), 0, farm.said())
        self.assertNotIn("photons", farm.printed)

    def test_what_is_wrong_is_said_before_anything_begins(self):
        for words, code, text in (((), 2, "no SCENE"), (("--size", "x"), 2, "--size"),
                                  (("--isa", "z80"), 2, "--isa"), (("-o", "no/a.exr"), 4, "no")):
            scene = (SCENE,) if words else ()
            done = self.host("farm", *scene, *words, "--engine", "commands", "--job", "j", code=code)
            self.assertIn(text, done.stderr)
        bad = self.folder / "bad.obj"
        bad.write_text("v 0 0 0\nv 1 0 0\nf 1 2 9\n")
        done = self.host("farm", bad, "--engine", "commands", "--job", "j", code=3)
        self.assertIn("bad.obj:3", done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 2, done.stderr)

    @needs_parallel
    def test_parallel_makes_the_bytes_of_a_local_render(self):
        pictures = self.local()
        farm = self.farm("parallel", "--runs", "3", "-o", "farm.png", "--progress", "json")
        self.assert_same_bytes(farm, pictures)
        self.assertEqual([a.code for a in farm.job.attempts()], [0] * 4)
        progress = [json.loads(line)["progress"] for line in farm.said().splitlines() if line.startswith("{")]
        self.assertEqual(progress, sorted(progress))
        self.assertEqual(progress[-1], 1)
        # Once more: nothing is left to do but the pictures; a part that is missing is made again.
        farm.output.unlink()
        self.assert_same_bytes(farm, pictures)
        self.assertEqual(len(farm.job.attempts()), 4)
        farm.job.parts()[1].unlink()
        data = bytearray(farm.job.parts()[0].read_bytes())
        data[-5] ^= 1
        farm.job.parts()[0].write_bytes(data)
        self.assert_same_bytes(farm, pictures)
        self.assertEqual(sorted(a.task for a in farm.job.attempts()), [1, 2, 2, 3, 3, 4])
        self.assertIn("it is made again", farm.said())
        self.assertIn("<rect", (farm.job.folder / "farm.html").read_text())

    @needs_parallel
    def test_what_fails_anywhere_is_tried_once(self):
        scene = self.folder / "s.obj"
        for name in ("cornell_box.obj", "cornell_box.mtl"):
            shutil.copy(SCENE.parent / name, self.folder / name.replace("cornell_box.obj", "s.obj"))
        words = ["farm", scene, *OPTIONS, "--runs", "2", "--job", "j", "-o", "a.exr", "-q"]
        self.host(*words, "--engine", "commands")
        scene.write_text(scene.read_text().replace("v ", "w ", 1))
        done = self.host(*words, "--engine", "parallel", code=3)
        self.assertIn("task 1 (photons): exit 3", done.stderr)
        self.assertEqual([a.code for a in Job(self.folder / "j").attempts() if a.task == 1], [3])

    @needs_parallel
    def test_signals_end_all(self):
        long = ("--size", "256x192", "--passes", "64", "--photons", "20000", "--aa", "3")
        for number in (signal.SIGINT, signal.SIGTERM):
            farm = self.farm("parallel", "--runs", "3", options=long, name=f"job {number}").start()
            victim = farm.job.wait_for_run()
            wait_for(lambda: len(children(victim.process)) > 1, "pm_host")
            below = children(victim.process)
            other = self.farm("parallel", "--runs", "3", options=long, name=f"job {number}")
            other.errors = self.folder / "other.err"
            self.assertEqual(other.start().wait(), 4)
            self.assertIn("another pm_host farm", other.said())
            farm.process.send_signal(number)
            self.assertEqual(farm.wait(), 128 + number)
            wait_for(lambda: not any(map(is_alive, below)), "all that it started to end", 20)
            self.assertFalse(farm.output.exists())

    @needs_parallel
    def test_frames(self):
        for frame in ("0001", "0003"):
            shutil.copy(SCENE, self.folder / f"s.{frame}.obj")
        shutil.copy(SCENE.parent / "cornell_box.mtl", self.folder)
        words = ("s.####.obj", *OPTIONS, "--frames", "1-4x2", "--seed", "frame", "-q")
        self.host(*words, "-o", "l.####.exr")
        self.host("farm", *words, "-o", "f.%04d.exr", "--engine", "parallel", "--job", "j", "--runs", "2")
        self.host("s.####.obj", *OPTIONS, "--frame", "3", "--seed", "frame", "-q", "-o", "one.exr")
        read = lambda name: (self.folder / name).read_bytes()
        self.assertEqual(read("l.0003.exr"), read("one.exr"))
        self.assertNotEqual(read("l.0001.exr"), read("l.0003.exr"))
        for frame in ("0001", "0003"):
            self.assertEqual(read(f"l.{frame}.exr"), read(f"f.{frame}.exr"))
        self.assertFalse((self.folder / "l.0002.exr").exists())

    # That of its first frame, of which a single task finds the same as a whole render.
    @needs_parallel
    def test_a_shot_is_of_one_error_scale(self):
        materials = (SCENE.parent / "cornell_box.mtl").read_text()
        for frame, factor in ((1, 1e-3), (2, 1e-1)):
            light = f"Ke {17 * factor} {12 * factor} {4 * factor}"
            (self.folder / f"s.{frame}.mtl").write_text(materials.replace("Ke 17 12 4", light))
            scene = SCENE.read_text().replace("cornell_box.mtl", f"s.{frame}.mtl")
            (self.folder / f"s.000{frame}.obj").write_text(scene)
        words = ("s.####.obj", *OPTIONS, "--frames", "1-2", "-q")
        self.host(*words, "-o", "l.####.exr", "--stats", "l.####.json")
        scales = [json.loads((self.folder / f"l.000{frame}.json").read_text())["errorScaleStops"] for frame in (1, 2)]
        self.assertEqual(scales[0], scales[1])
        self.assertGreater(scales[0], 8)
        self.host("farm", *words, "-o", "f.%04d.exr", "--engine", "parallel", "--job", "j", "--runs", "2")
        for frame in ("0001", "0002"):
            read = lambda name: (self.folder / name).read_bytes()
            self.assertEqual(read(f"l.{frame}.exr"), read(f"f.{frame}.exr"))

    def test_frames_that_fail_do_not_end_the_others(self):
        shutil.copy(SCENE, self.folder / "s.0002.obj")
        shutil.copy(SCENE.parent / "cornell_box.mtl", self.folder)
        self.host("s.####.obj", *OPTIONS, "--frames", "1-2", "-o", "l.####.exr", "-q", code=4)
        self.assertTrue((self.folder / "l.0002.exr").exists())
        self.host("s.####.obj", *OPTIONS, "--frames", "1-2", "-o", "l.exr", "-q", code=2)


if __name__ == "__main__":
    HOST = pathlib.Path(sys.argv.pop(1)).resolve()
    result = unittest.main(exit=False, verbosity=2).result
    sys.exit(0 if result.wasSuccessful() and not (ALL and result.skipped) else 1)
