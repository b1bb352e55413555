# SPDX-License-Identifier: MIT
"""The tool as a process, and the real files that it reads. Nothing here or in the tests knows the code of pointsweep.

POINTSWEEP         the tool (default: build/release/cli/pointsweep)
POINTSWEEP_DATA    the folder of real files (default: ../shared/data)
POINTSWEEP_CODECS  0 where the tool was built without LAZ and E57"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
TOOL = os.environ.get("POINTSWEEP", ROOT / "build/release/cli/pointsweep")
DATA = pathlib.Path(os.environ.get("POINTSWEEP_DATA", ROOT / "../shared/data"))
COMPRESSED = {".laz", ".e57"}
KEEP_ALL = ["--pipeline", "where(1 == 1)"]  # a pipeline that keeps all rows in their order and makes nothing


def run(verb, inputs, output, *options):
    """Runs a verb of the tool; an error of the tool is an error of the test, with what it said."""
    command = [TOOL, verb, *inputs, "-o", output, "--threads", "2", "--quiet", "--force", *options]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"status {done.returncode} from {' '.join(map(str, command))}: {done.stderr.strip()}")


def convert(source, target, *options):
    """Writes all points of a file to another one, in their order, with all attributes and nothing else."""
    run("run", [source], target, *KEEP_ALL, "--no-provenance", *options)
    return target


def is_odd(path):
    return "malformed" in path.relative_to(DATA).parts


def files(suffixes):
    """Smallest first; without those that need codecs that the tool lacks."""
    found = [path for path in DATA.rglob("*") if path.suffix in suffixes]
    if os.environ.get("POINTSWEEP_CODECS") == "0":
        found = [path for path in found if path.suffix not in COMPRESSED]
    return sorted(found, key=lambda path: path.stat().st_size)


def real_files(*suffixes, largest=100_000_000):
    """The real files with these suffixes that are not broken on purpose."""
    return [path for path in files(suffixes) if not is_odd(path) and path.stat().st_size <= largest]


def odd_files(*suffixes):
    """Files that are broken, or unusual and sound."""
    return [path for path in files(suffixes) if is_odd(path)]


class Files(unittest.TestCase):
    """A test over real files, with a folder for what the tool writes."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="pointsweep_readers_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def each(self, files, least, check):
        """Calls check(path) for each file and names the file of a failure. Fewer files than `least` are a failure too."""
        self.assertGreaterEqual(len(files), least, f"real files in {DATA}")
        for path in files:
            with self.subTest(file=str(path.relative_to(DATA))):
                check(path)


def main():
    if not DATA.is_dir():
        print(f"skipped: there are no real files in {DATA}; POINTSWEEP_DATA names their folder")
        sys.exit(77)
    unittest.main(verbosity=2)
