#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Pages of the program scroll down only, also on a phone 375 pixels wide: reports of renders, merges and failures with
names of 150 letters and more, the pages of a suite, of a watch, and, with PM_FARM=all, of a farm. A browser
that is installed says how wide each is; without one the pages are only seen to hold what keeps them narrow.

usage: page_width_test.py PM_HOST
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
BOX = ROOT / "scenes" / "cornell_box" / "cornell_box.obj"
SMALL = ["--size", "48x32", "--passes", "3", "-q"]
WIDTHS = (375, 1280)  # CSS pixels
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
ALL = os.environ.get("PM_FARM") == "all"
LONG = "a_name_that_no_line_has_room_for_" * 5
RULES = ("overflow-x: auto", "overflow-wrap: anywhere", "max-width: 100%")
ROOMLESS = 40  # letters of a word that a phone's line has no room for

# In each page: how wide it is, told to the page around it.
TELLS = """<script>onload = () => parent.postMessage(
  NUMBER + " " + innerWidth + " " + document.documentElement.scrollWidth, "*")</script></body>"""
FRAMES = """<body><div></div><script>let told = ""; onmessage = e => { told += "[" + e.data + "]";
  document.querySelector("div").textContent = told }</script>FRAMES</body>"""


def make_pages(host, folder):
    """The pages' files, by what they are of."""
    def run(*words, code=0):
        done = subprocess.run([host, *map(str, words)], cwd=folder, capture_output=True, text=True, timeout=240)
        assert done.returncode == code, f"{done.returncode}: {done.stdout} {done.stderr}"
    (folder / LONG).mkdir()
    run(BOX, *SMALL, "-o", "a.exr")
    run(BOX, *SMALL, "--seed", "2", "--error-target", "1e-6", "-o", f"{LONG}/b.exr", "--reference", "a.exr",
        "--report", "render.html")
    run(f"{LONG}.obj", "-q", "-o", "c.exr", "--report", "failed.html", code=4)
    for half in (1, 2):
        run(BOX, *SMALL, "--bucket-size", "8", "--buckets", f"{half}/2", "-o", f"{half}{LONG}.pmpart")
    parts = [f"{half}{LONG}.pmpart" for half in (1, 2)]
    run("merge", *parts, "-q", "-o", "d.exr", "--report", "merge.html")
    run("watch", *parts, "-o", "e.exr", "--page", "watch.html", "--interval", "0.05")
    pages = {name: folder / f"{name}.html" for name in ("render", "failed", "merge", "watch")}
    suite = {"schema": "pm-suite/1", "references": LONG, "options": SMALL[:4],
             "scenes": [{"name": LONG[:90], "scene": str(BOX), "display": True}]}
    (folder / "suite.json").write_text(json.dumps(suite), encoding="utf-8")
    run("check", "suite.json", "--html", "pages", code=3)  # there are no references
    pages |= {"suite": folder / "pages" / "index.html", "scene": folder / "pages" / "scene" / f"{LONG[:90]}.html"}
    if ALL and shutil.which("parallel"):
        run("farm", BOX, *SMALL, "-o", "g.exr", "--engine", "parallel", "--job", "job", "--runs", "2")
        pages["farm"] = folder / "job" / "farm.html"
    return pages


def look_inside(name, text):
    """What keeps a page narrow and is not there."""
    tree = xml.etree.ElementTree.fromstring(text.replace("<!DOCTYPE html>", ""))
    missing = [f"{name}: no '{rule}'" for rule in RULES if rule not in tree.find("head/style").text]
    if not any("width=device-width" in tag.get("content", "") for tag in tree.iter("meta")):
        missing.append(f"{name}: a phone shows it as if it were wider")
    for cell in tree.iter("td") if name != "suite" else []:
        words = "".join(cell.itertext()).split()
        if any(len(word) > ROOMLESS for word in words) and cell.get("class") != "long":
            missing.append(f"{name}: a cell's words may not break: {words}")
    return missing


def measure(browser, pages, folder):
    """What is wider than its window, as a browser lays it out."""
    windows = [(name, file, width) for name, file in pages.items() for width in WIDTHS]
    frames = ""
    for number, (_, file, width) in enumerate(windows):
        shown = folder / f"shown{number}.html"
        shown.write_text(re.sub("</body>", lambda _: TELLS.replace("NUMBER", str(number)),
                                file.read_text(encoding="utf-8")), encoding="utf-8")
        frames += f'<iframe src="{shown.name}" width="{width}" height="800" style="border:0"></iframe>'
    (folder / "windows.html").write_text(FRAMES.replace("FRAMES", frames), encoding="utf-8")
    done = subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
                           f"--user-data-dir={folder / 'browser'}", "--virtual-time-budget=10000", "--dump-dom",
                           (folder / "windows.html").as_uri()], capture_output=True, text=True, timeout=120)
    told = {int(n): (int(window), int(page))
            for n, window, page in re.findall(r"\[(\d+) (\d+) (\d+)\]", done.stdout)}
    found = []
    for number, (name, _, width) in enumerate(windows):
        if number not in told or told[number][0] != width:
            found.append(f"{name}: {browser} did not show it {width} pixels wide: {done.stderr[-300:]}")
        elif told[number][1] > width:
            found.append(f"{name}: {told[number][1]} pixels wide in a window of {width}")
    return found


def main():
    host = pathlib.Path(sys.argv[1]).resolve()
    os.environ.pop("OCIO", None)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        folder = pathlib.Path(name)
        os.environ["XDG_CACHE_HOME"] = str(folder / "cache")
        pages = make_pages(host, folder)
        found = [line for page, file in pages.items() for line in look_inside(page, file.read_text(encoding="utf-8"))]
        browser = next(filter(shutil.which, BROWSERS), None)
        if browser:
            found += measure(browser, pages, folder)
    for line in found:
        print(line)
    print(f"{len(pages)} pages, {'by ' + browser if browser else 'no browser is there'}: {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
