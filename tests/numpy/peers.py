# SPDX-License-Identifier: MIT
"""What the comparisons with other programs share: the tool, tables of points as PLY, and a count of what differs."""
import importlib
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

TYPES = {"float": "<f4", "double": "<f8", "uchar": "<u1", "char": "<i1", "ushort": "<u2", "short": "<i2", "uint": "<u4", "int": "<i4"}


def has(module):
    """Whether it is installed, with the libraries it needs."""
    try:
        importlib.import_module(module)
    except ImportError:
        return False
    return True


class Comparison:
    """With the tool; `expect()` says what was compared, and `end()` leaves with 1 if something differed, 77 if nothing could be compared."""

    def __init__(self, tool):
        self.tool_path, self.made, self.different = tool, 0, 0
        self.held = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.held.name)

    def generate(self, shape, *options):
        path = self.folder / f"{shape}.ply"
        subprocess.run([self.tool_path, "generate", shape, path, "-n", "40k", "-q", *options], check=True)
        return path

    def tool(self, source, pipeline):
        path = self.folder / "out.ply"
        subprocess.run([self.tool_path, "run", source, path, "-f", "-q", "--pipeline", pipeline], check=True)
        return read_ply(path)

    def expect(self, holds, what):
        self.made += 1
        self.different += not holds
        print(f"{what}: {'as it should be' if holds else 'DIFFERENT'}")

    def end(self):
        if self.made == 0:
            print("skipped: none of the programs to compare with is here; script/bench python makes an environment with some of them")
            sys.exit(77)
        sys.exit(1 if self.different else 0)


def read_ply(path):
    """The vertices of a binary PLY file without lists."""
    data = path.read_bytes()
    head, _, rest = data.partition(b"end_header\n")
    words = [line.split() for line in head.decode().splitlines()]
    count = next(int(line[2]) for line in words if line[:2] == ["element", "vertex"])
    dtype = np.dtype([(line[2], TYPES[line[1]]) for line in words if line[0] == "property"])
    return np.frombuffer(rest, dtype, count)


def write_ply(path, points):
    head = "".join(f"property double {axis}\n" for axis in "xyz")
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n{head}end_header\n"
    path.write_bytes(head.encode() + np.ascontiguousarray(points, "<f8").tobytes())


def positions(table):
    return np.stack([table[axis] for axis in "xyz"], axis=1).astype(np.float64)
