#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""What a user gets who says nothing but the size: of each scene no more than 60 % of the pixels are nearly black
(all three codes below 8) or burnt out (above 250), unless a line says why.

usage: first_looks.py [--all] [--write] [--keep FOLDER] [--only NAME] PM_HOST

Few looks in small; --all: twenty, ten of ../shared/data and ten of our own making. --write: all of them, and the
sheet docs/images/first_looks.png and its table in docs/first_look.md are made anew. --keep: pictures and logs
stay there.
"""
import argparse
import pathlib
import re
import subprocess
import sys
import tempfile

import look_scenes
from plain_png import read_rows, write_rows

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = ROOT.parent / "shared" / "data"
PAGE = ROOT / "docs" / "first_look.md"
SHEET = ROOT / "docs" / "images" / "first_looks.png"
MOST = 0.6
COLUMNS = 5
# What is there to be seen, and a word that a line has to have, or none.
SHARED = {
    "obj-models/mcguire-teapot/teapot.obj": "a teapot, from the front",
    "obj-models/spot/spot_quadrangulated.obj": "a cow",
    "obj-models/mcguire-cube/cube.obj": "a cube with a picture on its sides",
    "obj-gi/mcguire-cornell/CornellBox-Sphere.obj": "a box with a mirror ball and one of glass, lit by its ceiling",
    "obj-gi/mcguire-cornell/CornellBox-Glossy-Floor.obj": "another box, whose material library isn't there: grey",
    "obj-gi/mcguire-holodeck/holodeck.obj": "a large room that is lit by its walls, from inside",
    "obj-gi/embree/spheres.obj": "few small balls on a large ground",
    "obj-gi/embree/cornell_box.obj": "a box without a light of its own",
    "obj-gi/minhlucky9/testChamberPH.obj": "an empty chamber, closed all round, without a light",
    "obj-gi/tungsten/tungsten-cornell-box.obj": "a box whose light is in the picture",
}
MADE = {
    "yard": ("houses on a ground with a picture, from above", "seen from"),
    "room": ("a closed room with a light below its ceiling, from inside", "seen from inside"),
    "cellar": ("the same room without a light", "no light"),
    "missed": ("a light that shines away from all that is seen", "a point light at the camera is added"),
    "shelf": ("a shelf, seen from its open side, -z", "seen from -z"),
    "leaf": ("a leaf in a white picture that is transparent around it", "--alpha-of-pictures"),
    "glass": ("a ball of glass below a very bright light", ""),
    "tiny": ("balls of a thousandth of a unit", "no light"),
    "giant": ("hills of 100,000 units", "seen from"),
    "black": ("what reflects nothing", "reflect none"),
}
FEW = ("cellar", "shelf", "leaf", "black")
# Lines that say why a picture is dark, empty or burnt out.
REASONS = ("the picture is black", "reflects nothing", "gets next to none of its own light", "--alpha-of-pictures")


def render(host, scene, picture, size, seconds):
    command = [host, str(scene), "--size", size, "--time-limit", str(seconds), "-o", str(picture)]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace")
    picture.with_suffix(".log").write_text(done.stderr, encoding="utf-8")
    if done.returncode != 0:
        raise SystemExit(f"{scene}: pm_host ends with {done.returncode}: {done.stderr}")
    return done.stderr


def shares(rows):
    """Of the pixels those that are nearly black, and those that are burnt out."""
    pixels = [row[i : i + 3] for row in rows for i in range(0, len(row), 3)]
    dark = sum(max(p) < 8 for p in pixels) / len(pixels)
    return dark, sum(min(p) > 250 for p in pixels) / len(pixels)


def looks(is_full, folder, only):
    """(name, file, what, word) of each scene that is there."""
    for name, what in SHARED.items() if is_full else ():
        if not DATA.is_dir():
            continue
        stem = pathlib.PurePath(name).stem
        if not only or only == stem:
            yield stem, DATA / name, what, ""
    for make in look_scenes.MADE:
        name = make.__name__
        if (is_full or name in FEW) and (not only or only == name):
            make(folder)
            yield name, folder / f"{name}.obj", *MADE[name]


def fault(name, dark, bright, word, log):
    reason = next((r for r in REASONS if r in log), None)
    # What is empty is told to be; of the rest no more than that.
    if told := re.search(r"(\d+) % of the picture is empty", log):
        empty = int(told[1]) / 100
        dark = (dark - empty) / (1 - empty)
    if word not in log:
        return f"{name}: no line says '{word}':\n{log}"
    if max(dark, bright) > MOST and reason is None:
        return f"{name}: {dark:.0%} nearly black, {bright:.0%} burnt out, and no line says why:\n{log}"
    return ""


def write_sheet(tiles):
    width, gap = tiles[0][0], 4
    whole = (width + gap) * COLUMNS - gap
    rows = []
    for first in range(0, len(tiles), COLUMNS):
        line = tiles[first : first + COLUMNS]
        rows += [bytes([255] * whole * 3)] * (gap if first else 0)
        for parts in zip(*(rows_of for _, rows_of in line)):
            rows.append(bytes([255] * gap * 3).join(parts).ljust(whole * 3, b"\xff"))
    write_rows(SHEET, whole, rows, 3)
    print(f"{SHEET.relative_to(ROOT)}: {SHEET.stat().st_size / 1000:.0f} kB")


def write_page(lines):
    text = PAGE.read_text(encoding="utf-8")
    table = "| | scene | seen | nearly black | burnt out |\n|---|---|---|---|---|\n" + "".join(lines)
    pattern = r"(<!-- looks: first_looks.py --write -->\n).*?(<!-- end of looks -->)"
    PAGE.write_text(re.sub(pattern, lambda m: m[1] + table + m[2], text, flags=re.DOTALL), encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("host")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--keep", type=pathlib.Path)
    parser.add_argument("--only", default="")
    given = parser.parse_args()
    is_full = given.all or given.write or bool(given.only)
    size, seconds = ("160x120", 4) if is_full else ("96x72", 1)
    if is_full and not DATA.is_dir():
        print("the ten scenes of ../shared/data are left out: it is not there")
    faults, tiles, lines = [], [], []
    with tempfile.TemporaryDirectory(prefix="pm looks ") as scratch:
        folder = given.keep or pathlib.Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        for name, file, what, word in looks(is_full, folder, given.only):
            picture = folder / f"{name}.look.png"
            log = render(given.host, file, picture, size, seconds)
            width, rows = read_rows(picture)
            dark, bright = shares(rows)
            print(f"{name}: {dark:.0%} nearly black, {bright:.0%} burnt out", flush=True)
            faults += [found] if (found := fault(name, dark, bright, word, log)) else []
            tiles.append((width, rows))
            lines.append(f"| {len(tiles)} | {name} | {what} | {dark:.0%} | {bright:.0%} |\n")
    if given.write and not faults:
        write_sheet(tiles)
        write_page(lines)
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
