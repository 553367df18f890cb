#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Perspective cameras of POV-Ray's see spheres where POV-Ray sees them: centroids within half a pixel.

usage: povray_cameras.py PM_HOST

Skips, with a line, where povray or oiiotool is not installed.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

WIDTH, HEIGHT = 128, 96
COLOURS = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (0, 1, 1)]
PLACES = ["<0, 0, 0>", "<1.4, .3, .2>", "<-1.2, .9, -.3>", "<.4, -1.1, .5>", "<-.9, -.8, 1.1>"]
BASE = "location <0, 1, -6> look_at <0, 0, 0>"
CAMERAS = [
    BASE,
    "location <0, 1, -6> look_at <0, 0, 0> angle 40",
    "angle 50 location <0, 1, -6> look_at <0, 0, 0>",
    "look_at <0, 0, 0> location <0, 1, -6>",
    "location <4, 3, -4> look_at <.2, 0, 0> angle 45",
    "location <-5, 2, 3> look_at <0, 0, 0> angle 40",
    "location <1, 6, -1> look_at <0, 0, 0> angle 45",
    "location <0, 0, 6> look_at <0, 0, 0> angle 45",
    "right -4/3 * x location <0, 1, -6> look_at <0, 0, 0>",
    "location <0, 1, -6> right -4/3 * x look_at <0, 0, 0> angle 40",
    "location <0, 1, -6> look_at <0, 0, 0> right -4/3 * x angle 40",
    "location <0, 1, -6> up -y look_at <0, 0, 0>",
    "location <0, 1, -6> right 2 * x look_at <0, 0, 0> angle 50",
    "location <0, 1, -6> right x up 1.5 * y look_at <0, 0, 0> angle 45",
    "location <0, 1, -6> look_at <0, 0, 0> direction 2 * z",
    "direction 1.5 * z location <0, 1, -6> look_at <0, 0, 0>",
    "location <0, 1, -6> direction 3 * z look_at <0, 0, 0> right 2 * x up 1.5 * y",
    "sky <1, 1, 0> location <0, 1, -6> look_at <0, 0, 0>",
    "location <0, 1, -6> look_at <0, 0, 0> sky <1, 2, 0>",
    "location <0, 1, -6> sky <-1, 1, .5> look_at <0, 0, 0> angle 45",
    "sky z location <3, 3, -4> look_at <0, 0, 0> angle 45",
    "location <0, 0, -6>",
    "location <0, 0, -6> angle 45",
    "location <0, 0, -6> rotate 20 * y",
    "location <0, 0, -6> rotate <10, 30, 0> angle 45",
    "location <0, 0, -6> look_at <0, 0, 0> rotate <20, 30, 10>",
    "location <0, 1, -6> look_at <0, 0, 0> translate <.3, .2, 0>",
    "location <0, 1, -6> look_at <0, 0, 0> rotate 15 * z translate <.3, .2, -.5>",
    "location <0, 1, -6> look_at <0, 0, 0> scale <1, 1.3, 1>",
    "location <0, 1, -6> look_at <0, 0, 0> scale <-1, 1, 1>",
    "location <0, 1, -6> look_at <0, 0, 0> matrix <1, .2, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0>",
    "location <0, 1, -6> look_at <0, 0, 0> angle 45 rotate 40 * y scale .9",
    "translate <0, 1, 0> location <0, 0, -6> look_at <0, 0, 0>",
    "rotate 30 * y location <0, 1, -6> look_at <0, 0, 0>",
    "perspective location <0, 1, -6> look_at <0, 0, 0> angle 35",
    "location <0, 1, -6> right <1.2, .2, 0> up <0, 1, 0> direction <0, 0, 1>",
    "location <0, 0, -6> right <1.2, 0, .3> up <.1, 1, 0> direction <.1, -.05, 1.2>",
    "location <0, 1, -6> look_at <.5, .5, 0> right 4/3 * x up y angle 60",
    "location <2, -4, -3> look_at <0, 0, 0> angle 45 right -4/3 * x",
    "location <0, 1, -6> look_at <0, 0, 0> right 1.6 * x * 2 up 1.2 * y * 2 angle 42",
]  # fmt: skip


def scene(camera):
    spheres = "".join(
        f"sphere {{ {place}, .22 pigment {{ rgb <{colour[0]}, {colour[1]}, {colour[2]}> }} finish {{ ambient 1 diffuse 0 }} }}\n"
        for place, colour in zip(PLACES, COLOURS)
    )
    return f"#version 3.7;\nglobal_settings {{ assumed_gamma 1 }}\ncamera {{ {camera} }}\n{spheres}"


def centroids(pixels):
    """colour -> (x, y, pixels) of those that are of it alone. pixels: (x, y, r, g, b)"""
    sums = {}
    for x, y, *rgb in pixels:
        most = max(rgb)
        if most > 0:
            sum_ = sums.setdefault(tuple(int(c > 0.5 * most) for c in rgb), [0, 0, 0])
            for i, value in enumerate((x + 0.5, y + 0.5, 1)):
                sum_[i] += value
    return {colour: (x / n, y / n, n) for colour, (x, y, n) in sums.items()}


def of_povray(name, folder):
    subprocess.run(["povray", f"+I{name}.pov", f"+W{WIDTH}", f"+H{HEIGHT}", "-D", "+FP", "-A", "+Otheirs.ppm", "-GA"],
                   cwd=folder, capture_output=True, check=True)  # fmt: skip
    data = (folder / "theirs.ppm").read_bytes()
    values = data[len(data) - 3 * WIDTH * HEIGHT :]
    for i in range(WIDTH * HEIGHT):
        r, g, b = values[3 * i : 3 * i + 3]
        yield (i % WIDTH, i // WIDTH, *(c if c > 40 else 0 for c in (r, g, b)))


def of_pm(host, name, folder):
    subprocess.run([host, f"{name}.pov", "--size", f"{WIDTH}x{HEIGHT}", "--passes", "1", "--photons", "1000", "-q", "-o",
                    "ours.exr"], cwd=folder, capture_output=True, check=True)  # fmt: skip
    text = subprocess.run(["oiiotool", "--dumpdata", "ours.exr"], cwd=folder, capture_output=True, text=True).stdout
    pixels = [(int(x), int(y), *(float(v) for v in values.split()[:3]))
              for x, y, values in re.findall(r"Pixel \((\d+), (\d+)\): (.*)", text)]  # fmt: skip
    # What one sphere's light shows of another's dark limb is less than that.
    least = 0.1 * max(max(pixel[2:]) for pixel in pixels)
    return [(x, y, *(c if max(rgb) > least else 0 for c in rgb)) for x, y, *rgb in pixels]


def main():
    host = pathlib.Path(sys.argv[1]).resolve()
    for program in ("povray", "oiiotool"):
        if shutil.which(program) is None:
            print(f"{program} is not installed: skipped")
            return 77
    failures = compared = 0
    with tempfile.TemporaryDirectory(dir="/tmp") as temporary:
        folder = pathlib.Path(temporary)
        for number, camera in enumerate(CAMERAS):
            (folder / f"c{number}.pov").write_text(scene(camera))
            theirs = centroids(of_povray(f"c{number}", folder))
            ours = centroids(of_pm(host, f"c{number}", folder))
            whole = [c for c in COLOURS if c in theirs and theirs[c][2] >= 20]
            off = {c: max(abs(a - b) for a, b in zip(theirs[c][:2], ours.get(c, (1e9, 1e9, 0))[:2])) for c in whole}
            compared += len(off)
            if len(off) < 3 or max(off.values()) > 0.5:
                failures += 1
                print(f"camera {{ {camera} }}: {off}\n  povray {theirs}\n  pm     {ours}")
    print(f"{len(CAMERAS) - failures} of {len(CAMERAS)} cameras, {compared} spheres compared")
    return int(failures > 0)


if __name__ == "__main__":
    sys.exit(main())
