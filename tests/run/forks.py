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

    def run(self, folder, arguments, seconds, **more):
        """{"code", "cpuSeconds", "peakKib"}; what was printed is in .out and .err, of the folder or of `output`.

        more: output, a folder; variables, names and values for the environment.
        """
        task = {"folder": str(folder), "arguments": [str(a) for a in arguments], "seconds": seconds, **more}
        self.process.stdin.write(json.dumps(task) + "\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def said(self, folder, arguments, seconds=20):
        """The exit code and standard error."""
        code = self.run(folder, arguments, seconds)["code"]
        return code, (pathlib.Path(folder) / ".err").read_text(errors="replace")

    def close(self):
        self.process.stdin.close()
        self.process.wait()
