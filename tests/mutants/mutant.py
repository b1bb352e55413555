# SPDX-License-Identifier: MIT
"""What a deliberate mistake is."""
from dataclasses import dataclass


@dataclass(frozen=True)
class Mutant:
    """Replaces the only occurrence of `find` in `file` by `put`.

    `tests` are tried before all others: folders of tests/, or FOLDER:FILTER with a filter as --gtest_filter takes it.
    """
    name: str  # what the mistake is, in a few words
    area: str
    file: str
    find: str
    put: str
    tests: tuple = ()
