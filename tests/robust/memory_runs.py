# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Runs of pm_host whose memory is looked at."""
import json
import os
import re
import subprocess

MIB = 1 << 20


class Runs:
    def __init__(self, host, folder):
        self.host, self.folder, self.faults = host, folder, 0
        self.cache = folder / "cache"

    def check(self, good, text):
        print(("ok: " if good else "FAULT: ") + text, flush=True)
        self.faults += not good
        return bool(good)

    def run(self, scene, *options):
        """Exit code, standard error, statistics and the most resident bytes."""
        with open(self.folder / "err", "w+", encoding="utf-8") as err:
            child = subprocess.Popen(
                [self.host, scene, "-o", "a.exr", "--stats", "s.json", "-q", "--threads", "2", *options],
                cwd=self.folder, stderr=err, stdout=subprocess.DEVNULL,
                env={**os.environ, "XDG_CACHE_HOME": str(self.cache)})  # fmt: skip
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            err.seek(0)
            text = err.read()
        stats = json.loads((self.folder / "s.json").read_text()) if child.returncode == 0 else None
        return child.returncode, text, stats, usage.ru_maxrss * 1024

    def picture(self):
        """Of all pixels; the file's own metadata tell of limits."""
        done = subprocess.run(["oiiotool", "--hash", "-i", "a.exr"], cwd=self.folder, capture_output=True,
                              text=True, check=True)  # fmt: skip
        return re.search(r"SHA-1: (\w+)", done.stdout).group(1)

    def smallest(self, scene, *options, limit="0.001"):
        """As the refusal tells it, GiB; None where it does not."""
        code, text, _, _ = self.run(scene, *options, "--memory-limit", limit)
        found = re.search(r"the smallest that works ([0-9.]+) GiB", text)
        self.check(code == 5 and found, f"{scene}: a limit too small names the smallest: {text.strip()[-300:]}")
        return found.group(1) if found else None
