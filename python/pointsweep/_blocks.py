# SPDX-License-Identifier: MIT
"""Points that an iterator yields in blocks. Their number is known only after the last block."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import IO, Any

import numpy as np

from ._errors import Error, UsageError
from ._results import Arrays


class _Column:
    """The blocks of one attribute, one after another, in an unnamed temporary file."""

    def __init__(self, name: str, first: np.ndarray, folder: str | None) -> None:
        import tempfile

        self.name = name
        self._dtype = first.dtype
        self._shape = first.shape[1:]
        self._rows = 0
        self._file: IO[bytes] = tempfile.TemporaryFile(dir=folder)

    def append(self, block: np.ndarray) -> None:
        if block.shape[1:] != self._shape:
            expected = ("n", *self._shape)
            raise UsageError(f"{self.name}: a block has the shape {block.shape}, but the first one {expected}.")
        if not np.can_cast(block.dtype, self._dtype, "safe"):
            raise UsageError(
                f"{self.name}: a block has the type {block.dtype}, which the {self._dtype} of the first one does not hold."
            )
        self._file.write(np.ascontiguousarray(block, self._dtype).data)
        self._rows += len(block)

    def array(self) -> np.ndarray:
        """Returns the values of all points as a memory-mapped array. The unnamed file exists as long as the array."""
        shape = (self._rows, *self._shape)
        self._file.flush()
        if self._rows == 0:
            return np.empty(shape, self._dtype)
        return np.memmap(self._file, self._dtype, "r", shape=shape)

    def close(self) -> None:
        """Closes the file. An array that array() has returned stays valid."""
        self._file.close()


def spilled(blocks: Iterator[Any], named: Callable[[Any], Arrays], folder: str | None) -> Arrays:
    """Returns the arrays of all `blocks`, in temporary files in `folder`, with what the first block states beside its arrays.
    `named` converts a block to arrays by name."""
    columns: dict[str, _Column] = {}
    result = Arrays()
    try:
        for number, block in enumerate(blocks):
            arrays = named(block)
            if number > 0 and arrays.crs != result.crs:
                raise UsageError(
                    f"block {number} is in {arrays.crs}, but the first one is in {result.crs}; transform one of them first."
                )
            if number == 0:
                result = arrays.copy()
                columns = {name: _Column(name, values, folder) for name, values in arrays.items()}
            if arrays.keys() != columns.keys():
                raise UsageError(f"block {number} has {', '.join(arrays)}, but the first one has {', '.join(columns)}.")
            for name, values in arrays.items():
                columns[name].append(values)
        if not columns:
            raise UsageError("the iterator gave no block; without one the attributes are not known.")
        result.update((name, column.array()) for name, column in columns.items())
        return result
    except OSError as error:
        import tempfile

        where = folder or tempfile.gettempdir()
        raise Error(f"cannot write to the temporary folder '{where}': {error.strerror}; name another with temp_folder.") from error
    finally:
        for column in columns.values():
            column.close()
