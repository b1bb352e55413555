# SPDX-License-Identifier: MIT
"""COPC files that the tool writes: laspy finds the points of each level where the bytes of the file say they are."""
import subprocess

import laspy
import numpy as np

import tool
from copc_file import read_copc
from las_file import columns, read_las
from las_made import las_of_point_format

LARGEST = 4_000_000  # bytes of a real file


def records_of(points):
    """Whole records in one order, so that two sets of them can be compared."""
    data = np.ascontiguousarray(points.array)
    return np.sort(data.view(np.dtype((np.void, data.dtype.itemsize))).reshape(-1))


class CopcFilesHaveTheirPointsInTheNodesThatTheyName(tool.Files):
    def test(self):
        files = tool.real_files(".las", ".laz", largest=LARGEST)
        self.each(files[:: max(1, len(files) // 12)], 10, self.check)

    def check(self, path):
        copc_path = self.folder / "out.copc.laz"
        tool.run("convert", [path], copc_path, "--no-provenance", "--ignore-crs")
        copc = read_copc(copc_path)
        las = read_las(copc_path)  # as plain LAZ, by LASzip
        whole = records_of(las.points)
        self.check_tree(copc, len(whole))
        levels = []
        with laspy.CopcReader.open(str(copc_path)) as reader:
            for level in sorted({node.level for node in copc.nodes.values() if node.points > 0}):
                points = reader.level_query(level)
                self.assertEqual(len(points), sum(n.points for n in copc.nodes.values() if n.level == level), f"level {level}")
                self.check_places(copc, level, points)
                levels.append(np.ascontiguousarray(points.array))
        if levels:
            every = np.sort(np.concatenate([one.view(np.dtype((np.void, one.dtype.itemsize))).reshape(-1) for one in levels]))
            self.assertTrue(np.array_equal(every, whole), "the levels are the points of the file")
        self.check_source(path, las)

    def check_tree(self, copc, count):
        self.assertIn((0, 0, 0, 0), copc.nodes)
        self.assertEqual(sum(node.points for node in copc.nodes.values()), count)
        self.assertTrue(all(node.level == 0 or node.parent() in copc.nodes for node in copc.nodes.values()), "ancestors")
        used = sorted((node.offset, node.size) for node in copc.nodes.values() if node.points > 0)
        self.assertTrue(all(a + n == b for (a, n), (b, _) in zip(used, used[1:])), "chunks without gaps")
        by_level = [key[0] for key, node in sorted(copc.nodes.items(), key=lambda item: item[1].offset) if node.points > 0]
        self.assertEqual(by_level, sorted(by_level), "coarse nodes stand first in the file")

    def check_places(self, copc, level, points):
        """Each point lies in a node of its level that has points."""
        place = np.stack([np.asarray(points[axis]) for axis in "xyz"], axis=1)
        low = copc.center - copc.half_size
        side = 2 * copc.half_size / 2**level
        cells = np.floor((place - low) / side).astype(np.int64)
        found, counts = np.unique(cells, axis=0, return_counts=True)
        want = {node.at: node.points for node in copc.nodes.values() if node.level == level and node.points > 0}
        self.assertEqual({tuple(map(int, cell)): int(n) for cell, n in zip(found, counts)}, want)

    def check_source(self, path, las):
        """Coordinates and attributes are those of the input, and the header says so."""
        source = read_las(path)
        table = lambda file: np.stack([np.asarray(file[name]) for name in ("X", "Y", "Z", "intensity", "user_data", "point_source_id")], axis=1)
        order = lambda rows: rows[np.lexsort(rows.T)]
        self.assertTrue(np.array_equal(order(table(las).astype(np.int64)), order(table(source).astype(np.int64))))
        self.assertEqual(las.header.point_format.id, {True: 7, False: 6}["red" in source.point_format.dimension_names]
                         if "nir" not in source.point_format.dimension_names else 8)


class EveryPointFormatBecomesCopcWithAllItsValues(tool.Files):
    """Formats 0 to 10 with extra bytes of all types: arrays become a field for each value, old flags and angles those of formats 6 to 8."""

    def test(self):
        for point_format in range(11):
            las = las_of_point_format(point_format)
            source, copc = self.folder / f"made_{point_format}.las", self.folder / f"made_{point_format}.copc.laz"
            las.write(str(source))
            with self.subTest(point_format=point_format):
                tool.run("convert", [source], copc, "--no-provenance")
                want, got = columns(read_las(source)), columns(read_las(copc))
                order_want, order_got = (np.lexsort([table[axis] for axis in "xyz"]) for table in (want, got))
                for name, values in want.items():
                    if name in ("x_t", "y_t", "z_t"):
                        continue
                    found = got[name if name in got else name.rsplit("_", 1)[0] + f"[{name.rsplit('_', 1)[1]}]"]
                    tolerance = 0.003001 if name == "scan_angle" and point_format < 6 else 0
                    difference = np.abs(np.asarray(found)[order_got].astype(np.longdouble) - np.asarray(values)[order_want].astype(np.longdouble))
                    self.assertLessEqual(difference.max(), tolerance, name)
                self.assertEqual(read_copc(copc).nodes[(0, 0, 0, 0)].points, len(las.points))


class OtherProgramsFindThePointsOfEachLevel(tool.Files):
    """copc.js with laz-perf, as browsers use it, and the crates las and copc-streaming; script/reader-programs makes them."""

    READERS = tool.ROOT / "build/readers"

    def test(self):
        programs = {}
        if (self.READERS / "js/node_modules/copc").exists():
            programs["copc.js"] = ["node", self.READERS / "js/levels.mjs"]
        crates = self.READERS / "crates/release/copc-levels"
        if crates.exists():
            programs.update({crate: [crates, crate] for crate in ("las", "copc-streaming")})
        if not programs:
            self.skipTest("build/readers with other programs is missing; script/reader-programs makes it")
        # copc.js refuses descriptors of extra bytes whose no-data value is beyond 2^53, which the input of this file has.
        files = [path for path in tool.real_files(".las", ".laz", largest=LARGEST) if path.name != "1.2-empty-geotiff-vlrs.las"]
        self.each(files[:: max(1, len(files) // 6)], 6, lambda path: self.check(path, programs))
        for path in self.made():
            with self.subTest(made=path.name):
                self.check(path, programs)

    def made(self):
        """Clouds with many levels, and with made attributes."""
        paths = [self.folder / "scan.laz", self.folder / "normals.laz"]
        subprocess.run([tool.TOOL, "generate", "tls", paths[0], "-n", "200000", "--quiet"], check=True)
        tool.run("run", [paths[0]], paths[1], "--pipeline", "knn(k=8) | normals | sor")
        return paths

    def check(self, path, programs):
        copc = self.folder / "out.copc.laz"
        tool.run("convert", [path], copc, "--no-provenance", "--ignore-crs")
        want = {}
        with laspy.CopcReader.open(str(copc)) as reader:
            for level in sorted({node.level for node in read_copc(copc).nodes.values() if node.points > 0}):
                points = reader.level_query(level)
                want[level] = [len(points), *(int(np.asarray(points[axis], dtype=np.int64).sum()) for axis in "XYZ")]
        for name, program in programs.items():
            with self.subTest(program=name):
                said = subprocess.run([*map(str, program), str(copc)], capture_output=True, text=True)
                self.assertEqual(said.returncode, 0, said.stderr)
                found = {int(line.split()[0]): [int(word) for word in line.split()[1:]] for line in said.stdout.splitlines()}
                self.assertEqual(found, want)


class LevelsOfCopcFilesAreThoseThatLaspyFinds(tool.Files):
    """Files by other programs, read by --depth: among them one with several pages, and the potree lion."""

    def test(self):
        self.each([path for path in tool.real_files(".laz") if path.name.endswith(".copc.laz")], 4, self.check)

    def check(self, path):
        levels = sorted({node.level for node in read_copc(path).nodes.values() if node.points > 0})
        for level in levels[:3]:
            with laspy.CopcReader.open(str(path)) as reader:
                want = reader.level_query(range(0, level + 1))
            out = self.folder / "out.las"
            tool.run("convert", [path], out, "--depth", level, "--no-provenance", "--ignore-crs")
            self.assertTrue(np.array_equal(records_of(read_las(out).points), records_of(want)), f"depth {level}")


if __name__ == "__main__":
    tool.main()
