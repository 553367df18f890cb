#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Writes scenes as people have them:

outdoors  sixty low-poly things by one picture of 1024 x 1024, Blender's plastic of Ks .5 and Pr .6, an area light, a
          night sky as picture
covers    the same things, a quarter each under a clear coat, sheen, part of a coat, and nothing
atrium    a courtyard of 290,000 triangles: columns and drapes by pictures, plants whose leaves are cut out
helmet    20,000 triangles that shine by a picture of 4096 x 4096

VIEWS has the options of each.

usage: everyday_scenes.py FOLDER [NAME...]
"""
import math
import pathlib
import random
import struct
import sys
import zlib

VIEWS = {
    "outdoors": "--environment night.hdr --eye 3,2.6,9 --look-at 0,.5,0 --fov 45",
    "covers": "--environment night.hdr --eye 3,2.6,9 --look-at 0,.5,0 --fov 45",
    "atrium": "--sun 160,58 --eye -9,2.2,.6 --look-at 4,2.4,-.4 --fov 62",
    "helmet": "--eye 0,.6,4 --look-at 0,0,0 --fov 40",
}


def write_png(file, size, row, channels=3):
    """row(y): bytes of `size` texels; the rows as they are, not filtered."""
    kind = {1: 0, 3: 2, 4: 6}[channels]

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    packer = zlib.compressobj(1)
    data = b"".join(packer.compress(b"\0" + row(y)) for y in range(size)) + packer.flush()
    head = struct.pack(">IIBBBBB", size, size, 8, kind, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", data) + chunk(b"IEND", b""))


def mottled(size, colour, seed, cell=16):
    """Rows of a colour that varies from cell to cell and a little from texel to texel."""
    rng = random.Random(seed)
    cells = [[rng.uniform(0.55, 1) for _ in range(size // cell)] for _ in range(size // cell)]
    grains = [bytes(int(c * v / 255 * (220 + g) / 255) for g in (0, 8, 17, 35) for c in colour) for v in range(256)]

    def row(y):
        levels = [int(255 * v) for v in cells[y // cell]]
        return b"".join(grains[v] * (cell // 4) for v in levels)

    return row


class Mesh:
    def __init__(self, library):
        self.lines, self.count, self.triangles = [f"mtllib {library}"], 0, 0

    def add(self, points, uvs, faces, material):
        self.lines.append("usemtl " + material)
        self.lines += ["v %.5f %.5f %.5f" % p for p in points]
        self.lines += ["vt %.5f %.5f" % uv for uv in uvs]
        at = self.count + 1
        self.lines += ["f " + " ".join(f"{at + k}/{at + k}" for k in f) for f in faces]
        self.count += len(points)
        self.triangles += sum(len(f) - 2 for f in faces)

    # place(u, v): a point; n x m quads, each point's uv is its own times `repeat`.
    def sheet(self, place, n, m, material, repeat=(1, 1)):
        places = [(i / n, j / m) for j in range(m + 1) for i in range(n + 1)]
        points = [place(u, v) for u, v in places]
        uvs = [(u * repeat[0], v * repeat[1]) for u, v in places]
        k = lambda i, j: j * (n + 1) + i
        faces = [(k(i, j), k(i + 1, j), k(i + 1, j + 1), k(i, j + 1)) for j in range(m) for i in range(n)]
        self.add(points, uvs, faces, material)

    def quad(self, a, b, c, d, material, repeat=(1, 1)):
        self.add([a, b, c, d], [(0, 0), (repeat[0], 0), repeat, (0, repeat[1])], [(0, 1, 2, 3)], material)

    def write(self, file):
        file.write_text("\n".join(self.lines) + "\n")
        print(f"{file}: {self.triangles} triangles")


def tower(mesh, rng, x, z, material):
    """A prism, or a cone where the upper ring is small; its uv lie in a cell of one picture for all."""
    radius, height, sides, upper = rng.uniform(0.15, 0.4), rng.uniform(0.3, 1.4), rng.randint(4, 8), rng.uniform(0.1, 1)
    u, v = rng.randrange(8) / 8, rng.randrange(8) / 8

    def ring(y, r):
        return [(x + r * math.cos(2 * math.pi * i / sides), y, z + r * math.sin(2 * math.pi * i / sides))
                for i in range(sides)]  # fmt: skip

    faces = [(sides + i, sides + (i + 1) % sides, (i + 1) % sides, i) for i in range(sides)]
    faces.append(tuple(range(2 * sides - 1, sides - 1, -1)))
    uvs = [(u + i / sides / 8, v + j / 8) for j in (0, 1) for i in range(sides)]
    mesh.add(ring(0, radius) + ring(height, upper * radius), uvs, [f[::-1] for f in faces], material)


def write_night(file):
    """Radiance's format, four bytes a texel: brighter to the horizon, a town's glow and stars."""
    rng = random.Random(3)
    width, height = 1024, 512
    stars = {(rng.randrange(width), rng.randrange(height // 2)) for _ in range(300)}
    rows = []
    for y in range(height):
        line = bytearray()
        for x in range(width):
            near = math.exp(-abs(y - 255) / 40)
            glow = near * math.exp(-(((x - 300) / 90) ** 2))
            level = 1 if y < 256 else 0.25
            texel = [int(v * level) for v in (40 + 30 * near + 90 * glow, 55 + 30 * near + 60 * glow, 105 + 20 * near)]
            line += bytes(texel + [123]) if (x, y) not in stars else bytes((220, 220, 240, 129))
        rows.append(bytes(line))
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode()
    file.write_bytes(head + b"".join(rows))


PLASTIC = "newmtl {}\nKa 1 1 1\nKd .8 .8 .8\nKs .5 .5 .5\nKe 0 0 0\nNi 1.5\nd 1\nillum 2\nPr .6\n{}map_Kd {}\n"


def write_outdoors(folder, name, covers):
    rng = random.Random(7)
    mesh = Mesh(f"{name}.mtl")
    mesh.quad((-40, 0, 40), (40, 0, 40), (40, 0, -40), (-40, 0, -40), "ground", (20, 20))
    for i in range(60):
        x, z = (i % 10 - 4.5) * 1.1 + rng.uniform(-0.3, 0.3), (i // 10 - 2.5) * 1.2 + rng.uniform(-0.3, 0.3)
        tower(mesh, rng, x, z, f"things{i % len(covers)}")
    mesh.quad((-4, 4, -1), (-2.5, 4.6, -1), (-2.5, 4.6, 1), (-4, 4, 1), "emissive")
    mesh.write(folder / f"{name}.obj")
    materials = [PLASTIC.format(f"things{i}", cover, "atlas.png") for i, cover in enumerate(covers)]
    materials.append(PLASTIC.format("ground", covers[0], "ground.png"))
    materials.append("newmtl emissive\nKd 0 0 0\nKe 8 7.2 6\n")
    (folder / f"{name}.mtl").write_text("".join(materials))
    write_png(folder / "atlas.png", 1024, mottled(1024, (205, 150, 110), 1, 32))
    write_png(folder / "ground.png", 1024, mottled(1024, (120, 140, 90), 2))
    write_night(folder / "night.hdr")


def leaf_row(size):
    """RGBA rows of nine leaves: what lies outside of them is cut out."""
    third = size // 3

    def inside(x, y):
        u, v = (x % third) / third * 2 - 1, (y % third) / third * 2 - 1
        return abs(u) < 0.8 * (1 - v * v) * (0.6 + 0.4 * math.cos(9 * v))

    def row(y):
        line = b"".join(bytes((70, 120 + 60 * (x // 8 % 2), 40, 255 if inside(x, y) else 0)) for x in range(third))
        return line * 3 + b"\0\0\0\0" * (size - 3 * third)

    return row


def write_atrium(folder):
    rng = random.Random(5)
    mesh = Mesh("atrium.mtl")
    mesh.sheet(lambda u, v: (-11 + 22 * u, 0, 6 - 12 * v), 60, 40, "floor", (11, 6))
    for side in (-1, 1):
        wall = lambda u, v, s=side: (-11 + 22 * u, 8 * v, s * 6 + 0.06 * math.sin(40 * u) * math.sin(9 * v))
        mesh.sheet(wall, 120, 60, "wall", (8, 3))
        mesh.sheet(lambda u, v, s=side: (s * 11, 8 * v, -6 + 12 * u), 60, 40, "wall", (4, 3))
        mesh.sheet(lambda u, v, s=side: (-11 + 22 * u, 4, s * (6 - 2.6 * v)), 80, 10, "stone", (8, 1))
        for k in range(10):
            x = -10 + 20 * k / 9
            for base, height in ((0, 4), (4, 3.6)):
                radius = lambda v: 0.22 + 0.06 * math.cos(2 * math.pi * v) ** 8
                mesh.sheet(lambda u, v, s=side, x=x, b=base, h=height: (
                    x + radius(v) * (1 + 0.06 * math.cos(16 * math.pi * u)) * math.cos(2 * math.pi * u), b + h * v,
                    s * 3.6 - radius(v) * (1 + 0.06 * math.cos(16 * math.pi * u)) * math.sin(2 * math.pi * u)),
                    64, 36, "stone", (2, 4))  # fmt: skip
            hang = lambda u, v, s=side, x=x: (x + 0.3 + 1.5 * u, 3.9 - 2.2 * v, s * 3.6 + 0.12 * math.sin(18 * u + v))
            if k < 9:
                mesh.sheet(hang, 48, 24, f"drape{k % 3}", (2, 2))
    for plant in range(24):
        x, z = rng.uniform(-9.5, 9.5), rng.choice((-1, 1)) * rng.uniform(1.6, 2.9)
        for _ in range(360):
            a, t, r = rng.uniform(0, 2 * math.pi), rng.uniform(-0.6, 0.9), rng.uniform(0.05, 0.5)
            c = (x + r * math.cos(a), rng.uniform(0.3, 1.3), z + r * math.sin(a))
            e = (0.13 * math.cos(a) * math.cos(t), 0.13 * math.sin(t), 0.13 * math.sin(a) * math.cos(t))
            f = (-0.1 * math.sin(a), 0.02, 0.1 * math.cos(a))
            corner = lambda s, t, c=c, e=e, f=f: tuple(c[k] + s * e[k] + t * f[k] for k in range(3))
            mesh.quad(corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1), "leaves")
    mesh.write(folder / "atrium.obj")
    colours = {"floor": (180, 160, 140), "wall": (200, 185, 160), "stone": (190, 188, 180), "drape0": (180, 50, 40),
               "drape1": (50, 80, 150), "drape2": (60, 120, 60)}  # fmt: skip
    text = [PLASTIC.format(name, "", name + ".png") for name in colours]
    text.append(PLASTIC.format("leaves", "", "leaves.png") + "map_d leaves.png\n")
    (folder / "atrium.mtl").write_text("".join(text))
    for seed, (name, colour) in enumerate(colours.items()):
        write_png(folder / f"{name}.png", 1024, mottled(1024, colour, seed))
    write_png(folder / "leaves.png", 512, leaf_row(512), 4)


def write_helmet(folder):
    mesh = Mesh("helmet.mtl")
    place = lambda u, v: (
        (1 + 0.05 * math.sin(30 * v)) * math.cos(2 * math.pi * u) * math.sin(math.pi * (0.02 + 0.96 * v)),
        -math.cos(math.pi * (0.02 + 0.96 * v)),
        -(1 + 0.05 * math.sin(30 * v)) * math.sin(2 * math.pi * u) * math.sin(math.pi * (0.02 + 0.96 * v)))  # fmt: skip
    mesh.sheet(place, 100, 100, "helmet")
    mesh.quad((-6, -1.2, 6), (6, -1.2, 6), (6, -1.2, -6), (-6, -1.2, -6), "ground")
    mesh.write(folder / "helmet.obj")
    (folder / "helmet.mtl").write_text(
        "newmtl helmet\nKd .3 .3 .3\nKe 1 1 1\nmap_Ke shine.png\nmap_Kd skin.png\n\nnewmtl ground\nKd .6 .6 .6\n"
    )
    size = 4096
    dark = bytes(3 * size)
    strip = b"".join(bytes((255, 150, 60)) if x // 64 % 16 == 3 else bytes(3) for x in range(size))
    write_png(folder / "shine.png", size, lambda y: strip if y // 128 % 8 == 5 else dark)
    write_png(folder / "skin.png", size, mottled(size, (170, 170, 190), 9, 64))


COATS = ("Pc 1\nPcr .4\n", "Ps .5\n", "Pc .6\nPcr .5\n", "")
WRITERS = {
    "outdoors": lambda folder: write_outdoors(folder, "outdoors", ("",)),
    "covers": lambda folder: write_outdoors(folder, "covers", COATS),
    "atrium": write_atrium,
    "helmet": write_helmet,
}


def main():
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[2:] or WRITERS:
        WRITERS[name](folder)


if __name__ == "__main__":
    main()
