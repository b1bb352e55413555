# SPDX-License-Identifier: MIT
"""The comparison itself: it sees the smallest difference of every type, and nothing where there is none."""
import unittest

import numpy as np

import tool
from columns import assert_same, first_difference


class TheComparisonOfColumnsSeesOneBit(unittest.TestCase):
    def test_of_integers_of_all_sizes(self):
        for kind in "bBhHiIlL":
            values = np.array([0, 1, np.iinfo(kind).max], dtype=kind)
            other = values.copy()
            other[2] -= 1
            self.assertIsNone(first_difference(values, values.copy()))
            self.assertIn("row 2 of 3", first_difference(other, values), kind)

    def test_of_floats(self):
        for kind in "fd":
            values = np.array([0.1, np.nan, np.inf, -np.inf], dtype=kind)
            for row, other in ((0, np.nextafter(values[0], values[2])), (1, 0), (2, 1), (3, np.nan)):
                changed = values.copy()
                changed[row] = other
                self.assertIsNone(first_difference(values, values.copy()))
                self.assertIn(f"row {row} of 4", first_difference(changed, values))

    def test_of_columns(self):
        want = {"x": np.zeros(3), "y": np.ones(3)}
        for got in ({"x": want["x"]}, {"y": want["y"], "x": want["x"]}, {"x": want["x"], "z": want["y"]}, {"x": want["x"], "y": np.ones(2)}):
            with self.assertRaises(AssertionError):
                assert_same(self, got, want)

    def test_within_a_tolerance(self):
        self.assertIsNone(first_difference(np.array([1.0, np.nan]), np.array([1.25, np.nan]), 0.25))
        self.assertIsNotNone(first_difference(np.array([1.0]), np.array([1.26]), 0.25))
        self.assertIsNotNone(first_difference(np.array([np.nan]), np.array([1.0]), 0.25))


if __name__ == "__main__":
    tool.main()
