#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Error times processor time of two builds of pm_host on scenes as people have them (everyday_scenes.py).

usage: measure_everyday.py BEFORE_PM_HOST AFTER_PM_HOST [--turns N] [--scenes NAME,...] [--size WxH] [--passes N]
                           [--cycles SAMPLES] [--docs FILE]

A turn renders each scene by two seeds with each build, one after the other. The error is the noise's relMSE, half of
what two seeds differ by, squared; processor time is that of the whole run. Told are medians of the turns, and the
least and the most of the ratios. --cycles renders `outdoors` in Blender's Cycles beside them, at the same error scale;
its processor time is that of the render call. --docs puts the table between the lines of that file that say where.
"""
import argparse
import json
import pathlib
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "run")]
import docs_page  # noqa: E402
import everyday_scenes  # noqa: E402


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("before", type=pathlib.Path)
    parser.add_argument("after", type=pathlib.Path)
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--scenes", default=",".join(everyday_scenes.VIEWS))
    parser.add_argument("--size", default="192x144")
    parser.add_argument("--passes", default="4")
    parser.add_argument("--cycles", type=int, default=0)
    parser.add_argument("--docs", type=pathlib.Path)
    return parser.parse_args()


def pixels(file):
    """R, G, B of each, by oiiotool; they are the first channels."""
    text = subprocess.run(["oiiotool", "--dumpdata", file], capture_output=True, text=True, check=True).stdout
    return [float(v) for line in re.findall(r"Pixel \(\d+, \d+\): (.*)", text) for v in line.split()[:3]]


def noise(a, b, stops):
    """relMSE of one picture, by two that share no noise, at their error scale."""
    offset = 0.01 * 4.0**-stops
    both = [((x + y) / 2, x - y) for x, y in zip(pixels(a), pixels(b), strict=True)]
    return sum(d * d / (2 * (m * m + offset)) for m, d in both) / len(both)


def render(host, name, seed, options, folder):
    """The picture, the processor seconds of the run, and what it told of itself."""
    picture, told = folder / f"{name}_{seed}.exr", folder / "told.json"
    command = [host, folder / f"{name}.obj", *everyday_scenes.VIEWS[name].split(), "--size", options.size, "--passes",
               options.passes, "--seed", str(seed), "-q", "-o", picture, "--stats", told]  # fmt: skip
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([str(word) for word in command], check=True, cwd=folder, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = sum(getattr(after, k) - getattr(before, k) for k in ("ru_utime", "ru_stime"))
    told = json.loads(told.read_text())
    return {"picture": picture, "seconds": seconds, "build": told["phases"]["buildSceneSeconds"],
            "stops": told.get("errorScaleStops", 0), "told": told["relMseEstimate"], "rays": told["counters"]["rays"]}  # fmt: skip


def turn(host, name, options, folder):
    first, second = (render(host, name, seed, options, folder) for seed in (1, 2))
    return {"noise": noise(first["picture"], second["picture"], first["stops"]),
            **{k: (first[k] + second[k]) / 2 for k in ("seconds", "build", "told", "rays", "stops")}}  # fmt: skip


def rows(name, turns):
    """A row for each build, with the ratio of noise times time of this one over the one before."""
    ratios = [after["noise"] * after["seconds"] / (before["noise"] * before["seconds"]) for before, after in turns]
    for which, label in enumerate(("before", "after")):
        middle = lambda key, w=which: statistics.median(pair[w][key] for pair in turns)
        ratio = f"{statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})" if which else ""
        yield (f"| {name} | {label} | {middle('noise'):.2e} | {middle('told'):.2e} | {middle('seconds'):.1f} | "
               f"{middle('build'):.2f} | {middle('rays') / 1e6:.2f} | {ratio} |")  # fmt: skip


def cycles_text(options, ours, folder):
    """A line that holds Cycles' noise and time on the outdoor scene to this build's."""
    view = everyday_scenes.VIEWS["outdoors"].split()
    of = lambda option: view[view.index(option) + 1]
    seconds, pictures = [], []
    for seed in (1, 2):
        pictures.append(folder / f"cycles_{seed}.exr")
        command = ["blender", "-b", "--factory-startup", "-noaudio", "-P", HERE / "cycles_outdoors.py", "--",
                   folder / "outdoors.obj", folder / of("--environment"), of("--eye"), of("--look-at"), of("--fov"),
                   options.size, options.cycles, seed, pictures[-1]]  # fmt: skip
        said = subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout
        seconds.append(float(re.search(r"^cycles (\S+)", said, re.MULTILINE)[1]))
    found, took = noise(*pictures, ours["stops"]), statistics.mean(seconds)
    return (f"Cycles, {options.cycles} samples of `outdoors`: noise {found:.2e} in {took:.1f} s of processor time; noise x time "
            f"is {found * took / (ours['noise'] * ours['seconds']):.2f} times this build's.\n")  # fmt: skip


def main():
    options = arguments()
    hosts = [options.before.resolve(), options.after.resolve()]
    names = options.scenes.split(",")
    if not shutil.which("oiiotool"):
        sys.exit("measure_everyday.py: oiiotool, which reads the pictures, is not installed")
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for name in names:
            everyday_scenes.WRITERS[name](folder)
        # Prepared textures are kept; the first to ask makes them.
        for name in names:
            subprocess.run([hosts[1], folder / f"{name}.obj", "--explain"], check=True, stdout=subprocess.DEVNULL,
                           stderr=subprocess.DEVNULL)  # fmt: skip
        found = {name: [] for name in names}
        for _ in range(options.turns):
            for name in names:
                found[name].append([turn(host, name, options, folder) for host in hosts])
        beside = cycles_text(options, found["outdoors"][-1][1], folder) if options.cycles else ""
    lines = [f"{options.size}, {options.passes} passes, two seeds, {options.turns} turns; processor seconds of a whole "
             "run.", "", "| scene | build | noise, relMSE | told | processor, s | building the scene, s | million rays "
             "| noise x time, after over before |", "|---|---|---|---|---|---|---|---|"]  # fmt: skip
    for name in names:
        lines += rows(name, found[name])
    text = "\n".join(lines) + "\n" + ("\n" + beside if beside else "")
    print(text)
    if options.docs:
        docs_page.put(options.docs, "everyday", text)


if __name__ == "__main__":
    main()
