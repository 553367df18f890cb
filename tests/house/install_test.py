#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Installs the build, moves the result elsewhere, and uses it from there: a host that finds the
package pm through CMake is built and run, and pm_host finds its plugin.

usage: install_test.py CMAKE BUILD_FOLDER
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HOST = pathlib.Path(__file__).resolve().parent / "install_test"


def run(what, *command, **options):
    """Runs a command; when it fails, says what was tried and ends the test."""
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"install_test: {what} failed ({done.returncode}):\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def check_relocatable(prefix, build):
    """No installed file names the build folder, and no library is looked for outside the prefix."""
    for path in (p for p in prefix.rglob("*") if p.is_file()):
        if path.suffix in (".cmake", ".h", ".pc") and str(build.parent) in path.read_text():
            sys.exit(f"install_test: {path.relative_to(prefix)} names the build folder")
        if path.read_bytes()[:4] == b"\x7fELF" and shutil.which("readelf"):
            dynamic = run("readelf", "readelf", "-d", path)
            for way in re.findall(r"R(?:UN)?PATH.*\[(.*)\]", dynamic):
                for folder in filter(None, way.split(":")):
                    if not folder.startswith("$ORIGIN"):
                        sys.exit(f"install_test: {path.name} looks for libraries in {folder}")


def main():
    cmake, build = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory(prefix="pm install ") as folder:
        base = pathlib.Path(folder).resolve()
        run("cmake --install", cmake, "--install", build, "--prefix", base / "first")
        prefix = base / "moved here"
        (base / "first").rename(prefix)
        if not list(prefix.rglob("pm-config.cmake")):
            sys.exit("install_test: no pm-config.cmake was installed")
        headers = [p.relative_to(prefix).as_posix() for p in prefix.rglob("*.h")]
        if headers != ["include/pm_plugin.h"]:
            sys.exit(f"install_test: installed headers are {headers}, not include/pm_plugin.h alone")
        check_relocatable(prefix, build)

        environment = {k: v for k, v in os.environ.items() if k not in ("PM_PLUGIN_PATH", "OCIO")}
        run("find_package(pm)", cmake, "-S", HOST, "-B", base / "host", "-G", "Ninja",
            f"-DCMAKE_PREFIX_PATH={prefix}", env=environment)  # fmt: skip
        run("building a host", cmake, "--build", base / "host", env=environment)
        for way in ("linked", "loaded"):
            print(run(f"the {way} host", base / "host" / f"host_{way}", env=environment), end="")
        version = run("pm_host --version", prefix / "bin" / "pm_host", "--version", cwd=base,
                      env=environment)  # fmt: skip
        if not re.search(r"\d+\.\d+\.\d+", version):
            sys.exit(f"install_test: pm_host --version says '{version}'")
        print(version, end="")


if __name__ == "__main__":
    main()
