# SPDX-License-Identifier: MIT
"""Rows of binary PLY and PCD files, and a cloud without its normals, as far as the comparison needs them."""
import mmap
import struct

PLY_TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d",
             "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "f", "float64": "d"}
PCD_TYPES = {("F", 4): "f", ("F", 8): "d", ("U", 1): "B", ("U", 2): "H", ("U", 4): "I", ("I", 1): "b", ("I", 2): "h", ("I", 4): "i"}


class Rows:
    """Little-endian binary records of a file: `names`, `count`, and values of a row by name."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.bytes = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        self.names, self.count, letters, self.start = pcd_header(self.bytes) if self.bytes[:1] in b"#V" else ply_header(self.bytes)
        self.row = struct.Struct("<" + letters)

    def values(self, i, names):
        found = self.row.unpack_from(self.bytes, self.start + i * self.row.size)
        return [found[self.names.index(name)] for name in names]


def header_lines(data, last):
    end = data.find(b"\n", data.find(last) + 1) + 1
    return data[:end].decode("latin-1").split("\n"), end


def ply_header(data):
    lines, end = header_lines(data, b"end_header")
    if "format binary_little_endian 1.0" not in lines:
        raise ValueError("not binary_little_endian PLY")
    names, letters, count, vertex = [], "", 0, False
    for words in map(str.split, lines):
        if words[:1] == ["element"]:
            vertex = words[1] == "vertex"
            count = int(words[2]) if vertex else count
        elif words[:1] == ["property"] and vertex:
            names.append(words[2])
            letters += PLY_TYPES[words[1]]
    return names, count, letters, end


def pcd_header(data):
    lines, end = header_lines(data, b"\nDATA ")
    entry = {words[0]: words[1:] for words in map(str.split, lines) if words}
    if entry["DATA"] != ["binary"]:
        raise ValueError(f"PCD data are {entry['DATA'][0]}, not binary")
    names, letters = [], ""
    for name, kind, size, count in zip(entry["FIELDS"], entry["TYPE"], entry["SIZE"], entry.get("COUNT", ["1"] * len(entry["FIELDS"]))):
        names += [name] if count == "1" else [f"{name}{i}" for i in range(int(count))]
        letters += PCD_TYPES[kind, int(size)] * int(count)
    return names, int(entry["POINTS"][0]), letters, end


def write_positions(source, ply, pcd):
    """Writes the float32 positions of a PLY file whose records begin with x, y, z, as PLY and as PCD, without normals."""
    rows = Rows(source)
    size, view = rows.row.size, memoryview(rows.bytes)
    with open(ply, "wb") as as_ply, open(pcd, "wb") as as_pcd:
        as_ply.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {rows.count}\n"
                      "property float x\nproperty float y\nproperty float z\nend_header\n").encode())
        as_pcd.write(("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
                      f"WIDTH {rows.count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {rows.count}\nDATA binary\n").encode())
        for first in range(0, rows.count, 1 << 16):
            last = min(first + (1 << 16), rows.count)
            piece = b"".join(view[at:at + 12] for at in range(rows.start + first * size, rows.start + last * size, size))
            as_ply.write(piece)
            as_pcd.write(piece)
