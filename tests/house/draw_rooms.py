#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Draws docs/images/rooms.svg: the rooms of the code and who includes whom, from the includes.

A matrix, since arrows between so many rooms can't be followed. Outer rooms are above, so that all marks lie
above the diagonal; one below it would be part of a ring.

usage: draw_rooms.py          write the picture
       draw_rooms.py --check  only say whether the picture is that of the includes
"""
import pathlib
import sys

import house_rules
from rooms import PARTS

ROOT = pathlib.Path(__file__).resolve().parents[2]
PICTURE = ROOT / "docs" / "images" / "rooms.svg"
CELL, LEFT, TOP, MARGIN = 22, 218, 200, 12
# Okabe and Ito's colours, which colour-blind eyes keep apart; and a light tone of each.
COLOURS = {
    "host_shim": ("#d55e00", "#fbeadf"),
    "plugin": ("#0072b2", "#e0edf6"),
    "scheduler": ("#a8558a", "#f6eaf2"),
    "integrator": ("#009e73", "#dff3ed"),
}


def part_of(room):
    return room.split("/")[0]


def name_in_part(room):
    """As it is called within its part; the part's own folder by the part's name."""
    return room.removeprefix(part_of(room) + "/")


def ordered(graph):
    """Outer parts and outer rooms first."""
    order = house_rules.ranked(graph)[::-1]
    return [room for part in reversed(PARTS) for room in order if part_of(room) == part]


def element(name, text=None, **attributes):
    words = "".join(f' {key.replace("_", "-")}="{value}"' for key, value in attributes.items())
    return f"<{name}{words}/>" if text is None else f"<{name}{words}>{text}</{name}>"


def bands(rooms):
    """Part -> where it begins in the order, and how many rooms it has."""
    for part in COLOURS:
        mine = [i for i, room in enumerate(rooms) if part_of(room) == part]
        if mine:
            yield part, mine[0], len(mine)


def grounds(rooms):
    """The bands of the parts, across and down, and their names."""
    length = CELL * len(rooms)
    for part, first, count in bands(rooms):
        dark, pale = COLOURS[part]
        at = TOP + CELL * first
        yield element("rect", x=MARGIN, y=at, width=LEFT - MARGIN + length, height=CELL * count, fill=pale)
        x, side = LEFT + CELL * first, CELL * count
        yield element("rect", x=x, y=MARGIN, width=side, height=TOP - MARGIN, fill=pale)
        yield element("rect", x=x, y=at, width=side, height=side, fill="none", stroke=dark, stroke_width=2)
        middle = at + CELL * count / 2
        if count > 2:
            yield element("text", part, x=MARGIN + 14, y=middle, dy="0.35em", fill=dark, font_weight="bold",
                          text_anchor="middle", transform=f"rotate(-90 {MARGIN + 14} {middle})")  # fmt: skip


def labels(rooms):
    for i, room in enumerate(rooms):
        middle = CELL * i + CELL / 2
        # Where a band is too low for its part's name beside it, the rooms have their whole names.
        small = sum(part_of(other) == part_of(room) for other in rooms) <= 2
        name = room if small else name_in_part(room)
        yield element("text", name, x=LEFT - 8, y=TOP + middle, dy="0.35em", text_anchor="end")
        x, y = LEFT + middle, TOP - 8
        yield element("text", name, x=x, y=y, dy="0.35em", transform=f"rotate(-90 {x} {y})")


def lines(rooms):
    length = CELL * len(rooms)
    for i in range(len(rooms) + 1):
        at = CELL * i
        yield element("path", d=f"M{LEFT} {TOP + at}h{length}M{LEFT + at} {TOP}v{length}", stroke="#00000022")


def marks(rooms, graph):
    place = {room: i for i, room in enumerate(rooms)}
    for room, i in place.items():
        dark = COLOURS[part_of(room)][0]
        x, y = LEFT + CELL * i, TOP + CELL * i
        yield element("rect", x=x, y=y, width=CELL, height=CELL, fill="#bbbbbb")
        for other in sorted(graph[room], key=place.get):
            x = LEFT + CELL * place[other] + CELL / 2
            title = element("title", f"{room} includes {other}")
            yield element("circle", title, cx=x, cy=y + CELL / 2, r=6, fill=dark)


def drawing(root):
    """The picture as text."""
    graph = house_rules.room_graph(root)
    rooms = ordered(graph)
    width, height = LEFT + CELL * len(rooms) + MARGIN, TOP + CELL * len(rooms) + MARGIN
    head = (f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
            f'viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="13" fill="#222222">')  # fmt: skip
    rows = [head, element("rect", width=width, height=height, fill="#ffffff"), *grounds(rooms), *lines(rooms),
            element("text", "a row includes", x=MARGIN, y=TOP - 34), element("text", "the columns with a mark",
            x=MARGIN, y=TOP - 16), *labels(rooms), *marks(rooms, graph), "</svg>"]  # fmt: skip
    return "\n".join(rows) + "\n"


def main():
    text = drawing(ROOT)
    if sys.argv[1:] != ["--check"]:
        PICTURE.write_text(text, encoding="utf-8")
        return 0
    if PICTURE.is_file() and PICTURE.read_text(encoding="utf-8") == text:
        return 0
    print(f"{PICTURE.relative_to(ROOT)} is not of the includes as they are: run tests/house/draw_rooms.py")
    return 1


if __name__ == "__main__":
    sys.exit(main())
