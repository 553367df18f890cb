#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Writes scenes where renders have specks: a hall of chairs a third of which are rough metal (DATA is a folder
with glossy_hall/make_hall.py), balls of mirror and glass in a bright room (bright_room/make_room_with_balls.py),
and sixty low-poly things of plastic as Blender has it by default, at night beside an area light.

usage: speck_scenes.py FOLDER [DATA]
"""

import math
import pathlib
import random
import subprocess
import sys


def write_hall(folder, script):
    plain = folder / "plain_hall.obj"
    subprocess.run([sys.executable, script, plain], check=True)
    lines, chairs, legs = [], 0, 0
    for line in plain.read_text().splitlines():
        if line == "usemtl steel":
            chairs += legs % 4 == 0
            legs += 1
        if line.startswith("usemtl") and line.split()[1] in ("steel", "red", "blue") and chairs % 3 == 0:
            line = "usemtl metal"
        lines.append(line.replace("plain_hall.mtl", "hall.mtl"))
    (folder / "hall.obj").write_text("\n".join(lines) + "\n")
    metal = "newmtl metal\nKd .8 .8 .8\nPm 1\nPr .2\nillum 2\n"
    (folder / "hall.mtl").write_text((folder / "plain_hall.mtl").read_text() + metal)


def write_balls(folder, script):
    subprocess.run([sys.executable, script, folder / "balls.obj", ".7", "--mirror", "--glass"], check=True)


class Things:
    def __init__(self):
        self.lines, self.count = ["mtllib night.mtl"], 0

    def add(self, points, faces, material):
        self.lines.append("usemtl " + material)
        self.lines += ["v %.6f %.6f %.6f" % p for p in points]
        self.lines += ["f " + " ".join(str(self.count + 1 + k) for k in f) for f in faces]
        self.count += len(points)

    # A prism, or a cone where the upper ring is small.
    def tower(self, x, z, radius, height, sides, upper, material):
        ring = lambda y, r: [(x + r * math.cos(2 * math.pi * i / sides), y, z + r * math.sin(2 * math.pi * i / sides))
                             for i in range(sides)]  # fmt: skip
        faces = [(i, sides + i, sides + (i + 1) % sides, (i + 1) % sides) for i in range(sides)]
        faces.append(tuple(range(2 * sides - 1, sides - 1, -1)))
        self.add(ring(0, radius) + ring(height, upper * radius), faces, material)


def write_night(folder):
    rng = random.Random(7)
    things = Things()
    things.add([(-40, 0, 40), (40, 0, 40), (40, 0, -40), (-40, 0, -40)], [(0, 1, 2, 3)], "ground")
    for i in range(60):
        x, z = (i % 10 - 4.5) * 1.1 + rng.uniform(-0.3, 0.3), (i // 10 - 2.5) * 1.2 + rng.uniform(-0.3, 0.3)
        things.tower(x, z, rng.uniform(0.15, 0.4), rng.uniform(0.3, 1.4), rng.randint(4, 8), rng.uniform(0.1, 1),
                     f"plastic{i % 5}")  # fmt: skip
    things.add([(-4, 4, -1), (-2.5, 4.6, -1), (-2.5, 4.6, 1), (-4, 4, 1)], [(0, 1, 2, 3)], "lamp")
    (folder / "night.obj").write_text("\n".join(things.lines) + "\n")
    colours = ("0.8 0.8 0.8", "0.7 0.2 0.15", "0.2 0.3 0.6", "0.3 0.5 0.2", "0.6 0.5 0.2")
    plastic = "newmtl {}\nNs 250\nKa 1 1 1\nKd {}\nKs 0.5 0.5 0.5\nKe 0 0 0\nNi 1.45\nd 1\nillum 2\n"
    materials = [plastic.format(f"plastic{i}", colour) for i, colour in enumerate(colours)]
    materials.append(plastic.format("ground", "0.4 0.38 0.35"))
    materials.append("newmtl lamp\nKd 0 0 0\nKe 40 36 30\n")
    (folder / "night.mtl").write_text("".join(materials))
    # Radiance's format: three mantissas and an exponent a pixel, brighter towards the horizon.
    width, height = 64, 32
    texel = lambda y: bytes((int(60 + 2 * min(y, 31 - y)), int(80 + 2 * min(y, 31 - y)), 140, 123))
    rows = b"".join(texel(y) * width for y in range(height))
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode()
    (folder / "night.hdr").write_bytes(head + rows)


def main():
    folder = pathlib.Path(sys.argv[1])
    if len(sys.argv) > 2:
        data = pathlib.Path(sys.argv[2])
        write_hall(folder, data / "glossy_hall/make_hall.py")
        write_balls(folder, data / "bright_room/make_room_with_balls.py")
    write_night(folder)


if __name__ == "__main__":
    main()
