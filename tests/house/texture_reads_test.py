#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""A frame reads a tenth of its textures at most: a room with four pictures of 1024 x 1024 in 160 x 120
pixels, as many texels a pixel as 4096 x 4096 in 640 x 480. The cache is planned within the memory limit.
Pictures in tiles are looked up by their numbers.

usage: texture_reads_test.py PM_HOST
"""
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

SIZE, SQUARES = 1024, 16


def write_checker(path, colours):
    side = SIZE // SQUARES
    rows = [b"\0" + b"".join(bytes(colours[(i + j) % 2]) * side for i in range(SQUARES))
            for j in range(SQUARES)]  # fmt: skip

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    path.write_bytes(b"\x89PNG\r\n\x1a\n"
                     + chunk(b"IHDR", struct.pack(">IIBBBBB", SIZE, SIZE, 8, 2, 0, 0, 0))
                     + chunk(b"IDAT", zlib.compress(b"".join(row * side for row in rows)))
                     + chunk(b"IEND", b""))  # fmt: skip


def write_room(folder):
    quads = [("t0", (-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)),
             ("t1", (-2, 0, -2), (2, 0, -2), (2, 3, -2), (-2, 3, -2)),
             ("t2", (-2, 0, 2), (-2, 0, -2), (-2, 3, -2), (-2, 3, 2)),
             ("t3", (2, 0, -2), (2, 0, 2), (2, 3, 2), (2, 3, -2)),
             ("lamp", (-0.5, 3, -0.5), (0.5, 3, -0.5), (0.5, 3, 0.5), (-0.5, 3, 0.5))]  # fmt: skip
    lines = ["mtllib room.mtl", "vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1"]
    for i, (material, *corners) in enumerate(quads):
        lines += ["v {} {} {}".format(*corner) for corner in corners]
        lines += [f"usemtl {material}", "f " + " ".join(f"{4 * i + k}/{k}" for k in (1, 2, 3, 4))]
    (folder / "room.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
    materials = ["newmtl lamp\nKd 0 0 0\nKe 12 12 12"]
    for i in range(4):
        write_checker(folder / f"t{i}.png", [(60 * i, 90, 40), (240, 230, 250 - 60 * i)])
        materials.append(f"newmtl t{i}\nKd 1 1 1\nmap_Kd t{i}.png")
    (folder / "room.mtl").write_text("\n".join(materials) + "\n", encoding="utf-8")


def render(host, folder, *options):
    command = [host, "room.obj", "--eye", "0,1.5,5.5", "--look-at", "0,1.4,0", "--fov", "40", "--size",
               "160x120", "--aa", "1", "--passes", "1", "-o", "room.exr", "--stats", "stats.json",
               *options]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder,
                          env={**os.environ, "XDG_CACHE_HOME": str(folder / "cache")})  # fmt: skip
    if done.returncode != 0:
        sys.exit(f"pm_host ended with {done.returncode}: {done.stderr}")
    return json.loads((folder / "stats.json").read_text(encoding="utf-8")), done.stderr


def main():
    host = sys.argv[1]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_room(folder)
        for integrator in ("photon", "path"):
            statistics, _ = render(host, folder, "--integrator", integrator, "--memory-limit", "1")
            cache = statistics["textureCache"]
            print(integrator, cache)
            assert cache["texels"] == 4 * SIZE * SIZE, cache
            assert 0 < cache["texelsRead"] <= cache["texels"] / 10, cache
            assert cache["misses"] >= cache["tilesReadOnce"] > 0, cache
            assert cache["bytesRead"] >= cache["bytesReadOnce"] > 0, cache
            planned = statistics["memory"]["plannedTextureBytes"]
            assert 0 < planned <= (1 << 30) / 8, planned
        test_tiles(host, folder)


def test_tiles(host, folder):
    """A wall that is tile 1002 is the same as one that has that picture alone; without it, it is black."""
    text = (folder / "room.mtl").read_text(encoding="utf-8")
    pictures = {}
    for name, statement in (("alone", "-clamp on t3.png"), ("tiles", "-o 1 0 0 t.<UDIM>.png"),
                            ("absent", "-o 2 0 0 t.<UDIM>.png")):  # fmt: skip
        (folder / "room.mtl").write_text(text.replace("map_Kd t3.png", "map_Kd " + statement), encoding="utf-8")
        if name == "tiles":
            shutil.copy(folder / "t0.png", folder / "t.1001.png")
            shutil.copy(folder / "t3.png", folder / "t.1002.png")
        _, told = render(host, folder)
        assert "warning" not in told, told
        pictures[name] = shutil.move(folder / "room.exr", folder / f"{name}.exr")
    same = subprocess.run(["idiff", pictures["alone"], pictures["tiles"]], capture_output=True, text=True)
    assert same.returncode == 0, same.stdout
    other = subprocess.run(["idiff", pictures["tiles"], pictures["absent"]], capture_output=True, text=True)
    assert other.returncode != 0, "the tile is not looked up"
    (folder / "t.1001.png").unlink()
    (folder / "t.1002.png").unlink()
    _, told = render(host, folder)
    assert "t.<UDIM>.png" in told, told


if __name__ == "__main__":
    main()
