#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""What pm_bench_farm replays: costs of frames in processor seconds of one thread, latencies of Slurm, and
real farms to hold the replay against, on a cluster of this machine's own.

usage: measure_farm.py PM_HOST OUT.json [--quick] [--turns N]
"""
import argparse
import csv
import json
import math
import os
import pathlib
import signal
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests" / "farm"))
from cluster import Cluster, environment, missing_programs, stop  # noqa: E402
from job import Farm  # noqa: E402

BOX = ROOT / "scenes" / "cornell_box" / "cornell_box.obj"
GLASS = ROOT / "scenes" / "caustic_glass" / "caustic_glass.obj"
FRAMES = (
    ("a box, photon maps", BOX, (), "640x360"),
    ("a box, photon maps, --aa 5", BOX, ("--aa", "5"), "640x360"),
    ("a box, paths", BOX, ("--integrator", "path"), "640x360"),
    ("glass, photon maps, --aa 5", GLASS, ("--aa", "5"), "640x360"),
)
BUCKETS = ("--bucket-size", "16")
TURNS = 3
WORKERS = (1, 2, 4)
RUNS = 8
PREEMPTED_EVERY = 30.0  # processor seconds
TINY = ("--size", "64x48", "--bucket-size", "8", "--passes", "1", "--threads", "1")


class Bench:
    def __init__(self, host, folder):
        self.host, self.folder = host, pathlib.Path(folder)
        self.variables = environment(XDG_CACHE_HOME=str(self.folder / "cache"))

    def start(self, *words):
        with open(self.folder / "log", "w") as log:
            return subprocess.Popen([self.host, *map(str, words)], cwd=self.folder, env=self.variables,
                                    stdin=subprocess.DEVNULL, stdout=log, stderr=log)

    def end(self, process, codes=(0,)):
        """Processor seconds that it took."""
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode not in codes:
            raise SystemExit(f"measure_farm.py: pm_host: {process.returncode}: {(self.folder / 'log').read_text()}")
        return usage.ru_utime + usage.ru_stime

    def run(self, *words):
        return self.end(self.start(*words))

    def frame(self, name, scene, options, size, passes):
        print(f"measure_farm.py: {name}, {size}", file=sys.stderr)
        file = lambda suffix: self.folder / f"frame.{suffix}"
        words = [scene, *options, "--size", size, "--threads", "1", "-q"]
        all_passes = ("--passes", str(passes))
        whole = photons = start = maps = math.inf
        buckets = []
        # Some are elapsed seconds, in which other programs have a part: the least of some turns has little.
        for _ in range(TURNS):
            whole = min(whole, self.run(*words, *all_passes, "--bucket-times", file("csv"), "--stats", file("json"),
                                        "-o", file("pmpart")))
            with open(file("csv")) as lines:
                turn = [float(row["seconds"]) for row in csv.DictReader(lines)]
            buckets = [min(both) for both in zip(buckets or turn, turn)]
            photons = min(photons, self.phase("photonSeconds"))
        photon_bytes, reads = 0, ()
        if photons > 0:
            map_file = file("pmphotons")
            self.run(*words, *all_passes, "--photons-only", "--photon-map", map_file)
            photon_bytes, reads = map_file.stat().st_size, ("--photon-map", map_file)
        for _ in range(TURNS):  # what a run costs besides its buckets
            alone = self.run(*words, *all_passes, *reads, "--buckets", "0:1", "--stats", file("json"), "-o",
                             self.folder / "one.pmpart")
            maps = min(maps, self.phase("beginPassSeconds"))
            start = min(start, max(0.0, alone - maps - buckets[0]))
        merge = self.run("merge", file("pmpart"), "-o", file("exr"), "-o", file("png"), "-q")
        pilot, predicted = self.pilot(words[:-1] + [*all_passes], len(buckets))
        staged = sum(part.stat().st_size for part in scene.parent.iterdir() if part.is_file())
        return {"name": name, "size": size, "passes": passes, "buckets": buckets,
                "pilot": predicted, "pilotSeconds": pilot, "startSeconds": start,
                "mapSeconds": maps, "photonSeconds": photons, "mergeSeconds": merge, "sceneBytes": staged,
                "photonBytes": photon_bytes, "partBytes": file("pmpart").stat().st_size, "wholeSeconds": whole}

    def pilot(self, words, buckets):
        """Processor seconds until a farm has its plan, and what it predicts of each bucket; the least of some turns."""
        seconds, predicted = math.inf, []
        for _ in range(TURNS):
            job = pathlib.Path(tempfile.mkdtemp(dir=self.folder))
            seconds = min(seconds, self.run("farm", *words, "--engine", "commands", "--runs", buckets, "--job", job / "job",
                                            "-o", "pilot.exr"))
            tasks = json.loads((job / "job" / "plan.json").read_text())["tasks"]
            its = [task["predictedThreadSeconds"] for task in tasks if task["kind"] == "run"]
            assert len(its) == buckets, f"{len(its)} runs of {buckets} buckets"
            predicted = [min(both) for both in zip(predicted or its, its)]
        return seconds, predicted

    def phase(self, name):
        """Elapsed seconds of the last frame."""
        return json.loads((self.folder / "frame.json").read_text())["phases"].get(name, 0.0)

    def shared_speed(self, words):
        """Of a thread where another one is at work, over one alone."""
        alone = self.run(*words, "-o", "a.exr")
        count = os.cpu_count()
        together = [self.end(p) for p in [self.start(*words, "-o", f"{i}.exr") for i in range(count)]]
        return min(1.0, alone / statistics.mean(together))

    def preempted(self, words):
        """Processor seconds of a render that is ended again and again, and of one that isn't."""
        whole = self.run(*words, "-o", "p.pmpart")
        done, starts = 0.0, 0
        while True:
            process = self.start(*words, "-o", "q.pmpart", "--checkpoint", "q.pmcheck", "--resume")
            starts += 1
            while os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None:
                if processor_seconds(process.pid) >= PREEMPTED_EVERY:
                    process.send_signal(signal.SIGTERM)
                    break
                time.sleep(0.05)
            done += self.end(process, codes=(0, 143))
            if process.returncode == 0:
                break
        same = (self.folder / "p.pmpart").stat().st_size == (self.folder / "q.pmpart").stat().st_size
        assert same, "the parts are not alike"
        return {"everySeconds": PREEMPTED_EVERY, "starts": starts, "wholeSeconds": whole, "preemptedSeconds": done}


def rounded(value):
    """Four digits: more were not measured."""
    if isinstance(value, dict):
        return {name: rounded(its) for name, its in value.items()}
    if isinstance(value, list):
        return [rounded(its) for its in value]
    return float(f"{value:.4g}") if isinstance(value, float) else value


def processor_seconds(process):
    fields = pathlib.Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def busy_seconds():
    """Of all processors, by all programs."""
    fields = [int(f) for f in pathlib.Path("/proc/stat").read_text().splitlines()[0].split()[1:]]
    return (fields[0] + fields[1] + fields[2] + fields[5] + fields[6]) / os.sysconf("SC_CLK_TCK")


def real_farm(bench, options, workers, runs, name, besides=0.0):
    """A farm on Slurm: when what began, in seconds from the command on. besides: processor seconds that it
    takes but for its passes."""
    with tempfile.TemporaryDirectory(prefix="pm_cluster.") as folder:
        cluster = Cluster(folder, [f"n{i + 1}" for i in range(workers)])
        try:
            variables = cluster.environment(XDG_CACHE_HOME=str(bench.folder / "cache"))
            farm = Farm(bench.host, bench.folder, variables, "slurm", [*options, "--runs", str(runs)], name)
            busy, begin = busy_seconds(), time.time()
            if farm.start().wait(1800) != 0:
                raise SystemExit(f"measure_farm.py: {farm.said()}")
            end, busy = time.time(), busy_seconds() - busy
        finally:
            cluster.stop()
    attempts = sorted(farm.job.attempts(), key=lambda a: a.start)
    own = besides
    for file in farm.job.folder.rglob("*.json"):
        its = json.loads(file.read_text())
        own += its["errorCurve"][-1]["processorSeconds"] if its.get("errorCurve") else 0.0
    photons = [a for a in attempts if a.task == 1]
    tasks = [a for a in attempts if a.task > 1]
    gaps = []
    for machine in {a.machine for a in tasks}:
        its = [a for a in tasks if a.machine == machine]
        gaps += [after.start - before.end for before, after in zip(its, its[1:])]
    planned = (farm.job.folder / "plan.json").stat().st_mtime
    return {"workers": workers, "runs": runs, "seconds": end - begin, "pilotSeconds": planned - begin,
            "submitSeconds": photons[0].start - planned, "photonSeconds": photons[0].end - photons[0].start,
            "afterPhotons": tasks[0].start - photons[0].end, "runSeconds": max(a.end for a in tasks) - tasks[0].start,
            "taskSeconds": [a.end - a.start for a in tasks], "gaps": gaps,
            "endSeconds": end - max(a.end for a in tasks), "others": max(0.0, busy - own) / (end - begin)}


def validation(bench, words, turns, frame):
    tiny = real_farm(bench, TINY, 1, RUNS, "tiny")
    merge = bench.run("merge", *sorted((bench.folder / "tiny" / "parts").iterdir()), "-o", "t.exr", "-q")
    latencies = {"submitSeconds": tiny["submitSeconds"], "afterPhotons": tiny["afterPhotons"],
                 "dispatchSeconds": statistics.median(tiny["gaps"]),
                 "noticeSeconds": max(0.0, tiny["endSeconds"] - merge)}
    besides = frame["pilotSeconds"] + frame["mergeSeconds"] + (RUNS + 1) * frame["startSeconds"]
    farms = []
    for workers in WORKERS:
        tried = [real_farm(bench, words, workers, RUNS, f"real {workers} {turn}", besides) for turn in range(turns)]
        farms.append(min(tried, key=lambda farm: farm["others"]))
        print(f"measure_farm.py: {workers} workers: {farms[-1]['seconds']:.1f} s", file=sys.stderr)
    return {"latencies": latencies, "farms": farms}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("host", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--quick", action="store_true", help="small frames")
    parser.add_argument("--turns", type=int, default=1, help="of each real farm; that which other programs disturb least counts")
    asked = parser.parse_args()
    real_size, real_passes = ("160x120", 16) if asked.quick else ("480x360", 48)
    with tempfile.TemporaryDirectory(prefix="pm farm bench ") as folder:
        bench = Bench(asked.host.resolve(), folder)
        costs = {"schema": "pm-farm-costs/1", "cores": os.cpu_count(), "frames": []}
        for name, scene, options, size in FRAMES:
            size = "320x180" if asked.quick else size
            costs["frames"].append(bench.frame(name, scene, (*options, *BUCKETS), size, 2))
        words = ["--size", real_size, "--passes", str(real_passes), "--threads", "1"]
        costs["preempted"] = bench.preempted([BOX, *words, "-q"])
        costs["sharedSpeed"] = bench.shared_speed([BOX, "--size", real_size, "--passes", "8", "--threads", "1", "-q"])
        write(asked.out, costs)  # a replay needs no more
        if missing_programs():
            print("measure_farm.py: no real farms: Slurm is not installed", file=sys.stderr)
            return
        costs["real"] = bench.frame("the real one", BOX, (), real_size, real_passes)
        costs.update(validation(bench, words, asked.turns, costs["real"]))
        write(asked.out, costs)


def write(file, costs):
    new = file.with_name(file.name + ".tmp")
    new.write_text(json.dumps(rounded(costs)) + "\n")
    new.rename(file)


if __name__ == "__main__":
    main()
