# SPDX-License-Identifier: MIT
"""Comparing columns: a cloud is a dict from the name of a column to its values."""
import numpy as np


def comparable(values):
    """As integers where they are, else as double, which holds the smaller types exactly."""
    values = np.asarray(values)
    return values if values.dtype.kind in "iu" and values.dtype.itemsize == 8 else values.astype(np.float64)


def first_difference(got, want, tolerance=0.0):
    """The first row that differs by more than the tolerance (one for all rows, or one for each); None if there is none. NaN equals NaN."""
    got, want = comparable(got), comparable(want)
    if got.shape != want.shape:
        return f"{got.shape} values instead of {want.shape}"
    with np.errstate(invalid="ignore"):
        # Differences of integers of 64 bits wrap around; equal is equal before any subtraction.
        differs = (got != want) & ~((got != got) & (want != want))
        if np.any(tolerance):
            differs &= ~(np.abs(got - want) <= tolerance)
    rows = np.flatnonzero(differs)
    if rows.size == 0:
        return None
    row = rows[0]
    return f"row {row} of {len(got)}: {got[row]!r} instead of {want[row]!r} ({rows.size} rows differ)"


def assert_same(test, got, want, tolerance=None):
    """The same columns in the same order, with the same values; `tolerance`: by column, in its unit."""
    test.assertEqual(list(got), list(want), "columns")
    for name, values in want.items():
        difference = first_difference(got[name], values, (tolerance or {}).get(name, 0.0))
        test.assertIsNone(difference, f"column {name}: {difference}")
