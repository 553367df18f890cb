# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""The box of caustic_glass and water_basin: 2 x 2 x 2, open in front, a square lamp in its ceiling."""

MATERIALS = """\
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
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
newmtl lamp
illum 1
Kd 0 0 0
Ke {lamp} {lamp} {lamp}
"""


def materials(lamp):
    """MTL of the box; lamp: its radiance, W m^-2 sr^-1 per channel."""
    return MATERIALS.format(lamp=lamp)


def number(x, decimals):
    """So many decimals at most, without trailing zeros and without a negative zero."""
    text = f"{x:.{decimals}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def numbers(xs, decimals):
    return " ".join(number(x, decimals) for x in xs)


def groups(half_lamp):
    """Group, material and quads of the box and its lamp; normals point into the box."""
    top = [(-1, 2, 1), (-1, 2, -1), (1, 2, -1), (1, 2, 1)]
    h = half_lamp
    lamp = [(-h, 2, h), (-h, 2, -h), (h, 2, -h), (h, 2, h)]
    frame = [(top[i], top[(i + 1) % 4], lamp[(i + 1) % 4], lamp[i]) for i in range(4)]
    return [
        ("lamp", "lamp", [lamp]),
        ("ceiling", "white", frame),
        ("floor", "white", [[(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]]),
        ("back_wall", "white", [[(-1, 0, -1), (1, 0, -1), (1, 2, -1), (-1, 2, -1)]]),
        ("red_wall", "red", [[(-1, 0, 1), (-1, 0, -1), (-1, 2, -1), (-1, 2, 1)]]),
        ("green_wall", "green", [[(1, 0, -1), (1, 0, 1), (1, 2, 1), (1, 2, -1)]]),
    ]


def obj_lines(half_lamp, decimals):
    """The box in OBJ; what follows in the file counts its vertices from vertex_count() + 1."""
    index = {}
    for group, material, faces in groups(half_lamp):
        for p in dict.fromkeys(p for face in faces for p in face if p not in index):
            index[p] = len(index) + 1
            yield f"v {numbers(p, decimals)}"
        yield f"g {group}"
        yield f"usemtl {material}"
        for face in faces:
            yield "f " + " ".join(str(index[p]) for p in face)


def vertex_count(half_lamp):
    return len({p for _, _, faces in groups(half_lamp) for face in faces for p in face})
