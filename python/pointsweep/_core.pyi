# SPDX-License-Identifier: MIT
"""The extension module, binding/."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

version: str
run_options: dict[str, tuple[str, list[str], str]]  # of runs: the placeholder of the value, the values that are words, and the flag of the tool
default_neighbors: int  # number of neighbours that `neighbors` finds where none is given

Known = dict[str, tuple[np.ndarray, list[str]]]  # arrays, with the names of their components; None: one that was given
Progress = Callable[[str, int, int], Any] | None
Warn = Callable[[str], Any] | None

KnownCrs = tuple[Any, ...]  # name, kind, EPSG codes, WKT and GeoTIFF keys

class PointBatch:
    @property
    def size(self) -> int: ...
    @property
    def width(self) -> int: ...
    def positions(self) -> np.ndarray: ...
    def rows(self) -> np.ndarray: ...
    def counts(self) -> np.ndarray: ...
    def neighbor_positions(self) -> np.ndarray: ...
    def neighbor_rows(self) -> np.ndarray: ...
    def own(self, a: int, /) -> np.ndarray: ...
    def of_neighbors(self, a: int, /) -> np.ndarray: ...

def run(
    source: list[Any],
    pipeline: list[Any],
    keep: list[str],
    options: dict[str, Any],
    groups: list[tuple[str, list[str]]],
    to: str | list[str] | None,
    into: dict[str, np.ndarray],
    progress: Progress,
    warn: Warn,
) -> tuple[Known | None, str]: ...

def plan(
    source: list[Any],
    pipeline: list[Any],
    keep: list[str],
    options: dict[str, Any],
    groups: list[tuple[str, list[str]]],
    to: str,
) -> str: ...

def canonical_stages(pipeline: list[Any]) -> list[str]: ...

class SpilledArrays:
    def __len__(self) -> int: ...
    def read(self, first: int, rows: int) -> Known: ...

def run_to_blocks(
    source: list[Any],
    pipeline: list[Any],
    keep: list[str],
    options: dict[str, Any],
    groups: list[tuple[str, list[str]]],
    numbers: Any,
    progress: Progress,
    warn: Warn,
) -> tuple[SpilledArrays, bool, str]: ...
def neighbors(
    source: list[Any],
    k: int,
    radius: float,
    options: dict[str, Any],
    progress: Progress,
    warn: Warn,
) -> tuple[np.ndarray, np.ndarray]: ...
def radius_neighbors(
    source: list[Any],
    radius: float,
    options: dict[str, Any],
    progress: Progress,
    warn: Warn,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...
def query_neighbors(
    source: list[Any],
    queries: np.ndarray,
    k: int,
    radius: float,
    options: dict[str, Any],
    progress: Progress,
    warn: Warn,
) -> tuple[np.ndarray, np.ndarray]: ...
def query_radius_neighbors(
    source: list[Any],
    queries: np.ndarray,
    radius: float,
    options: dict[str, Any],
    progress: Progress,
    warn: Warn,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...
def render(
    source: list[Any], options: dict[str, Any], progress: Progress, warn: Warn
) -> tuple[bytes, str, tuple[float, float] | None, int]: ...
def list_files(named: list[str], recursive: bool, format: str) -> tuple[list[tuple[str, str]], list[str]]: ...
def reads_urls() -> bool: ...
def known_place(name: str) -> str: ...
def object_state(url: str) -> tuple[int, float, str] | None: ...
def get_object(url: str) -> bytes | None: ...
def put_object(url: str, content: bytes, overwrite: bool) -> bool: ...
def list_objects(folder: str) -> list[str]: ...
def remove_object(url: str) -> None: ...
def wkt_crs(wkt: str) -> KnownCrs | None: ...
def parse_crs(text: str) -> KnownCrs | None: ...
def las_crs(wkt: bytes, directory: bytes, doubles: bytes, ascii: bytes, wkt_counts: bool) -> KnownCrs | None: ...
def short_text(crs: KnownCrs) -> str: ...
def differ(a: KnownCrs, b: KnownCrs) -> bool: ...
def describe(source: list[str], options: dict[str, Any]) -> dict[str, Any]: ...
def generate(
    shape: str,
    points: int,
    path: str,
    options: dict[str, Any],
    progress: Progress,
    warn: Warn,
) -> Known | None: ...
def shape_names() -> list[str]: ...
def summarize(path: str, format: str, spacing: bool, progress: Progress) -> tuple[str, KnownCrs | None]: ...
def statistics(source: list[Any], options: dict[str, Any], progress: Progress, warn: Warn) -> str: ...
def verify(inputs: list[str], output: str, options: dict[str, Any], progress: Progress) -> dict[str, Any]: ...

PartRound = tuple[Sequence[tuple[str, int]], str]  # steps of a kind, each for a pass; what is to be joined

def plan_parts(
    source: list[Any], pipeline: list[Any], keep: list[str], options: dict[str, Any], to: list[str]
) -> tuple[list[PartRound], list[int], str, list[str], int, dict[int, tuple[list[str], list[int]]], list[str], tuple[int, float]]: ...
def perform_part(
    scratch: str,
    source: list[Any],
    pipeline: list[Any],
    keep: list[str],
    options: dict[str, Any],
    to: list[str],
    facts: tuple[int, float],
    task: dict[str, Any],
    progress: Progress,
) -> tuple[int, int, int, str]: ...
def join_tiles(scratch: str, left: list[str], paths: list[str], key: str) -> None: ...
def join_values(
    scratch: str,
    source: list[Any],
    pipeline: list[Any],
    keep: list[str],
    options: dict[str, Any],
    to: list[str],
    facts: tuple[int, float],
    round: PartRound,
    before: str,
    left: list[str],
    key: str,
) -> None: ...
def join_graph(
    scratch: str,
    source: list[Any],
    pipeline: list[Any],
    keep: list[str],
    options: dict[str, Any],
    to: list[str],
    facts: tuple[int, float],
    round: PartRound,
    catalogue: str,
    borders: str,
    left: list[str],
    key: str,
) -> None: ...
def join_pieces(
    scratch: str,
    source: list[Any],
    pipeline: list[Any],
    keep: list[str],
    options: dict[str, Any],
    to: list[str],
    facts: tuple[int, float],
    left: list[str],
    key: str,
) -> None: ...
def with_absolute_files(pipeline: str) -> str: ...
left_by_tasks: tuple[str, ...]

def forget_part(scratch: str, left: str) -> None: ...
def remove_abandoned(outputs: list[str]) -> None: ...
