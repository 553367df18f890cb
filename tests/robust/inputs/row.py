# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""What a row of the table of inputs is."""
import dataclasses

SMALL = ["--size", "32x24", "--passes", "1", "--memory-limit", "1"]


@dataclasses.dataclass
class Row:
    """An input, how it is run, and what has to come of it."""

    name: str  # what the input is, as the page says it
    # make(folder, is_full) writes the files; is_full: as large as it may be, else as large as the
    # suite has time for.
    make: object
    arguments: list = dataclasses.field(default_factory=lambda: ["a.obj", *SMALL])
    code: int = 0
    says: tuple = ()  # parts of standard error
    keeps_silent_about: tuple = ()
    values: dict = None  # channel -> (value, tolerance) of the pixel, by --only-pixel
    pixel: str = "16,12"
    seconds: float = 5.0  # of processor time
    peak_gib: float = 1.2

    def outcome(self):
        words = "a picture" if self.code == 0 else f"refused with {self.code}"
        if self.values:
            words += " with " + ", ".join(f"{c} = {v:g}" for c, (v, _) in self.values.items())
        if self.says:
            words += ": " + "; ".join(f"`{part}`" for part in self.says)
        return words.replace("|", "\\|")


def text(**files):
    """make() for files of fixed text; a dot in a name is written as two underscores."""

    def make(folder, _):
        for name, content in files.items():
            (folder / name.replace("__", ".")).write_text(content, encoding="utf-8")

    return make


QUAD = ("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\n"
        "f 1/1 2/2 3/3 4/4\n")  # fmt: skip
