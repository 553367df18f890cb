#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Writes the scenes of the regression suite that are nobody else's: NAME.obj, scenes.mtl, a texture.

usage: make_scenes.py [FOLDER]    (the folder of this script)
"""
import math
import pathlib
import struct
import sys
import zlib

HEAD = "# SPDX-License-Identifier: Apache-2.0\n# SPDX-FileCopyrightText: The pm authors\n"

MTL = HEAD + """\
# Linear Rec.709; Ke in W m^-2 sr^-1 per channel.
newmtl white
illum 1
Kd 0.7 0.7 0.7
newmtl red
illum 1
Kd 0.63 0.065 0.05
newmtl green
illum 1
Kd 0.14 0.45 0.091
newmtl blue
illum 1
Kd 0.1 0.2 0.6
newmtl lamp
illum 1
Kd 0 0 0
Ke 12 11 9
newmtl warm
illum 1
Kd 0 0 0
Ke 60 25 8
newmtl cold
illum 1
Kd 0 0 0
Ke 5 12 30
newmtl mirror
illum 3
Kd 0 0 0
Ks 0.9 0.9 0.9
newmtl glass
illum 7
Kd 0 0 0
Ks 1 1 1
Tf 0.9 0.95 0.9
Ni 1.5
newmtl satin
illum 2
Kd 0.2 0.2 0.2
Ks 0.5 0.5 0.5
Ns 40
newmtl polished
illum 2
Kd 0.1 0.1 0.1
Ks 0.7 0.6 0.4
Ns 1000
newmtl checker
illum 1
Kd 1 1 1
map_Kd checker.png
newmtl leaf
illum 1
Kd 0.2 0.5 0.1
map_d leaf.png
"""


class Scene:
    def __init__(self):
        self.lines, self.v, self.vt, self.vn = ["mtllib scenes.mtl"], 0, 0, 0

    def use(self, material):
        self.lines += [f"g {material}_{len(self.lines)}", f"usemtl {material}"]

    def points(self, points):
        self.lines += ["v %.9g %.9g %.9g" % tuple(p) for p in points]
        first, self.v = self.v + 1, self.v + len(points)
        return first

    def quad(self, corners, uv=False):
        first = self.points(corners)
        if not uv:
            self.lines.append("f " + " ".join(str(first + i) for i in range(4)))
            return
        self.lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1"]
        self.lines.append("f " + " ".join(f"{first + i}/{self.vt + 1 + i}" for i in range(4)))
        self.vt += 4

    def box(self, low, high, inward=False):
        (a, b, c), (d, e, f) = low, high
        first = self.points([(x, y, z) for z in (c, f) for y in (b, e) for x in (a, d)])
        for face in ([0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2],
                     [1, 3, 7, 5]):
            if inward:
                face = face[::-1]
            self.lines.append("f " + " ".join(str(first + i) for i in face))

    def ball(self, centre, radius, rings, smooth):
        ring = 2 * rings
        normals = [(math.sin(math.pi * i / rings) * math.cos(math.pi * 2 * j / ring),
                    math.cos(math.pi * i / rings),
                    math.sin(math.pi * i / rings) * math.sin(math.pi * 2 * j / ring))
                   for i in range(rings + 1) for j in range(ring)]
        first = self.points([[c + radius * n for c, n in zip(centre, normal)]
                             for normal in normals])
        if smooth:
            self.lines += ["vn %.9g %.9g %.9g" % n for n in normals]
        at = lambda i, j: first + i * ring + j % ring
        for i in range(rings):
            for j in range(ring):
                face = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]
                if i == 0:
                    face = [face[0], face[2], face[3]]
                elif i == rings - 1:
                    face = face[:3]
                text = [f"{k}//{k - first + 1 + self.vn}" if smooth else str(k) for k in face]
                self.lines.append("f " + " ".join(text))
        self.vn += len(normals) if smooth else 0

    def room(self, floor="white", back="white", left="red", right="green"):
        """From -1 to 1, from 0 to 2, open to +z; a lamp below the ceiling."""
        for material, corners in (
                (floor, [(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]),
                ("white", [(-1, 2, 1), (-1, 2, -1), (1, 2, -1), (1, 2, 1)]),
                (back, [(-1, 0, -1), (1, 0, -1), (1, 2, -1), (-1, 2, -1)]),
                (left, [(-1, 0, 1), (-1, 0, -1), (-1, 2, -1), (-1, 2, 1)]),
                (right, [(1, 0, -1), (1, 0, 1), (1, 2, 1), (1, 2, -1)])):
            self.use(material)
            self.quad(corners, uv=material == "checker")

    def lamp(self, half=0.35, height=1.98, material="lamp", x=0.0, z=0.0):
        self.use(material)
        self.quad([(x - half, height, z + half), (x - half, height, z - half),
                   (x + half, height, z - half), (x + half, height, z + half)])

    def text(self):
        return HEAD + "\n".join(self.lines) + "\n"


def textured():
    scene = Scene()
    scene.room(floor="checker")
    scene.lamp()
    scene.use("leaf")
    scene.quad([(-0.7, 0.1, 0.3), (0.1, 0.1, 0.1), (0.1, 1.3, 0.1), (-0.7, 1.3, 0.3)], uv=True)
    return scene


def subdivided():
    scene = Scene()
    scene.room()
    scene.lamp()
    scene.use("blue")
    scene.box((-0.7, 0.1, -0.6), (0, 1.1, 0.1))
    # The upper face's edges are sharp.
    first = scene.v - 7
    for a, b in ((2, 6), (6, 7), (7, 3), (3, 2)):
        scene.lines.append(f"t crease 2/1/0 {first - 1 + a} {first - 1 + b} 3.5")
    scene.use("white")
    scene.box((0.2, 0.1, -0.2), (0.8, 0.7, 0.4))
    return scene


def glossy():
    scene = Scene()
    scene.room(floor="satin", back="polished")
    scene.lamp()
    scene.use("blue")
    scene.box((-0.6, 0, -0.3), (-0.1, 0.9, 0.3))
    scene.use("polished")
    scene.ball((0.45, 0.4, 0.1), 0.35, 12, True)
    return scene


def mirrors():
    scene = Scene()
    scene.room(back="mirror", left="mirror", right="mirror")
    scene.lamp()
    scene.use("red")
    scene.box((-0.3, 0, -0.3), (0.3, 0.8, 0.3))
    return scene


def no_lamp():
    scene = Scene()
    scene.use("white")
    scene.quad([(-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)])
    scene.use("green")
    scene.ball((0, 0.6, 0), 0.6, 12, True)
    return scene


def many_lamps():
    scene = Scene()
    scene.room()
    for i in range(8):
        for j in range(8):
            scene.lamp(0.02 + 0.005 * ((3 * i + j) % 4), 1.95, ("warm", "cold")[(i + j) % 2],
                       -0.8 + 1.6 * i / 7, -0.8 + 1.6 * j / 7)
    scene.use("white")
    scene.box((-0.3, 0, -0.3), (0.3, 0.8, 0.3))
    return scene


def smooth_ball():
    scene = Scene()
    scene.room()
    scene.lamp(0.1, 1.98, "warm", 0.6, 0.4)
    scene.use("white")
    scene.ball((0, 0.7, 0), 0.6, 4, True)
    return scene


def window_pane():
    """Two rooms with a pane of glass between them; the lamp is in the far one."""
    scene = Scene()
    scene.use("white")
    scene.box((-1, 0, -2), (1, 2, 2), inward=True)
    scene.lamp(0.35, 1.98, "lamp", 0, -1)
    scene.use("glass")
    scene.box((-1, 0.01, 0), (1, 1.99, 0.02))
    scene.use("red")
    scene.box((-0.6, 0, -1.2), (0, 0.9, -0.7))
    scene.use("blue")
    scene.box((0.2, 0, 0.3), (0.6, 0.5, 0.7))
    return scene


def one_hole():
    """A closed box that light enters through a small hole."""
    scene = Scene()
    scene.room()
    scene.lamp(0.6)
    scene.use("white")
    h = 0.15
    outer = [(-1, 1.2, 1), (-1, 1.2, -1), (1, 1.2, -1), (1, 1.2, 1)]
    inner = [(-h, 1.2, h), (-h, 1.2, -h), (h, 1.2, -h), (h, 1.2, h)]
    for i in range(4):
        scene.quad([outer[i], outer[(i + 1) % 4], inner[(i + 1) % 4], inner[i]])
    return scene


def png(width, height, pixel):
    """8 bits a channel; pixel(x, y) gives a tuple of 1 or 3 codes."""
    channels = len(pixel(0, 0))
    rows = b"".join(b"\0" + bytes(c for x in range(width) for c in pixel(x, y))
                    for y in range(height))
    chunk = lambda name, data: (struct.pack(">I", len(data)) + name + data +
                                struct.pack(">I", zlib.crc32(name + data)))
    head = struct.pack(">IIBBBBB", width, height, 8, {1: 0, 3: 2}[channels], 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 9)) +
            chunk(b"IEND", b""))


def checker(x, y):
    return (230, 200, 60) if (x // 8 + y // 8) % 2 else (40, 70, 120)


def leaf(x, y):
    u, v = (x - 31.5) / 32, (y - 31.5) / 32
    return (255 if abs(u) < 0.8 * math.cos(v * math.pi / 2) ** 0.7 and abs(u) > 0.05 else 0,)


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent)
    folder.mkdir(parents=True, exist_ok=True)
    for make in (textured, subdivided, glossy, mirrors, no_lamp, many_lamps, smooth_ball,
                 window_pane, one_hole):
        (folder / f"{make.__name__}.obj").write_text(make().text())
    (folder / "scenes.mtl").write_text(MTL)
    (folder / "checker.png").write_bytes(png(64, 64, checker))
    (folder / "leaf.png").write_bytes(png(64, 64, leaf))


if __name__ == "__main__":
    main()
