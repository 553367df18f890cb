#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""What pm_host check finds in renders of another build, and that it finds nothing where nothing is.

usage: found_test.py PM_HOST [--write FILE.md]

Three scenes with a lamp of -5 %, a white wall of +2 % and roughness .25 to .3: found each time. 200 pictures of other
seeds and 50 twins: none is found by pairs. --write: instead, from what change of lamps and of walls on each scene of
scenes/regression is found, as a table.
"""
import argparse
import json
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("cornell_box", "caustic_glass", "water_basin", "regression")
SCENES = {"cornell_box": [], "glossy": ["--aa", "2"], "caustic_glass": ["--aa", "2"]}
SEEDS, TWINS = 201, 51  # pictures
SIZES = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20)  # per cent


class Suites:
    def __init__(self, host, folder):
        self.host, self.folder = host, folder
        for name in FOLDERS:
            shutil.copytree(ROOT / "scenes" / name, folder / name)
        self.libraries = {file: file.read_text() for file in folder.glob("*/*.mtl")}

    def run(self, suite, *more):
        done = subprocess.run([self.host, "check", suite, "--jobs", "2", *more], capture_output=True, text=True)
        assert done.returncode in (0, 6), done.stdout + done.stderr
        return done.stdout

    def plant(self, change):
        """Writes the libraries anew, changed line by line; change gets the material's name and the line."""
        for file, text in self.libraries.items():
            material, lines = "", []
            for line in text.splitlines():
                material = line.split()[1] if line.startswith("newmtl ") else material
                lines.append(change(material, line))
            file.write_text("\n".join(lines) + "\n")

    def keep(self, change):
        self.plant(change)
        self.libraries = {file: file.read_text() for file in self.libraries}


def another_build(picture):
    """The picture, as if another build had rendered it."""
    data = bytearray(picture.read_bytes())
    at = data.index(b"pm:build\0string\0") + len(b"pm:build\0string\0")
    length, = struct.unpack_from("<i", data, at)
    data[at + 4:at + 4 + length] = b"x" * length
    picture.write_bytes(data)


def scaled(key, factor, only=None):
    def change(material, line):
        words = line.split()
        if not words or words[0] != key or (only and material != only):
            return line
        return " ".join([key] + [f"{min(float(word) * factor, 1e9 if key == 'Ke' else 1):.9g}" for word in words[1:]])
    return change


def polished(material, line):
    if material == "white" and line.startswith("illum"):
        return "illum 2\nKs 0.3 0.3 0.3\nPr 0.25"
    return line


def suite_of(options):
    scenes = [{"name": name, "scene": f"{'regression' if name == 'glossy' else name}/{name}.obj",
               "options": own + options} for name, own in SCENES.items()]
    return json.dumps({"schema": "pm-suite/1", "options": ["--size", "48x32", "--passes", "8"], "scenes": scenes})


def found(text, measure=r"\w[\w ]*"):
    """Names of scenes with such a finding."""
    names, name = set(), None
    for line in text.splitlines():
        scene = re.match(r"(\w+): ", line)
        name = scene[1] if scene else name
        if re.match(rf"    (?:{measure}): (?!.*--jobs)", line) and not line.startswith(("    note", "    warning", "    COARSE")):
            names.add(name)
    return names


def hold(suites):
    suite = suites.folder / "suite.json"
    suite.write_text(suite_of([]))
    suites.keep(polished)
    print(suites.run(suite, "--update", "--because", "The first."))
    for name in SCENES:
        another_build(suites.folder / "references" / f"{name}.exr")
    for what, change in (("a lamp of -5 %", scaled("Ke", 0.95)), ("a wall of +2 %", scaled("Kd", 1.02, "white")),
                         ("roughness .25 to .3", scaled("Pr", 1.2))):
        suites.plant(change)
        text = suites.run(suite)
        print(what, text, sep="\n")
        assert found(text, "pair") == set(SCENES), (what, text)
    suites.plant(lambda material, line: line)
    for i in range(SEEDS // len(SCENES)):
        text = suites.run(suite, "--seed", str(5000 + i))
        assert not found(text), text
        assert text.count("note: the noise is not the reference's") == len(SCENES), text
    furthest = 0
    for i in range(TWINS // len(SCENES)):
        suite.write_text(suite_of(["--twin", str(100 + i)]))
        text = suites.run(suite)
        assert not found(text) and "the noise is not" not in text, text
        furthest = max([furthest] + [int(share) for share in re.findall(r"at (\d+) % of its limit", text)])
    print(f"{SEEDS} pictures of other seeds and {TWINS} twins: none found; twins come to {furthest} % of the limit")


def table(suites, file):
    suite = suites.folder / "regression" / "suite.json"
    names = [scene["name"] for scene in json.loads(suite.read_text())["scenes"]]
    for name in names:
        another_build(suite.parent / "references" / f"{name}.exr")
    least = {}
    for what, key, sign in (("lamp", "Ke", -1), ("wall", "Kd", 1)):
        for size in SIZES:
            suites.plant(scaled(key, 1 + sign * size / 100))
            for name in found(suites.run(suite)):
                least.setdefault((name, what), size)
    lines = ["# What the regression suite finds", "",
             "Of each scene of [scenes/regression](../../scenes/regression/README.md) the smallest change that is found in a",
             f"render of another build, of {', '.join(f'{size:g}' for size in SIZES)} %: all lamps darker, all diffuse",
             "reflectances higher. Renders of one build find any change, as another input. `tests/check/found_test.py --write`",
             "makes this page.", "", "| scene | lamps | walls |", "|---|---|---|"]
    shown = lambda name, what: f"{least[name, what]:g} %" if (name, what) in least else "none"
    lines += [f"| {name} | {shown(name, 'lamp')} | {shown(name, 'wall')} |" for name in names]
    file.write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("host", type=pathlib.Path)
    parser.add_argument("--write", type=pathlib.Path, metavar="FILE.md")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        suites = Suites(arguments.host.resolve(), pathlib.Path(folder))
        if arguments.write:
            table(suites, arguments.write)
        else:
            hold(suites)


if __name__ == "__main__":
    sys.exit(main())
