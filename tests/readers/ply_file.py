# SPDX-License-Identifier: MIT
"""The vertices of PLY files, read by plyfile."""
import io

import plyfile


def without_lists(path):
    """The content of a text file without the elements behind the vertices, else the path. plyfile reads the lines of lists, as of
    faces, one by one in Python, which takes it seconds a file; it reads binary files quickly only from their path."""
    content = path.read_bytes()
    header, end, body = content.partition(b"end_header")
    lines = header.split(b"\n")
    elements = [number for number, line in enumerate(lines) if line.startswith(b"element ")]
    if b"format ascii" not in header or len(elements) < 2 or not lines[elements[0]].startswith(b"element vertex"):
        return str(path)
    return io.BytesIO(b"\n".join(lines[:elements[1]]) + b"\n" + end + body)


def read_ply(path):
    """Columns of the element vertex, by the names and with the types of the file."""
    vertices = plyfile.PlyData.read(without_lists(path))["vertex"].data
    return {name: vertices[name] for name in vertices.dtype.names}
