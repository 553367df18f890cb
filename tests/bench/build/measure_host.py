#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""What two builds of pm_host take for what a host does: reading an OBJ of 300,000 faces, an MTL of 20,000
materials, baking a texture of 4096 x 4096, writing EXR and PNG of as many pixels.

usage: measure_host.py OLD_PM_HOST NEW_PM_HOST [TURNS]

Rows of docs/lab/build.md: processor seconds, the median of the turns (3) and their range; rivals take turns.
"""
import math
import os
import pathlib
import random
import resource
import shutil
import statistics
import struct
import subprocess
import sys
import tempfile
import zlib

LAMP = "newmtl lamp\nKe 5 5 5\nKd 0 0 0\n"
LAMP_FACE = "usemtl lamp\nv 0 5 0\nv 5 5 0\nv 5 5 5\nv 0 5 5\nf -4 -3 -2 -1\n"
SIDE, MATERIALS, TEXELS = 548, 20000, 4096
WORK = {
    "OBJ of 300,000 faces": ("grid.obj", "--explain"),
    "MTL of 20,000 materials": ("materials.obj", "--explain"),
    "baking 4096 x 4096": ("textured.obj", "--explain"),
    "EXR and PNG, 4096 x 4096": ("textured.obj", "--integrator", "path", "--size", "4096x4096", "--passes", "1",
                                 "--aa", "1", "--eye", "0,1,20", "--look-at", "40,0,40", "-o", "o.exr", "-o", "o.png", "-q"),
}  # fmt: skip


def write_grid(folder):
    (folder / "grid.mtl").write_text("newmtl grid\nKd .5 .5 .5\n" + LAMP)
    points = [(x, y) for y in range(SIDE + 1) for x in range(SIDE + 1)]
    lines = [f"v {x * .01:.4f} {math.sin(x * .05) * math.cos(y * .04) * .2:.6f} {y * .01:.4f}" for x, y in points]
    lines += [f"vt {x / SIDE:.6f} {y / SIDE:.6f}" for x, y in points]
    lines.append("usemtl grid")
    for y in range(SIDE):
        for a in range(y * (SIDE + 1) + 1, y * (SIDE + 1) + SIDE + 1):
            d = a + SIDE + 1
            lines.append(f"f {d}/{d} {d + 1}/{d + 1} {a + 1}/{a + 1} {a}/{a}")
    (folder / "grid.obj").write_text("mtllib grid.mtl\n" + "\n".join(lines) + "\n" + LAMP_FACE)


def write_materials(folder):
    (folder / "materials.mtl").write_text("".join(
        f"newmtl m{i}\nNs {10 + i % 200}\nKd .{i % 9 + 1} .2 .3\nKs .1 .1 .1\nNi 1.45\nd 1\nillum 2\n"
        f"Pr .{i % 9 + 1}\nPm 0\n" for i in range(MATERIALS)) + LAMP)  # fmt: skip
    (folder / "materials.obj").write_text("mtllib materials.mtl\n" + "".join(
        f"v {i % 141} 0 {i // 141}\nv {i % 141 + .9} 0 {i // 141}\nv {i % 141} 0 {i // 141 + .9}\n"
        f"usemtl m{i}\nf -1 -2 -3\n" for i in range(MATERIALS)) + LAMP_FACE)  # fmt: skip


def write_texture(folder):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    row = random.Random(1).randbytes(3 * TEXELS)
    rows = b"".join(b"\0" + row[y % 97 * 3 :] + row[: y % 97 * 3] for y in range(TEXELS))
    (folder / "texels.png").write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", TEXELS, TEXELS, 8, 2, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b""))  # fmt: skip
    (folder / "textured.mtl").write_text("newmtl wall\nKd 1 1 1\nmap_Kd texels.png\n" + LAMP)
    (folder / "textured.obj").write_text(
        "mtllib textured.mtl\nv 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        "usemtl wall\nf 4/4 3/3 2/2 1/1\n" + LAMP_FACE)  # fmt: skip


def processor_seconds(host, words, folder):
    shutil.rmtree(folder / "cache", ignore_errors=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([host, *words], cwd=folder, check=True, stdout=subprocess.DEVNULL,
                   env={**os.environ, "XDG_CACHE_HOME": str(folder / "cache")})  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def told(seconds):
    return f"{statistics.median(seconds):.2f} ({min(seconds):.2f} to {max(seconds):.2f})"


def main():
    hosts = [os.path.abspath(host) for host in sys.argv[1:3]]
    turns = int(sys.argv[3]) if len(sys.argv) > 3 else 3
    with tempfile.TemporaryDirectory(prefix="pm-host-") as name:
        folder = pathlib.Path(name)
        for write in (write_grid, write_materials, write_texture):
            write(folder)
        for what, words in WORK.items():
            seconds = [[], []]
            for turn in range(turns):
                for i in (0, 1) if turn % 2 == 0 else (1, 0):
                    seconds[i].append(processor_seconds(hosts[i], words, folder))
            ratio = statistics.median(seconds[1]) / statistics.median(seconds[0])
            print(f"| `pm_host`, {what}, processor seconds | {told(seconds[0])} | {told(seconds[1])} | {ratio:.2f} |", flush=True)


if __name__ == "__main__":
    main()
