# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Scenes of very many of one thing, for tests of --memory-limit.

usage: memory_scenes.py lights|triangles|materials|instances|textures|held_whole FOLDER COUNT
"""
import json
import pathlib
import struct
import subprocess
import sys
import zlib

VIEW = ("--eye", "0,3,3", "--look-at", "0,0,0", "--fov", "45")
GROUND = "v -2 0 2\nv 2 0 2\nv 2 0 -2\nv -2 0 -2\nusemtl ground\nf 1 2 3 4\n"
GROUND_MTL = "newmtl ground\nKd .5 .5 .5\n"
LAMP = "o lamp\nusemtl lamp\nv -1 4 -1\nv 1 4 -1\nv 1 4 1\nv -1 4 1\nf -4 -3 -2 -1\n"
LAMP_MTL = "newmtl lamp\nKd 0 0 0\nKe 5 5 5\n"


def write_png(path, width, height, rows, depth=8, kind=2, interlace=0):
    """rows: one byte string a row."""

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    packed = zlib.compressobj(1)
    data = b"".join(packed.compress(b"\0" + row) for row in rows) + packed.flush()
    path.write_bytes(b"\x89PNG\r\n\x1a\n"
                     + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, interlace))
                     + chunk(b"IDAT", data) + chunk(b"IEND", b""))  # fmt: skip


def write_scene(folder, obj, mtl, sidecar=None):
    folder.mkdir()
    (folder / "scene.obj").write_text("mtllib scene.mtl\n" + obj, encoding="utf-8")
    (folder / "scene.mtl").write_text(mtl, encoding="utf-8")
    if sidecar:
        (folder / "scene.pm.json").write_text(json.dumps({"schema": "pm-sidecar/1", **sidecar}), encoding="utf-8")


def lights(folder, count):
    at = [(i % 317 / 80 - 2, 1 + i % 7 / 10, i // 317 / 400 - 1) for i in range(count)]
    write_scene(folder, GROUND, GROUND_MTL,
                {"lights": [{"type": "point", "name": f"bulb {i}", "position": p, "intensity": [1e-4, 1e-4, 1e-4]}
                            for i, p in enumerate(at)]})  # fmt: skip


def triangles(folder, count):
    side = round((count / 2) ** 0.5)
    lines = ["o ground", "usemtl ground"]
    lines += [f"v {4 * x / side - 2:.4f} {(x * 7 + y * 13) % 11 / 100} {2 - 4 * y / side:.4f}"
              for y in range(side + 1) for x in range(side + 1)]  # fmt: skip
    for y in range(side):
        for x in range(side):
            a = y * (side + 1) + x + 1
            lines += [f"f {a} {a + 1} {a + side + 2}", f"f {a} {a + side + 2} {a + side + 1}"]
    write_scene(folder, "\n".join(lines) + "\n" + LAMP, GROUND_MTL + LAMP_MTL)


def materials(folder, count):
    """Each on a triangle of its own, and as many that nothing uses."""
    lines = []
    for i in range(count):
        if i % 10_000 == 0:
            lines.append(f"o ground{i}")
        x, z = i % 400 / 100 - 2, i // 400 / 100 - 1.25
        lines += [f"v {x} 0 {z}", f"v {x} 0 {z + .01}", f"v {x + .01} 0 {z}", f"usemtl m{i}", "f -3 -2 -1"]
    mtl = "".join(f"newmtl m{i}\nKd {i % 89 / 100} .5 .5\nKs .1 .1 .1\nNs {10 + i % 50}\n" for i in range(2 * count))
    write_scene(folder, "\n".join(lines) + "\n" + LAMP, mtl + LAMP_MTL)


def instances(folder, count):
    tile = "o tile\nv 0 0 0\nv 0 0 .01\nv .01 0 0\nusemtl ground\nf 1 2 3\n"
    lamp = [{"of": "lamp"}]
    placed = [{"of": "tile", "name": f"tile {i}", "translate": [i % 400 / 100 - 2, i % 11 / 100, i // 400 / 100 - 1.25]}
              for i in range(count)]  # fmt: skip
    write_scene(folder, tile + LAMP, GROUND_MTL + LAMP_MTL, {"instances": lamp + placed})


def textures(folder, count):
    """Small ones, each on a quad of its own, and four of 2048 x 2048."""
    lines, mtl = ["o ground", "vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1"], LAMP_MTL
    for i in range(count + 4):
        x, z = i % 25 / 6 - 2, i // 25 / 6 - 1.5
        lines += [f"v {x} 0 {z + .16}", f"v {x + .16} 0 {z + .16}", f"v {x + .16} 0 {z}", f"v {x} 0 {z}",
                  f"usemtl m{i}", "f -4/1 -3/2 -2/3 -1/4"]  # fmt: skip
        mtl += f"newmtl m{i}\nmap_Kd t{i}.png\n"
    write_scene(folder, "\n".join(lines) + "\n" + LAMP, mtl)
    for i in range(count + 4):
        side = 64 if i < count else 2048
        row = bytes((x * 5 + i) % 200 for x in range(3 * side))
        write_png(folder / f"t{i}.png", side, side, (row[y % 7 :] + row[: y % 7] for y in range(side)))


def write_interlaced(path, side):
    """A grey PNG in the seven passes of Adam7, which no reader can give row by row."""

    bands = [bytes((x // 16 + band) % 256 for x in range(side)) for band in range(side // 16)]

    def rows():
        for x0, y0, dx, dy in ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4),
                               (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)):  # fmt: skip
            for y in range(y0, side, dy):
                yield bands[y // 16][x0::dx]

    write_png(path, side, side, rows(), kind=0, interlace=1)


def held_whole(folder, side):
    """A progressive JPEG and an interlaced PNG of so many texels a side, a power of 2."""
    quad = "v -2 {z} 2\nv 2 {z} 2\nv 2 {z} -2\nv -2 {z} -2\nusemtl {m}\nf -4/1 -3/2 -2/3 -1/4\n"
    write_scene(folder, "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n" + quad.format(z=0, m="png") + quad.format(z=-1, m="jpg") + LAMP,
                "newmtl png\nmap_Kd a.png\nnewmtl jpg\nmap_Kd a.jpg\n" + LAMP_MTL)
    write_interlaced(folder / "a.png", side)
    subprocess.run(["oiiotool", "a.png", "--ch", "0,0,0", "--attrib:type=int", "jpeg:progressive", "1", "-o", "a.jpg"],
                   cwd=folder, check=True)


# Each with how many, and how many where it is to be quick; 0: it is left out there.
MADE = (
    (lights, 200_000, 20_000),
    (triangles, 100_000, 0),
    (materials, 100_000, 5000),
    (instances, 100_000, 10_000),
    (textures, 500, 0),
    (textures, 5000, 0),
    (held_whole, 8192, 0),
)

if __name__ == "__main__":
    globals()[sys.argv[1]](pathlib.Path(sys.argv[2]), int(sys.argv[3]))
