#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""How much somebody has to touch who adds a kind of shape, lobe, light, camera, texture, path, reader or writer.

Each folder of kinds/ adds one: its new files, by their places, and existing.patch, what changes in
files that are there. At most three of these, CMake's lists, the C header and docs not counted. With
PM_OPEN_SETS=1 in the environment all are added to a copy of the sources, which is built; probe.cpp
and pm_host then render with them, and what comes out is compared with what it has to be. That takes
some ten minutes: without, the files are counted, the patches applied and the rules of the house
asked, no more.

usage: open_sets_test.py
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
KINDS = sorted(p for p in (HERE / "kinds").iterdir() if p.is_dir())
MOST_TOUCHED = 3
NOT_COUNTED = re.compile(r"(?:^|/)CMakeLists\.txt$|^plugin/include/|^docs/")
TARGETS = {"integrator/": "pm_integrator", "plugin/": "pm_plugin", "host_shim/formats/": "pm_host_formats",
           "host_shim/pictures/": "pm_host_pictures"}  # fmt: skip
BUILD = ["cmake", "--preset", "release", "-DCMAKE_UNITY_BUILD=ON", "-DPM_BUILD_TESTS=OFF", "-DPM_BUILD_BENCHMARKS=OFF"]


def new_files(kind):
    """Paths in the repository of the files that a kind adds."""
    return [p.relative_to(kind) for p in sorted(kind.rglob("*")) if p.is_file() and p.parent != kind]


def touched(kind):
    """Existing files that a kind changes."""
    return re.findall(r"^diff --git a/(\S+)", (kind / "existing.patch").read_text(encoding="utf-8"), re.M)


def run(command, folder):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}")
    return done.stdout


def copy_of_sources(folder):
    """What git knows of, and what is new: a repository of its own, without history."""
    names = run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], ROOT).split("\0")
    for name in filter(None, names):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
    run(["git", "init", "-q"], folder)


def add(kind, folder):
    for name in new_files(kind):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(kind / name, folder / name)
    run(["git", "apply", "--recount", "-C1", kind / "existing.patch"], folder)
    for name in new_files(kind):
        if name.suffix == ".cpp":
            target = next(value for start, value in TARGETS.items() if str(name).startswith(start))
            lists = next(p for p in (folder / name).parents if (p / "CMakeLists.txt").is_file())
            with open(lists / "CMakeLists.txt", "a", encoding="utf-8") as text:
                text.write(f"target_sources({target} PRIVATE {(folder / name).relative_to(lists)})\n")


class OpenSets(unittest.TestCase):
    def test_each_kind_touches_few_files(self):
        self.assertEqual([k.name for k in KINDS], ["camera", "light", "lobe", "policy", "reader", "shape", "texture", "writer"])
        for kind in KINDS:
            with self.subTest(kind=kind.name):
                counted = [name for name in touched(kind) if not NOT_COUNTED.search(name)]
                self.assertTrue(new_files(kind))
                self.assertLessEqual(len(counted), MOST_TOUCHED, counted)
                print(f"{kind.name}: {len(new_files(kind))} new, {len(counted)} touched: {', '.join(counted)}")

    def test_patches_apply(self):
        with tempfile.TemporaryDirectory() as name:
            copy_of_sources(pathlib.Path(name))
            for kind in KINDS:
                add(kind, pathlib.Path(name))
            print(run([sys.executable, "-B", "tests/house/house_rules.py"], name))

    @unittest.skipUnless(os.environ.get("PM_OPEN_SETS"), "takes ten minutes; PM_OPEN_SETS=1 runs it")
    def test_what_was_added_renders(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            copy_of_sources(folder)
            for kind in KINDS:
                add(kind, folder)
            run(BUILD, folder)
            build = folder / "build" / "release"
            run(["cmake", "--build", build, "--target", "pm_host", "pm_plugin", "-j", "2"], folder)
            probe = folder / "probe"
            run(["c++", "-std=c++20", "-O1", f"-I{folder}/plugin/include", HERE / "probe.cpp", "-o", probe, "-ldl"],
                folder)
            print(run([probe, build / "bin" / "libpm_plugin.so"], folder))
            self.render_with_host(folder, build / "bin" / "pm_host")

    def render_with_host(self, folder, host):
        """By the new reader, to the new writer's format."""
        shutil.copy2(HERE / "triangles.tri", folder / "scene.tri")
        run([host, "scene.tri", "--size", "32x24", "--passes", "1", "-o", "out.exr", "-o", "out.pfm"], folder)
        head, size, scale, pixels = (folder / "out.pfm").read_bytes().split(b"\n", 3)
        self.assertEqual((head, size, scale), (b"PF", b"32 24", b"-1.0"))
        self.assertEqual(len(pixels), 32 * 24 * 3 * 4)
        self.assertTrue(any(pixels))


if __name__ == "__main__":
    if sys.argv[1:]:
        sys.exit(__doc__)
    unittest.main()
