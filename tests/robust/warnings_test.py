#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Each example of docs/warnings.md is a line that pm_host says of a small scene, word for word but for numbers.

usage: warnings_test.py PM_HOST
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "copies"))
from server import Server  # noqa: E402

FLOOR = "v -1 0 -1\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nusemtl wood\nf 1 2 3 4\n"
LIGHT = "v -.1 2 -.1\nv .1 2 -.1\nv .1 2 .1\nv -.1 2 .1\nusemtl light\nf 5 6 7 8\n"
QUICK = ("--size", "16x16", "--passes", "2", "--photons", "500", "--aa", "1")


def room(wood="Kd .5 .5 .5\n", more="", light=LIGHT):
    """A floor of wood under a light."""
    return {"room.obj": "mtllib room.mtl\n" + FLOOR + light + more,
            "room.mtl": f"newmtl wood\n{wood}newmtl light\nKd 0 0 0\nKe 5 5 5\n"}


# Two walls that face each other and shine so brightly that their light and its reflection are beyond a float.
BRIGHT = {"room.obj": "mtllib room.mtl\nv -1 0 0\nv 1 0 0\nv 1 2 0\nv -1 2 0\nv -1 0 2\nv 1 0 2\nv -.5 2 0\nv .5 2 0\n"
                      "v .5 2 1\nv -.5 2 1\nusemtl wood\nf 1 2 3 4\nf 5 6 2 1\nusemtl light\nf 7 8 9 10\n",
          "room.mtl": "newmtl wood\nKd .9 .9 .9\nKe 3e38 3e38 3e38\nnewmtl light\nKd .9 .9 .9\nKe 3e38 3e38 3e38\n"}

# Of each code: the files of a scene, and what it is rendered with.
RENDERS = {
    1001: ({"room.obj": "mtllib room.mtl\n" + FLOOR}, []),
    1002: ({**room(), "room.mtl": "newmtl light\nKe 5 5 5\n"}, []),
    1003: (room("Kd 204 120 40\n"), []),
    1004: (room("Kd .5 .5 .5\nPr .5\nPm 1\nmap_Ps sheen.png\n"), []),
    1005: (room("map_Kd wood.png\n"), []),
    1006: (room(more="l 1 2\n"), []),
    1007: (room(more="t crop 0/0/0\n"), []),
    1008: (room(light=""), []),
    1009: (room(), ["--eye", "0,3,0", "--look-at", "0,0,0", "--up", "0,1,0"]),
    1010: (room("Kd 0 0 0\nKe 1e6 1e6 1e6\n"), ["--exr-half"]),
    1011: (room(light=""), ["--camera-light", "off"]),
    1012: (BRIGHT, []),
    1015: ({"room.pov": "sphere { 0, 1 }\n#fopen F \"a.txt\" write\n"}, []),
}


class Room:
    """A scene in a folder."""

    def __init__(self, folder, host, files):
        self.folder, self.host = folder, host
        self.variables = {key: value for key, value in os.environ.items() if key not in ("OCIO", "PM_PLUGIN_PATH")}
        self.variables["XDG_CACHE_HOME"] = str(folder / "cache")
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8")

    def said(self, *words):
        done = subprocess.run([self.host, *words], cwd=self.folder, env=self.variables, capture_output=True, text=True)
        return done.stderr

    def render(self, *words):
        return self.said(*words, *QUICK, "-o", "room.exr")

    def flip(self, file):
        os.chmod(file, 0o644)
        content = bytearray(file.read_bytes())
        content[len(content) // 2] ^= 1
        file.write_bytes(content)


def of_damaged_part(room):
    """1013; nothing where GNU parallel is not installed."""
    if shutil.which("parallel") is None:
        return None
    words = ("farm", "room.obj", "--engine", "parallel", "--runs", "1", "--job", "job")
    room.render(*words)
    room.flip(room.folder / "job" / "parts" / "0001.pmpart")
    return room.render(*words)


def of_damaged_copy(room):
    """1014."""
    room.said("pack", "room.obj", "-o", "pack")
    server = Server(room.folder / "pack")
    try:
        copies = ("--copies", "copies")
        room.render(server.url(), *copies)
        room.flip(max((room.folder / "copies" / "objects").glob("*/*"), key=lambda file: file.stat().st_size))
        return room.render(server.url(), *copies)
    finally:
        server.close()


def plain(text):
    """Without what is another each time: numbers, names of contents, and folders."""
    text = re.sub(r"\S*/objects/\S+:", "OBJECT:", text)
    text = re.sub(r"\S*/(?=job/parts)", "", text)
    return re.sub(r"[0-9][0-9.e+-]*", "N", text)


def said_of(code, folder, host):
    if code in RENDERS:
        files, words = RENDERS[code]
        return Room(folder, host, files).render(next(iter(files)), *words)
    return {1013: of_damaged_part, 1014: of_damaged_copy}[code](Room(folder, host, room()))


def codes_of(file, pattern):
    return {int(code) for code in re.findall(pattern, (ROOT / file).read_text(encoding="utf-8"))}


def main():
    host = pathlib.Path(sys.argv[1]).resolve()
    page = (ROOT / "docs" / "warnings.md").read_text(encoding="utf-8")
    rows = {int(code): example for code, example in re.findall(r"^\| (1\d{3}) \|[^|]*\| `([^`]*)` \|", page, re.MULTILINE)}
    codes = codes_of("host_shim/formats/warnings.h", r"= (1\d{3}),")
    assert set(rows) == codes, f"docs/warnings.md has {sorted(set(rows) ^ codes)} too many or too few"
    failures = []
    for code, example in sorted(rows.items()):
        with tempfile.TemporaryDirectory() as name:
            said = said_of(code, pathlib.Path(name), host)
        if said is None:
            print(f"{code} is left out: GNU parallel is not installed")
            continue
        lines = [line.split("warning: ", 1)[1] for line in said.splitlines() if "warning: " in line]
        if plain(example) not in [plain(line) for line in lines]:
            failures.append(f"{code}: `{example}` is not among\n  " + "\n  ".join(lines))
    assert not failures, "\n".join(failures)


if __name__ == "__main__":
    main()
