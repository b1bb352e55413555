# SPDX-License-Identifier: MIT
"""LAS and LAZ files, against laspy: what pointsweep reads, and what it writes."""
import laspy
import numpy as np

import tool
from columns import assert_same
from las_file import columns, identity, read_las, records_of, values_of
from las_made import las_of_point_format
from ply_file import read_ply

# Files that are broken (cut off, header too short, point format 14, VLRs in the points) or have no points: tests/cli says what becomes of them.
BROKEN = {"1.2-with-color-clipped.las", "las12_header_size.las", "las12_point_data_format.las", "bad_vlr_count.las", "no-points.las",
          "no-points-1.3.las", "bad-ellipsoid.copc.laz"}

LARGE = 1_500_000  # bytes


class LasFiles(tool.Files):
    def check_reading(self, path):
        """Into PLY, which plyfile reads. No tolerance: coordinates are raw * scale + offset in double, here as there."""
        assert_same(self, read_ply(tool.convert(path, self.folder / "out.ply")), columns(read_las(path)))

    def check_writing(self, path):
        """As LAS and as LAZ: bytes of records, extra bytes with scale, offset and type, header, VLRs, EVLRs. LAZ is decoded by LASzip and by lazrs."""
        want = read_las(path)
        for suffix, backends in ((".las", [None]), (".laz", [laspy.LazBackend.Laszip, laspy.LazBackend.LazrsParallel])):
            written = tool.convert(path, self.folder / f"out{suffix}")
            for backend in backends:
                with self.subTest(written=suffix, codec=backend and backend.name):
                    self.compare(read_las(written, backend), want)

    def compare(self, got, want):
        self.assertEqual(identity(got.header), identity(want.header))
        self.assertEqual(got.header.point_count, len(want.points), "count")
        self.assertEqual(list(got.header.mins) + list(got.header.maxs), bounds(want), "bounds")
        self.assertEqual([str(d) for d in got.point_format.dimensions], [str(d) for d in want.point_format.dimensions], "fields")
        self.assertTrue(np.array_equal(got.points.array.view(np.uint8), want.points.array.view(np.uint8)), "bytes of the records")
        self.assertEqual(records_of(got.header.vlrs), records_of(want.header.vlrs), "VLRs")
        self.assertEqual(records_of(got.evlrs), records_of(without_nodes(want.evlrs)), "EVLRs")


def first_points(path, target, count):
    with laspy.open(str(path), **({"laz_backend": laspy.LazBackend.Laszip} if path.suffix == ".laz" else {})) as file:
        las = laspy.LasData(file.header, file.read_points(count))
        las.evlrs = file.evlrs
    las.write(str(target))
    return target


def without_nodes(evlrs):
    """LAS and LAZ have no nodes as COPC files have."""
    return [record for record in evlrs or [] if (record.user_id, record.record_id) != ("copc", 1000)]


def bounds(las):
    """Of the points, as the header has them: raw * scale + offset."""
    axes = [values_of(las, axis) for axis in "xyz"]
    return [axis.min() for axis in axes] + [axis.max() for axis in axes]


class LasAndLazFilesAreReadAsLaspyReadsThem(LasFiles):
    def test(self):
        self.each(tool.real_files(".las", ".laz"), 40, self.check_reading)


class LaspyReadsTheLasAndLazFilesThatWeWrite(LasFiles):
    def test(self):
        self.each(tool.real_files(".las", ".laz"), 40, self.check)

    def check(self, path):
        """Of a large file its first points, which fill more than a chunk of LAZ."""
        if path.stat().st_size > LARGE:
            if path.name.endswith(".copc.laz"):  # its nodes name all points, and smaller ones have all else that it has
                return
            path = first_points(path, self.folder / f"first{path.suffix}", 60_000)
        self.check_writing(path)


class OddLasAndLazFilesAreReadAndWritten(LasFiles):
    """The sound ones of the malformed set: wrong bounds, counts, dates and bits of headers, user bytes, bytes that nothing describes."""

    def test(self):
        self.each([path for path in tool.odd_files(".las", ".laz") if path.name not in BROKEN], 20, self.check)

    def check(self, path):
        self.check_reading(path)
        self.check_writing(path)


class EveryPointFormatThatLaspyWritesIsReadAndWritten(LasFiles):
    """As LAS and compressed by LASzip: point formats 0 to 10 with extra bytes of all types, VLRs and EVLRs: also waveform packets, which no real file here has."""

    def test(self):
        for point_format in range(11):
            las = las_of_point_format(point_format)
            for path in (self.folder / f"made_{point_format}.las", self.folder / f"made_{point_format}.laz"):
                with self.subTest(file=path.name):
                    las.write(str(path), **({"laz_backend": laspy.LazBackend.Laszip} if path.suffix == ".laz" else {}))
                    self.check_reading(path)
                    self.check_writing(path)


if __name__ == "__main__":
    tool.main()
