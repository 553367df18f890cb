# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""pm_host many times without loading its libraries each time, which takes half a second of a processor."""
import json
import pathlib
import subprocess


class Forks:
    """One process, pm_host_forks, that runs pm_host in children of its own."""

    def __init__(self, program, plugin):
        self.process = subprocess.Popen([program, plugin], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)  # fmt: skip

    def run(self, folder, arguments, seconds):
        """{"code", "cpuSeconds", "peakKib"}; what was printed is in the folder's .out and .err."""
        task = {"folder": str(folder), "arguments": arguments, "seconds": seconds}
        self.process.stdin.write(json.dumps(task) + "\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def said(self, folder, arguments, seconds=20):
        """The exit code and standard error."""
        code = self.run(folder, [str(a) for a in arguments], seconds)["code"]
        return code, (pathlib.Path(folder) / ".err").read_text(errors="replace")

    def close(self):
        self.process.stdin.close()
        self.process.wait()
