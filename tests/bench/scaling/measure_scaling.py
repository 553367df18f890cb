#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""How renders scale with their workers: wall seconds of each phase by 1, 2, 4, ... workers, what of them is serial,
and how processor time grows. Four scenes of 512 x 512: the three neutral ones and a hall of 300,000 triangles.

usage: measure_scaling.py PM_HOST [--before PM_HOST] [--peers FOLDER] [--hall SCRIPT] [--turns N] [--most N]
                          [--scenes NAME,...] [--docs FILE]

Serial: by two numbers of workers n and m, wall w(n) and w(m) of a phase, the part s of w(1) for which
w(n) = s + (w(1) - s) / n; by the least and the most workers there are, the median of the turns. With --before
another build takes turns with this one. --docs puts the table between the lines of that file that say where.
"""
import argparse
import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "run"))
import docs_page  # noqa: E402

SHARED = HERE.parents[3] / "shared"
HALL_VIEW = "--eye -9,2.2,5.2 --look-at 4,.6,-2 --fov 50"
# Of pm_host's statistics, one after the other; startSeconds is what is left of the process's whole time.
PHASES = ("startSeconds", "readSceneSeconds", "buildSceneSeconds", "pilotSeconds", "beginPassSeconds",
          "renderSeconds", "otherRenderSeconds", "writePicturesSeconds")  # fmt: skip


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("host", type=pathlib.Path)
    parser.add_argument("--before", type=pathlib.Path)
    parser.add_argument("--peers", type=pathlib.Path, default=SHARED / "peers")
    parser.add_argument("--hall", type=pathlib.Path, default=SHARED / "cases/glossy_hall/make_hall.py")
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--most", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--scenes", default="")
    parser.add_argument("--docs", type=pathlib.Path)
    return parser.parse_args()


def make_scenes(options, folder):
    """name -> command line of its file and view."""
    scenes = {}
    converter = options.peers / "neutral_to_obj.py"
    if converter.is_file():
        subprocess.run([sys.executable, converter, options.peers / "scenes.json", folder], check=True,
                       stdout=subprocess.DEVNULL)  # fmt: skip
        for key, scene in json.loads((options.peers / "scenes.json").read_text()).items():
            file = next((f for f in folder.glob("*.obj") if f.stem in (key, scene.get("name", ""))), None)
            if file and "cam" in scene:
                camera = scene["cam"]
                point = lambda name: ",".join(str(v) for v in camera[name])
                scenes[file.stem] = [file, "--eye", point("pos"), "--look-at", point("look"), "--up", point("up"),
                                     "--fov", str(camera["vfov"])]  # fmt: skip
    if options.hall.is_file():
        subprocess.run([sys.executable, options.hall, folder / "hall.obj"], check=True)
        scenes["hall"] = [folder / "hall.obj", *HALL_VIEW.split()]
    if options.scenes:
        scenes = {name: scene for name, scene in scenes.items() if name in options.scenes.split(",")}
    if not scenes:
        sys.exit("measure_scaling.py: no scenes: neither neutral ones nor a hall are there")
    return scenes


def render(host, scene, workers, folder):
    """phase -> wall seconds, with "wall" and "processor" of the whole process."""
    passes = "2" if scene[0].stem == "hall" else "4"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [host, *scene, "--size", "512x512", "--passes", passes, "--threads", str(workers), "-q",
               "-o", folder / "o.exr", "-o", folder / "o.png", "--stats", folder / "o.json"]  # fmt: skip
    begun = os.times().elapsed
    subprocess.run([str(word) for word in command], check=True, cwd=folder)
    wall = os.times().elapsed - begun
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    told = json.loads((folder / "o.json").read_text())["phases"]
    found = {phase: told.get(phase, 0.0) for phase in PHASES}
    known = found["beginPassSeconds"] + found["renderSeconds"]
    found["otherRenderSeconds"] = max(0.0, told["renderCallSeconds"] - known)
    found["startSeconds"] = 0.0
    found["startSeconds"] = max(0.0, wall - sum(found.values()))
    found["wall"] = wall
    found["processor"] = sum(getattr(after, k) - getattr(before, k) for k in ("ru_utime", "ru_stime"))
    return found


def serial_seconds(one, most, workers):
    """Of a phase by its wall seconds with one worker and with the most."""
    return min(one, max(0.0, (workers * most - one) / (workers - 1)))


def measure(options, scenes, folder):
    """(build, scene, workers) -> renders of all turns."""
    counts = [n for n in (1, 2, 4, 8, 16, 32, 64) if n <= options.most]
    builds = {"this": options.host.resolve()}
    if options.before:
        builds = {"before": options.before.resolve()} | builds
    renders = {}
    for _ in range(options.turns):
        for name, scene in scenes.items():
            for workers in counts:
                for build, host in builds.items():
                    renders.setdefault((build, name, workers), []).append(render(host, scene, workers, folder))
    return builds, counts, renders


def table(options, scenes, builds, counts, renders):
    most = counts[-1]
    lines = [f"Serial seconds by phase, from 1 and {most} workers; 512 x 512, {options.turns} turns.", ""]
    head = ["scene", "build", *(f"{n} workers, s" for n in counts), "processor time, most over 1", "serial share",
            *(phase.removesuffix("Seconds") for phase in PHASES)]  # fmt: skip
    lines += ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for name in scenes:
        for build in builds:
            middle = lambda key, n: statistics.median(r[key] for r in renders[build, name, n])
            growth = statistics.median(
                b["processor"] / a["processor"]
                for a, b in zip(renders[build, name, 1], renders[build, name, most])
            )
            serial = [serial_seconds(middle(phase, 1), middle(phase, most), most) if most > 1 else 0.0
                      for phase in PHASES]  # fmt: skip
            lines.append("| " + " | ".join([
                name, build, *(f"{middle('wall', n):.2f}" for n in counts), f"{growth:.2f}",
                f"{100 * sum(serial) / middle('wall', 1):.1f} %", *(f"{s:.2f}" for s in serial)]) + " |")  # fmt: skip
    return "\n".join(lines) + "\n"


def main():
    options = arguments()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scenes = make_scenes(options, folder)
        text = table(options, scenes, *measure(options, scenes, folder))
    print(text)
    if options.docs:
        docs_page.put(options.docs, "scaling", text)


if __name__ == "__main__":
    main()
