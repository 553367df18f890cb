#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Writes materials.obj, .mtl and .pm.json: a board of balls, a row a material, smooth to rough.

usage: make_materials.py [FOLDER]    (the folder of this script)
"""
import json
import pathlib
import sys

ROUGHNESS = (0.05, 0.2, 0.4, 0.8)
ROWS = (  # name, z of the row, statements of its materials
    ("velvet", 4.2, "Kd 0.25 0.04 0.12\nKs 0 0 0\nNi 1\nPs 1\nillum 2\n"),
    ("lacquer", 2.9, "Kd 0.1 0.3 0.75\nPm 1\nPc 1\nPcr 0.05\n"),
    ("plastic", 1.6, "Kd 0.6 0.05 0.04\nKs 0.5 0.5 0.5\nNi 1.5\nillum 2\n"),
    ("glass", 0.3, "Tf 1 1 1\nNi 1.5\nillum 7\n"),
    ("silver", -1.0, "Kd 0.97 0.96 0.92\nPm 1\n"),
    ("gold", -2.3, "Kd 1 0.77 0.34\nPm 1\n"),
)
HEAD = "# SPDX-License-Identifier: Apache-2.0\n# SPDX-FileCopyrightText: The pm authors\n"
OBJ = HEAD + """\
mtllib materials.mtl
v -6 0 -4
v 6 0 -4
v 6 0 12
v -6 0 12
v -6 6 -4
v 6 6 -4
v -3.5 5 -1
v -1 5 -1
v -1 5 1.5
v -3.5 5 1.5
g floor
usemtl floor
f 4 3 2 1
g back_wall
usemtl wall
f 1 2 6 5
g lamp
usemtl lamp
f 7 8 9 10
"""
MTL = HEAD + """\
# Linear Rec.709; Ke in W m^-2 sr^-1 per channel.
newmtl floor
illum 1
Kd 0.5 0.5 0.5
newmtl wall
illum 1
Kd 0.35 0.45 0.6
newmtl lamp
illum 1
Kd 0 0 0
Ke 14 13 12
"""


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent)
    mtl, spheres = MTL, []
    for name, z, statements in ROWS:
        for column, roughness in enumerate(ROUGHNESS):
            mtl += f"newmtl {name}_{column}\n{statements}Pr {roughness}\n"
            spheres.append({"name": f"{name}_{column}", "centre": [round(-1.95 + 1.3 * column, 2), 0.5, z],
                            "radius": 0.5, "material": f"{name}_{column}"})  # fmt: skip
    sidecar = {
        "schema": "pm-sidecar/1",
        "spheres": spheres,
        "cameras": [{"name": "front", "position": [0, 5.6, 9.8], "lookAt": [0, 0.2, 0.6], "fieldOfView": 33}],
    }
    (folder / "materials.obj").write_text(OBJ, encoding="ascii")
    (folder / "materials.mtl").write_text(mtl, encoding="ascii")
    (folder / "materials.pm.json").write_text(json.dumps(sidecar, indent=1) + "\n", encoding="ascii")


if __name__ == "__main__":
    main()
