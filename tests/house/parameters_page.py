#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""docs/parameters.md, made of what the library tells of itself.

usage: parameters_page.py PM_HOST > docs/parameters.md
"""
import re
import subprocess
import sys

HEAD = """# Parameters

What a host can say of a material, light, environment, camera, instance or sphere, as
`pm_host --list parameters` prints it and `parameterInfo` tells it. Made by
`tests/house/parameters_page.py PM_HOST`; a test holds that it is up to date.

Each is a member of the struct of the same name in [the C interface](c_interface.md), or came after
these structs; `setParameter` sets either by name. A texture multiplies the number it is named after.
Numbers without a unit are plain ones or shares.
"""
LINE = re.compile(r"(\w+)\.(\w+): (.*) \[(.*?)(?:; default (.*))?\]")


def page(host):
    """The page's text. Raises where pm_host prints what is not understood."""
    printed = subprocess.run([host, "--list", "parameters"], capture_output=True, text=True,
                             check=True).stdout  # fmt: skip
    text, last = HEAD, None
    for line in printed.splitlines():
        match = LINE.fullmatch(line)
        if not match:
            raise ValueError(f"{host} --list parameters prints: {line}")
        thing, name, about, allowed, default = match.groups()
        if thing != last:
            text += f"\n## {thing}\n\n| name | what | allowed | default |\n|---|---|---|---|\n"
        last = thing
        text += f"| `{name}` | {about} | {allowed} | {default or ''} |\n"
    return text


if __name__ == "__main__":
    sys.stdout.write(page(sys.argv[1]))
