# SPDX-License-Identifier: MIT
"""Progress of a run on the screen."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from ._errors import UsageError
from ._types import ProgressCallback


@contextmanager
def called(progress: ProgressCallback | bool | None) -> Iterator[ProgressCallback | None]:
    """Converts `progress` to the form of the extension module. True shows bars of tqdm if it is installed, else a line of text."""
    if progress is None or progress is False:
        yield None
    elif progress is not True:
        if not callable(progress):
            raise UsageError(f"progress: {progress!r} is neither a function nor True.")
        yield progress
    else:
        shown = _Bars() if _has_tqdm() else _Line()
        try:
            yield shown
        finally:
            shown.close()


def _has_tqdm() -> bool:
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # tqdm warns in notebooks without ipywidgets, where it shows text
        try:
            import tqdm.auto  # noqa: F401
        except ImportError:
            return False
    return True


class _Bars:
    """A bar of tqdm for each phase."""

    def __init__(self) -> None:
        self._bar: Any = None
        self._phase = ""

    def __call__(self, phase: str, done: int, total: int) -> None:
        from tqdm.auto import tqdm

        if self._bar is None or phase != self._phase:
            self.close()
            self._bar, self._phase = tqdm(total=total, desc=phase, unit="points", unit_scale=True), phase
        self._bar.total = total
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()


class _Line:
    """A line on standard error if that is a terminal; otherwise nothing."""

    def __init__(self) -> None:
        self._is_terminal = sys.stderr is not None and sys.stderr.isatty()

    def __call__(self, phase: str, done: int, total: int) -> None:
        if self._is_terminal:
            share = done / total if total else 1.0
            print(f"\r{phase:<10} {share:4.0%} of {total:,} points ", end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        if self._is_terminal:
            print("\r" + " " * 50 + "\r", end="", file=sys.stderr, flush=True)
