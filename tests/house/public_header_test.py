#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""The public header compiles by itself as C11 and as C++20 without a warning, and names Pmr only.

usage: public_header_test.py C_COMPILER CXX_COMPILER
"""
import pathlib
import re
import subprocess
import sys
import tempfile

HEADER = pathlib.Path(__file__).resolve().parents[2] / "plugin" / "include" / "pm_plugin.h"
USE = '#include "pm_plugin.h"\nint main(void) {\n    PmrMeshDesc mesh = PMR_INIT(PmrMeshDesc);\n' \
      "    return mesh.size == sizeof(PmrMeshDesc) && mesh.positions == 0 ? 0 : 1;\n}\n"  # fmt: skip
STRICT = ["-Wall", "-Wextra", "-pedantic", "-Werror", "-Wno-missing-field-initializers"]


def main():
    c_compiler, cxx_compiler = sys.argv[1:3]
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        for compiler, standard, suffix in ((c_compiler, "c11", "c"), (cxx_compiler, "c++20", "cpp")):
            source, program = pathlib.Path(folder, f"use.{suffix}"), pathlib.Path(folder, "use")
            source.write_text(USE)
            command = [compiler, f"-std={standard}", *STRICT, f"-I{HEADER.parent}", str(source)]
            built = subprocess.run([*command, "-o", str(program)], capture_output=True, text=True)
            works = built.returncode == 0 and subprocess.run([str(program)]).returncode == 0
            if not works:
                print(f"pm_plugin.h as {standard}: {built.stderr or 'PMR_INIT does not zero'}")
            failed = failed or not works
    code = re.sub(r"/\*.*?\*/", "", HEADER.read_text(encoding="utf-8"), flags=re.DOTALL)
    for pattern, why in ((r"\benum\b", "no enums"), (r"\bbool\b", "no bool"),
                         (r"\bsize_t\b", "no size_t"), (r"\bPm[A-Z]\w*", "PortMidi owns Pm"),
                         (r"\blong\b|\bunsigned\b|(?<!u)\bint\b", "fixed widths only")):  # fmt: skip
        for match in re.finditer(pattern, code):
            print(f"pm_plugin.h: '{match.group()}': {why}")
            failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
