#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Makes the references of tests/golden anew: path traced, many passes.

Usage: make_references.py PM_HOST [NAME...]

README.md beside this file says when a reference may change. Takes some minutes.
"""
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, "..", "..", "scenes")
# Passes until the noise of an 8 x 8 region is well below what the photon render is held to.
PASSES = {"cornell_box": 2000, "caustic_glass": 12000}
# As in golden_test.cpp.
OPTIONS = ["--size", "64x48", "--aov", "stderr", "--rendering-space", "Linear Rec.709"]


def main():
    host = os.path.abspath(sys.argv[1])
    plain = {name: value for name, value in os.environ.items()
             if not name.startswith(("OCIO", "OPENIMAGEIO", "LC_"))}
    for name in sys.argv[2:] or PASSES:
        out = os.path.join(HERE, "references", name + ".exr")
        scene = os.path.join(SCENES, name, name + ".obj")
        subprocess.run([host, scene, *OPTIONS, "--integrator", "path", "--seed", "1",
                        "--passes", str(PASSES[name]), "--exr-half", "-q", "-o", out],
                       env=plain, check=True)
        print(out, os.path.getsize(out), "bytes")


if __name__ == "__main__":
    main()
