# SPDX-License-Identifier: MIT
"""What pointsweep computes, read by others: neighbours against brute force, normals in every format."""
import laspy
import numpy as np

import tool
from columns import assert_same
from las_file import read_las, values_of
from written import read_any

NEIGHBORS = 8
LARGEST = 2_000  # points, whose distances to one another fill 32 MB


def distances2(positions):
    """From every point to every other, as documented: ((dx² + dy²) + dz²) in double; infinite to itself."""
    difference = positions[:, None, :] - positions[None, :, :]
    squares = difference * difference
    distance2 = (squares[..., 0] + squares[..., 1]) + squares[..., 2]
    np.fill_diagonal(distance2, np.inf)
    return distance2


class NeighborsInNumpyFilesAreThoseOfBruteForce(tool.Files):
    """The positions come from laspy, the arrays are read by numpy, and no search is faster than trying all points."""

    def test(self):
        files = [path for path in tool.real_files(".las", ".laz", largest=100_000) if NEIGHBORS < len(read_las(path).points) <= LARGEST]
        self.each(files[::2], 25, self.check)

    def check(self, path):
        las = read_las(path)
        arrays = self.folder / "neighbors.npy", self.folder / "distances.npy"
        tool.run("neighbors", [path], arrays[0], "-k", NEIGHBORS, "--distances", arrays[1], "--ignore-crs")
        neighbors, distances = (np.load(array, allow_pickle=False) for array in arrays)
        every = distances2(np.stack([values_of(las, axis) for axis in "xyz"], axis=1))
        nearest = np.sqrt(np.sort(every, axis=1)[:, :NEIGHBORS])
        named = np.sqrt(np.take_along_axis(every, neighbors.astype(np.int64), axis=1))
        self.assertEqual(neighbors.shape, nearest.shape)
        self.assertTrue(all(len(set(row)) == NEIGHBORS for row in neighbors.tolist()), "a neighbour stands twice in a row")
        self.assertTrue(np.array_equal(named, nearest), "the points named are not the nearest")
        self.assertTrue(np.array_equal(distances, nearest.astype(distances.dtype)), "distances")


class LasAndLazOfTheSamePointsGiveTheSameResults(tool.Files):
    """The points of a LAS file, compressed by pointsweep, by LASzip and by lazrs: equal files of normals."""

    def test(self):
        self.each(tool.real_files(".las", largest=400_000)[::2], 25, self.check)

    def check(self, path):
        want = self.normals(path)
        las = read_las(path)
        compressed = {"pointsweep": tool.convert(path, self.folder / "pointsweep.laz")}
        writable = str(las.header.version) in laspy.supported_versions()  # not 1.0
        for backend in (laspy.LazBackend.Laszip, laspy.LazBackend.Lazrs) if writable else ():
            compressed[backend.name] = self.folder / f"{backend.name}.laz"
            las.write(str(compressed[backend.name]), laz_backend=backend)
        for name, copy in compressed.items():
            with self.subTest(compressed_by=name):
                self.assertTrue(want == self.normals(copy), "other normals than those of the LAS file")

    def normals(self, path):
        """The bytes of a PLY file of normals behind its comments."""
        out = self.folder / "normals.ply"
        tool.run("normals", [path], out, "-k", 8, "--no-provenance", "--ignore-crs")
        header, end, rows = out.read_bytes().partition(b"end_header\n")
        return [line for line in header.split(b"\n") if not line.startswith(b"comment")], rows


class PairsOfLasAndLazFilesGiveTheSameResults(LasAndLazOfTheSamePointsGiveTheSameResults):
    """Files that others published both as LAS and as LAZ."""

    def test(self):
        folder = tool.DATA / "lidar"
        pairs = {laz: las for laz, las in
                 ((folder / laz, folder / las) for laz, las in
                  (("lasR/Example.laz", "lasR/Example.las"), ("laspy/1_4_w_evlr.laz", "laspy/1_4_w_evlr.las"),
                   ("laz-perf/1815.laz", "laz-perf/1815.las"), ("laz-perf/extrabytes.laz", "laz-perf/extrabytes.las"),
                   ("laz-perf/point10.las.laz", "laz-perf/point10.las"), ("laz-perf/point-time.las.laz", "laz-perf/point-time.las"),
                   ("laz-perf/point-color.las.laz", "laz-perf/point-color.las"),
                   ("laz-perf/point-color-time.las.laz", "laz-perf/point-color-time.las"),
                   ("pdal/laz/autzen_trim.laz", "pdal/las/autzen_trim.las"), ("pdal/laz/simple.laz", "pdal/las/simple.las"),
                   ("lidR/Megaplot.laz", "lasR/Megaplot.las"), ("lidR/Topography.laz", "lasR/Topography.las")))}
        self.pairs = pairs
        self.each(list(pairs), 12, self.check)

    def check(self, path):
        self.assertTrue(self.normals(path) == self.normals(self.pairs[path]), f"other normals than those of {self.pairs[path].name}")


class NormalsAreTheSameInEveryFormat(tool.Files):
    """Of a cloud, written as PLY, LAS, LAZ, PCD, text and CSV, and read by plyfile, laspy, pypcd4 and numpy."""

    def test(self):
        self.each(tool.real_files(".las", ".laz", ".ply", ".pcd", largest=40_000)[::2], 30, self.check)

    def check(self, path):
        got = {}
        for suffix in (".ply", ".las", ".laz", ".pcd", ".xyz", ".csv"):
            written = self.folder / f"out{suffix}"
            tool.run("normals", [path], written, "-k", 8, "--no-provenance", "--nonfinite", "drop", "--prefix", "made_", "--ignore-crs")
            columns = read_any(written)
            got[suffix] = {name: columns[name].astype(np.float32) for name in ("made_nx", "made_ny", "made_nz")}
        for suffix, normals in got.items():
            with self.subTest(written=suffix):
                assert_same(self, normals, got[".ply"])


if __name__ == "__main__":
    tool.main()
