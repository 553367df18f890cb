#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""pm_host watch: parts that come one by one, half written, damaged, of another picture, of a farm.

usage: watch_test.py PM_HOST [TEST...]
"""
import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = ROOT / "scenes" / "cornell_box" / "cornell_box.obj"
OPTIONS = ("--size", "40x32", "--bucket-size", "8", "--passes", "1", "--photons", "2000", "-q")
PARTS = 4


def wait_for(condition, what, seconds=60):
    end = time.monotonic() + seconds
    while not (value := condition()):
        if time.monotonic() > end:
            raise AssertionError(f"waited in vain for: {what}")
        time.sleep(0.02)
    return value


class Watches(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.made = pathlib.Path(tempfile.mkdtemp(prefix="pm watch "))
        cls.addClassCleanup(shutil.rmtree, cls.made, ignore_errors=True)
        cls.variables = {**os.environ, "XDG_CACHE_HOME": str(cls.made / "cache")}
        cls.variables.pop("OCIO", None)
        for part in range(1, PARTS + 1):
            cls.host(SCENE, *OPTIONS, "--buckets", f"{part}/{PARTS}", "-o", f"p{part}.pmpart")
        cls.host(SCENE, *OPTIONS, "--seed", "9", "--buckets", f"1/{PARTS}", "-o", "other.pmpart")
        parts = [cls.made / f"p{part}.pmpart" for part in range(1, PARTS + 1)]
        cls.host("merge", *parts, "-o", "whole.exr", "-o", "whole.png", "-q")

    @classmethod
    def host(cls, *words, code=0):
        done = subprocess.run([HOST, *map(str, words)], cwd=cls.made, env=cls.variables, capture_output=True,
                              text=True, timeout=120)
        assert done.returncode == code, done.stderr
        return done

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="pm watch ", ignore_cleanup_errors=True)
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.parts = self.folder / "parts"
        self.parts.mkdir()
        self.page = self.folder / "page.html"
        self.picture = self.folder / "picture.exr"

    def watch(self, *what, more=()):
        with open(self.folder / "said", "w") as said:
            self.process = subprocess.Popen(
                [HOST, "watch", *map(str, what), "-o", self.picture, "-o", self.folder / "picture.png",
                 "--page", self.page, "--interval", "0.05", *more],
                cwd=self.folder, env=self.variables, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said)
        self.addCleanup(self.process.wait)
        self.addCleanup(self.process.kill)

    def said(self):
        return (self.folder / "said").read_text()

    def put(self, part, name=None):
        """As a render does: beside it, then under its name."""
        temporary = self.parts / "x.tmp"
        shutil.copy(self.made / f"p{part}.pmpart", temporary)
        temporary.rename(self.parts / (name or f"p{part}.pmpart"))

    def shows(self, text):
        def look():
            if self.process.poll() not in (None, 0):
                raise AssertionError(self.said())
            return self.page.exists() and text in self.page.read_text()
        wait_for(look, f"{text} in the page; {self.said()}")

    def is_complete(self):
        """pm:complete of the picture that is there."""
        content = self.picture.read_bytes()
        at = content.index(b"pm:complete\0int\0") + len(b"pm:complete\0int\0") + 4
        return struct.unpack_from("<i", content, at)[0]

    def assert_whole(self):
        self.assertEqual(self.process.wait(60), 0, self.said())
        for ending in ("exr", "png"):
            self.assertEqual((self.folder / f"picture.{ending}").read_bytes(),
                             (self.made / f"whole.{ending}").read_bytes())
        text = self.page.read_text()
        self.assertIn("20 of 20 buckets are there (100.0%)", text)
        self.assertNotIn('http-equiv="refresh"', text)
        xml.etree.ElementTree.fromstring(text.replace("<!DOCTYPE html>", ""))

    def test_parts_come_one_by_one_into_a_folder(self):
        self.watch(self.parts)
        self.shows("No part is there yet")
        self.assertFalse(self.picture.exists())
        for count, part in enumerate((3, 1, 4), 1):
            self.put(part)
            self.shows(f"{5 * count} of 20 buckets are there")
            self.assertEqual(self.is_complete(), 0)
            self.assertIn('http-equiv="refresh"', self.page.read_text())
        self.assertIsNone(self.process.poll())
        self.assertNotEqual(self.picture.read_bytes(), (self.made / "whole.exr").read_bytes())
        self.put(2)
        self.assert_whole()

    def test_all_are_there(self):
        for part in range(1, PARTS + 1):
            self.put(part)
        self.watch(*(self.parts / f"p{part}.pmpart" for part in range(1, PARTS + 1)))
        self.assert_whole()

    def test_half_written_part_is_told_once_and_taken_when_it_is_whole(self):
        self.watch(self.parts)
        content = (self.made / "p2.pmpart").read_bytes()
        growing = self.parts / "p2.pmpart"
        growing.write_bytes(content[: len(content) // 2])
        self.put(1)
        self.shows("left out till it changes")
        self.shows("5 of 20 buckets are there")
        time.sleep(0.3)
        self.assertEqual(self.said().count("cut short"), 1, self.said())
        growing.write_bytes(content)
        self.shows("10 of 20 buckets are there")
        self.put(3)
        self.put(4)
        self.assert_whole()

    def test_damaged_part_and_part_of_another_picture(self):
        self.put(1)
        self.watch(self.parts)
        self.shows("5 of 20 buckets are there")
        content = bytearray((self.made / "p2.pmpart").read_bytes())
        content[len(content) // 2] ^= 1
        (self.parts / "p2.pmpart").write_bytes(content)
        shutil.copy(self.made / "other.pmpart", self.parts / "p3.pmpart")
        self.shows("differs in: ")
        self.put(4)
        self.shows("10 of 20 buckets are there")
        self.put(2)
        self.put(3)
        self.assert_whole()

    def test_same_buckets_twice(self):
        self.put(1)
        self.put(1, "again.pmpart")
        self.watch(self.parts)
        self.shows("5 of 20 buckets are there")
        for part in (2, 3, 4):
            self.put(part)
        self.assert_whole()
        self.assertIn("in, 0 buckets", self.page.read_text())

    def test_interrupt_leaves_the_last_picture(self):
        self.put(1)
        self.watch(self.parts)
        self.shows("5 of 20 buckets are there")
        self.process.send_signal(signal.SIGINT)
        self.assertEqual(self.process.wait(20), 130)
        self.assertEqual(self.is_complete(), 0)
        self.assertEqual([file.name for file in self.folder.iterdir() if ".tmp." in file.name], [])

    def test_farm_with_its_machines(self):
        job = self.folder / "job"
        self.watch("--job", job)
        self.shows("No part is there yet")
        printed = self.host("farm", SCENE, *OPTIONS, "--engine", "commands", "--job", job, "--runs", "3",
                            "-o", self.folder / "picture.exr").stdout
        self.shows("3 are awaited")
        commands = [line for line in printed.splitlines() if line.startswith("sh ")]
        for number, command in enumerate(commands):
            machine = f"machine{number % 2}"
            subprocess.run(command, shell=True, check=True, env={**self.variables, "SLURMD_NODENAME": machine},
                           capture_output=True)
        self.assert_whole()
        text = self.page.read_text()
        counts = dict(re.findall(r"</span> (machine\d)</td>\s*<td>(\d+)</td>", text))
        self.assertEqual(sum(map(int, counts.values())), 20, counts)
        self.assertEqual(len(counts), 2)

    def test_usage(self):
        for words in ((), ("-o", "x.exr"), (self.parts,), (self.parts, "-o", "x.pmpart"),
                      (self.parts, "--job", "j", "-o", "x.exr"), (self.parts, "-o", "x.exr", "--page", "x.txt"),
                      (self.parts, "-o", "x.exr", "--interval", "0")):
            self.host("watch", *words, code=2)


if __name__ == "__main__":
    HOST = os.path.abspath(sys.argv.pop(1))
    unittest.main()
