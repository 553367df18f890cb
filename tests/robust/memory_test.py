#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Renders within the smallest memory limit that works: the same bits as with room for all, though textures,
triangles and photons are each 8 times as large as their caches and more; and no more resident memory than
the limit, as the system has it.

usage: memory_test.py PM_HOST

With PM_MEMORY=all in the environment the first scene is rendered by photons, which takes minutes.
"""
import os
import pathlib
import sys
import tempfile

from memory_runs import MIB, Runs
from memory_scenes import write_png

# Heights of each quarter of the ground, of which each is kept as a float of 4 bytes: 144 MiB together, while a
# picture alone can be made a texture in less than the render takes. Each tile is met by what is cut.
WIDTH, HEIGHT = 4096, 2304
FACES = 64  # of the ground, along each side


def height_rows():
    for y in range(HEIGHT):
        row = bytes((x * 7 // 64 + y * 5 // 64 + (x * y >> 16)) % 61 + (x // 128 + y // 128) % 2 * 40
                    for x in range(0, WIDTH, 16))  # fmt: skip
        yield b"".join(bytes([v]) * 16 for v in row)


def write_ground(folder):
    mtl = "newmtl lamp\nKd 0 0 0\nKe 40 40 40\n"
    for quarter in range(4):
        write_png(folder / f"heights{quarter}.png", WIDTH, HEIGHT, height_rows(), kind=0)
        mtl += f"newmtl ground{quarter}\nKd 0.5 0.5 0.4\ndisp -bm 2 heights{quarter}.png\n"
    (folder / "ground.mtl").write_text(mtl, encoding="utf-8")
    lines = ["mtllib ground.mtl", "o ground"]
    for y in range(FACES + 1):
        for x in range(FACES + 1):
            lines += [f"v {x - FACES / 2} 0 {FACES / 2 - y}", f"vt {2 * x / FACES} {2 * y / FACES}"]
    at = [[y * (FACES + 1) + x + 1 for x in range(FACES + 1)] for y in range(FACES + 1)]
    half = FACES // 2
    for quarter in range(4):
        lines.append(f"usemtl ground{quarter}")
        for y, x in ((y, x) for y in range(FACES) for x in range(FACES) if 2 * (y // half) + x // half == quarter):
            corners = at[y][x], at[y][x + 1], at[y + 1][x + 1], at[y + 1][x]
            lines.append("f " + " ".join(f"{c}/{c}" for c in corners))
    lines += ["t interpolateboundary 1/0/0 1", "o lamp", "usemtl lamp"]
    lines += [f"v {x} 40 {z}" for x, z in ((-5, -5), (5, -5), (5, 5), (-5, 5))] + ["f -4 -3 -2 -1"]
    (folder / "ground.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")


class CachedRuns(Runs):
    def within(self, scene, caches, *options):
        """caches: of statistics, each with the names of its working set and of what it read or made."""
        code, text, roomy, most = self.run(scene, *options)
        self.check(code == 0, f"{scene} with room for all: {most / MIB:.0f} MiB {text}")
        picture = self.picture()
        limit = self.smallest(scene, *options)
        code, text, _, _ = self.run(scene, *options, "--memory-limit", f"{float(limit) - 0.003}")
        self.check(code == 5, f"{scene}: 3 MiB less than {limit} GiB is refused")
        code, text, stats, most = self.run(scene, *options, "--memory-limit", limit)
        self.check(code == 0, f"{scene} within {limit} GiB {text}")
        if code != 0:
            return
        self.check(self.picture() == picture, f"{scene}: the same bits")
        allowed = float(limit) * 1024 * MIB
        self.check(most <= allowed, f"{scene}: {most / MIB:.0f} of {allowed / MIB:.0f} MiB resident")
        for cache in ("textureCache", "geometryCache", "photonPages"):
            told = stats.get(cache, {"misses": 0, "missesOf": {}})
            counted = sum(told["missesOf"].values())
            self.check((counted > 0) == (told["misses"] > 0), f"{cache}: {counted} misses have a user")
        for cache, working_set, budget, again in caches(roomy, stats):
            self.check(working_set >= 8 * budget,
                       f"{cache}: {working_set / MIB:.0f} MiB through {budget / MIB:.1f} MiB")  # fmt: skip
            self.check(again > 0, f"{cache}: {again} times something was read or made again")


def held(stats, name):
    return max(c["budgetBytes"] for c in stats["caches"]["caches"] if c["name"] == name)


def ground_caches(roomy, stats):
    texels, triangles = stats["textureCache"], stats["geometryCache"]
    yield "textures", roomy["textureCache"]["bytesReadOnce"], held(stats, "textures"), texels["bytesRead"] - texels["bytesReadOnce"]
    cut = roomy["geometryCache"]
    once = cut["bytesMade"] * (cut["misses"] - cut["madeAgain"]) // cut["misses"]
    yield "triangles", once, held(stats, "geometry"), triangles["madeAgain"]


def box_caches(_, stats):
    pages = stats["photonPages"]
    yield "photons", pages["wholeBytes"], held(stats, "photonPages"), pages["madeAgain"]


def main():
    with tempfile.TemporaryDirectory() as name:
        runs = CachedRuns(os.path.abspath(sys.argv[1]), pathlib.Path(name))
        write_ground(runs.folder)
        # Photons read pages below; here gather rays would cut the same triangles again and again.
        by = ("--photons", "2000") if os.environ.get("PM_MEMORY") == "all" else ("--integrator", "path")
        runs.within("ground.obj", ground_caches, "--eye", "0,30,50", "--look-at", "0,0,0", "--fov", "45",
                    "--size", "48x32", "--aa", "1", "--passes", "1", *by)  # fmt: skip
        source = pathlib.Path(__file__).resolve().parents[2]
        runs.within(str(source / "scenes/cornell_box/cornell_box.obj"), box_caches, "--size", "64x48",
                    "--aa", "1", "--passes", "1", "--photons", "2000000")  # fmt: skip
        return 1 if runs.faults else 0


if __name__ == "__main__":
    sys.exit(main())
