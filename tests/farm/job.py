# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""A pm_host farm that runs, and what its job's folder tells of it."""
import os
import pathlib
import subprocess

from cluster import wait_for

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = ROOT / "scenes" / "cornell_box" / "cornell_box.obj"


class Attempt:
    """One start of a task, as run.sh noted it."""

    def __init__(self, task, time, machine, process):
        self.task, self.start, self.machine, self.process = task, float(time), machine, int(process)
        self.end = self.code = None

    def __repr__(self):
        return f"task {self.task} on {self.machine}: {self.start} to {self.end}, {self.code}"


class Job:
    """The folder of a job."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)

    def attempts(self):
        found = []
        for file in sorted((self.folder / "logs").glob("*.events")):
            its = []
            for line in file.read_text().splitlines():
                kind, time, machine, process, *code = line.split()
                if kind == "start":
                    its.append(Attempt(int(file.stem), time, machine, process))
                    continue
                for attempt in its:
                    if (attempt.machine, attempt.process, attempt.end) == (machine, int(process), None):
                        attempt.end, attempt.code = float(time), int(code[0])
            found += its
        return found

    def running(self, machine=None):
        """Starts of runs that have not ended; photons are task 1."""
        return [a for a in self.attempts()
                if a.end is None and a.task > 1 and machine in (None, a.machine) and is_alive(a.process)]

    def wait_for_run(self, machine=None):
        return wait_for(lambda: self.running(machine), f"a run on {machine or 'a machine'}")[0]

    def parts(self):
        return sorted((self.folder / "parts").glob("*.pmpart"))

    def log(self, task):
        file = self.folder / "logs" / f"{task:04}.log"
        return file.read_text(errors="replace") if file.exists() else ""


def is_alive(process):
    try:
        state = pathlib.Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def children(process):
    """All that a process has started, itself last."""
    found = []
    listed = pathlib.Path(f"/proc/{process}/task/{process}/children")
    try:
        words = listed.read_text().split()
    except OSError:
        words = []
    for word in words:
        found += children(int(word))
    return found + [process]


def kill(processes, number):
    for process in processes:
        try:
            os.kill(process, number)
        except ProcessLookupError:
            pass


class Farm:
    """pm_host farm as a process; options are those of the render."""

    def __init__(self, host, folder, variables, engine, options, name="job", output="farm.exr"):
        self.job = Job(folder / name)
        self.output = folder / output
        self.errors = folder / f"{name}.err"
        self.words = [str(host), "farm", str(SCENE), *options, "--engine", engine, "--job", str(self.job.folder),
                      "-o", str(self.output)]
        self.folder, self.variables = folder, variables
        self.process = None

    def start(self):
        with open(self.errors, "a") as errors:
            self.process = subprocess.Popen(self.words, cwd=self.folder, env=self.variables, text=True,
                                            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=errors)
        return self

    def wait(self, seconds=240):
        """Its exit code."""
        try:
            self.printed = self.process.communicate(timeout=seconds)[0]
        except subprocess.TimeoutExpired:
            self.process.terminate()
            self.process.communicate()
            raise AssertionError(f"the farm hangs:\n{self.said()}") from None
        return self.process.returncode

    def said(self):
        return self.errors.read_text()
