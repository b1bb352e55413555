# SPDX-License-Identifier: MIT
"""Clouds as PLY files, as far as the pictures of the paper need them: floats in, floats and colours out."""
import array
import random
import struct

FORMATS = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d",
           "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "f", "float64": "d"}


def read(path):
    """Names and columns of the vertices of an ascii or little-endian PLY file."""
    with open(path, "rb") as file:
        names, formats, count, ascii_rows, in_vertex = [], [], 0, False, False
        while True:
            line = file.readline()
            words = line.decode("latin-1").split()
            if not words and not line:
                raise ValueError(f"{path}: no end_header")
            if words[:1] == ["format"]:
                ascii_rows = words[1] == "ascii"
                if words[1] == "binary_big_endian":
                    raise ValueError(f"{path}: big-endian")
            elif words[:1] == ["element"]:
                in_vertex = words[1] == "vertex"
                count = int(words[2]) if in_vertex else count
            elif words[:1] == ["property"] and in_vertex:
                names.append(words[2])
                formats.append(FORMATS[words[1]])
            elif words[:1] == ["end_header"]:
                break
        columns = [array.array("d", bytes(8 * count)) for _ in names]
        if ascii_rows:
            rows = (file.readline().split() for _ in range(count))
        else:
            row = struct.Struct("<" + "".join(formats))
            rows = row.iter_unpack(file.read(row.size * count))
        for i, values in enumerate(rows):
            for column, value in zip(columns, values):
                column[i] = float(value)
    return dict(zip(names, columns))


def write(path, columns):
    """Fields named red, green and blue become bytes, all others floats."""
    names = list(columns)
    formats = ["B" if name in ("red", "green", "blue") else "f" for name in names]
    row = struct.Struct("<" + "".join(formats))
    count = len(columns[names[0]])
    with open(path, "wb") as file:
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\n".encode())
        for name, letter in zip(names, formats):
            file.write(f"property {'uchar' if letter == 'B' else 'float'} {name}\n".encode())
        file.write(b"end_header\n")
        as_written = [[int(v) for v in columns[name]] if letter == "B" else columns[name]
                      for name, letter in zip(names, formats)]
        file.writelines(row.pack(*values) for values in zip(*as_written))


def positions(columns):
    return {axis: columns[axis] for axis in "xyz"}


def diagonal(columns):
    return sum((max(columns[axis]) - min(columns[axis])) ** 2 for axis in "xyz") ** 0.5


def with_noise(columns, sigma, seed=1):
    """Gaussian noise of standard deviation sigma on each coordinate."""
    source = random.Random(seed)
    return {axis: array.array("d", (v + source.gauss(0, sigma) for v in columns[axis])) for axis in "xyz"}


def npy_bytes(path):
    """The values of a one-dimensional uint8 array."""
    with open(path, "rb") as file:
        start = file.read(10)
        file.seek(10 + int.from_bytes(start[8:10], "little"))
        return file.read()
