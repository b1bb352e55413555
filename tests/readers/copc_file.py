# SPDX-License-Identifier: MIT
"""The nodes of a COPC file as its bytes say, parsed here by struct alone (https://copc.io)."""
import dataclasses
import struct

import numpy as np

HEADER, VLR_HEADER, ENTRY = 375, 54, 32


@dataclasses.dataclass
class Node:
    level: int
    at: tuple
    offset: int
    size: int
    points: int

    def parent(self):
        return (self.level - 1, *(number // 2 for number in self.at))


@dataclasses.dataclass
class Copc:
    center: np.ndarray
    half_size: float
    spacing: float
    times: tuple
    nodes: dict  # by (level, x, y, z)

    def box(self, node):
        side = 2 * self.half_size / 2**node.level
        low = self.center - self.half_size + side * np.array(node.at)
        return low, low + side


def read_copc(path):
    data = path.read_bytes()
    user, record, length = struct.unpack_from("<16sHH", data, HEADER + 2)
    if (user.rstrip(b"\0"), record, length) != (b"copc", 1, 160):
        raise AssertionError(f"{path}: the first record is {user} {record} of {length} bytes")
    x, y, z, half, spacing, root, size, first, last = struct.unpack_from("<5d2Q2d", data, HEADER + VLR_HEADER)
    nodes, pages = {}, [(root, size)]
    while pages:
        start, size = pages.pop()
        for at in range(start, start + size, ENTRY):
            *key, offset, bytes_, points = struct.unpack_from("<4iQ2i", data, at)
            if points == -1:
                pages.append((offset, bytes_))
                continue
            if tuple(key) in nodes:
                raise AssertionError(f"{path}: node {key} stands twice in the hierarchy")
            nodes[tuple(key)] = Node(key[0], tuple(key[1:]), offset, bytes_, points)
    return Copc(np.array([x, y, z]), half, spacing, (first, last), nodes)
