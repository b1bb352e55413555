# SPDX-License-Identifier: MIT
"""Operators that are functions of Python over exact neighbourhoods."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ._errors import UsageError
from ._function import MadeOfFunction, with_parentheses
from ._identity import Identity, identity_of
from ._pipeline import Joinable
from ._types import FunctionStage

_TYPES = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64")


class _Batch:
    """The arrays of a batch of points, which are made when they are first used."""

    def __init__(self, batch: Any) -> None:
        self._batch = batch
        self._known: dict[str, np.ndarray] = {}

    def _once(self, name: str, make: Callable[[], np.ndarray]) -> np.ndarray:
        if name not in self._known:
            self._known[name] = make()
        return self._known[name]


class PointNeighbors(_Batch):
    """The neighbours of the points of a batch: m places for each point. `mask` is True for the places that are taken.

    With ``knn(k=16)`` m is 16 and all places are taken, unless the cloud has fewer points. With a radius, points have different numbers of
    neighbours, and m is the largest of the batch. Places that are not taken hold NaN, or 0 for integers; in `rows` the largest value, which
    is no row, so that ``values[rows]`` raises an IndexError. Neighbours come nearest first; the point itself is not among them. `flat`
    gives values without empty places; ``flat(name)[offsets[i]:offsets[i + 1]]`` are the values of the neighbours of point i."""

    def __init__(self, batch: Any, names: list[str]) -> None:
        super().__init__(batch)
        self._names = names

    @property
    def xyz(self) -> np.ndarray:
        """(n, m, 3) float64: positions."""
        return self._once("xyz", self._batch.neighbor_positions)

    @property
    def rows(self) -> np.ndarray:
        """(n, m) int64: rows, counted as `Points.rows`; the largest int64 in places that are not taken."""
        return self._once(" rows", self._batch.neighbor_rows)

    @property
    def counts(self) -> np.ndarray:
        """(n,) int64: number of neighbours."""
        return self._once(" counts", self._batch.counts)

    @property
    def mask(self) -> np.ndarray:
        """(n, m) bool: True where there is a neighbour."""
        return self._once(" mask", lambda: np.arange(self._batch.width) < self.counts[:, np.newaxis])

    @property
    def offsets(self) -> np.ndarray:
        """(n + 1,) int64: index of the first neighbour of each point in the results of `flat`, and the number of all neighbours."""
        return self._once(" offsets", lambda: np.concatenate([[0], np.cumsum(self.counts)]))

    def flat(self, name: str) -> np.ndarray:
        """(offsets[-1],) or (offsets[-1], components): ``"xyz"``, ``"rows"`` or an attribute, without empty places."""
        values = self.xyz if name == "xyz" else self.rows if name == "rows" else self[name]
        return values[self.mask]

    def __getitem__(self, name: str) -> np.ndarray:
        """(n, m) or (n, m, components): an attribute that ``reads_neighbors`` names."""
        if name not in self._names:
            raise UsageError(f"the operator does not read '{name}' of neighbours; name it in reads_neighbors.")
        return self._once(name, lambda: self._batch.of_neighbors(self._names.index(name)))


class Points(_Batch):
    """A batch of a few hundred points, as passed to an operator. Arrays are copies: they may be changed and kept.

    The batch is valid only during the call: later it has the arrays that were read during the call, and others raise UsageError.
    """

    def __init__(self, batch: Any, reads: list[str], reads_neighbors: list[str]) -> None:
        super().__init__(batch)
        self._reads = reads
        #: the neighbours of the points
        self.neighbors = PointNeighbors(batch, reads_neighbors)

    def __len__(self) -> int:
        return int(self._batch.size)

    @property
    def xyz(self) -> np.ndarray:
        """(n, 3) float64: positions."""
        return self._once("xyz", self._batch.positions)

    @property
    def rows(self) -> np.ndarray:
        """(n,) int64: rows of the input; if earlier stages drop points, the remaining rows are numbered from 0."""
        return self._once(" rows", self._batch.rows)

    @property
    def neighbors_xyz(self) -> np.ndarray:
        """(n, m, 3) float64: ``neighbors.xyz``."""
        return self.neighbors.xyz

    def __getitem__(self, name: str) -> np.ndarray:
        """(n,) or (n, components): an attribute that ``reads`` names."""
        if name not in self._reads:
            raise UsageError(f"the operator does not read '{name}'; name it in reads.")
        return self._once(name, lambda: self._batch.own(self._reads.index(name)))

    def __getattr__(self, name: str) -> np.ndarray:
        if name.startswith("_"):
            raise AttributeError(name)
        if name not in self._reads:
            raise AttributeError(f"the operator does not read '{name}'; name it in reads.")
        return self[name]

    def __repr__(self) -> str:
        return f"<pointsweep.Points: {len(self)} points, up to {self._batch.width} neighbours>"


class Operator(MadeOfFunction, Joinable, FunctionStage):
    """A function of Python as a stage of pipelines; made with `pointsweep.operator`. Called on points, it
    runs as a pipeline of one stage; called on a batch, `Points`, it calls the function."""

    #: largest number of places in the padded neighbour lists of a batch; a batch of one point may have more
    _most_places = 1 << 18

    def __init__(
        self,
        function: Callable[[Points], Any],
        reads: Sequence[str],
        reads_neighbors: Sequence[str],
        makes: Mapping[str, Any],
        name: str | None,
        sees_neighbors: bool = True,
    ) -> None:
        self._takes_the_place_of(function)
        #: name in plans, errors and statistics
        self.name: str = name or self.__name__
        self.reads = list(reads)
        self.reads_neighbors = list(reads_neighbors)
        #: False: the function reads only positions and attributes of the points, which needs no search
        self.sees_neighbors = bool(sees_neighbors)
        if self.reads_neighbors and not self.sees_neighbors:
            raise UsageError(f"operator '{self.name}': reads_neighbors needs neighbors=True.")
        if not isinstance(makes, Mapping):
            raise UsageError(f"makes: {makes!r} is no dict; give one from names to types, e.g. {{'roughness': 'f4'}}.")
        for attribute in (*self.reads, *self.reads_neighbors, *makes):
            if not isinstance(attribute, str):
                raise UsageError(f"operator '{self.name}': {attribute!r} is not the name of an attribute.")
        self.makes = {made: _made_type(made, kind) for made, kind in makes.items()}
        self._makes = [(made, t.base.name, t.shape[0] if t.shape else 0) for made, t in self.makes.items()]

    def __call__(self, points: Any, **options: Any) -> Any:
        return self.function(points) if isinstance(points, Points) else super().__call__(points, **options)

    __call__.__signature__ = inspect.signature(Joinable.__call__)  # type: ignore[attr-defined]

    def __repr__(self) -> str:
        read = ", ".join(self.reads + [f"{name} of neighbours" for name in self.reads_neighbors])
        made = ", ".join(f"{name} {kind}" for name, kind in self.makes.items())
        return f"<pointsweep.Operator {self.name}: {read or 'positions'} -> {made}>"

    def _identity(self) -> Identity:
        return identity_of(self.function, self.reads, self.reads_neighbors, self._makes, self.sees_neighbors)

    def _call(self, batch: Any) -> list[np.ndarray]:
        """Calls the function with a batch of points, for the extension module. Returns an (n, components) array for each made attribute."""
        result = self.function(Points(batch, self.reads, self.reads_neighbors))
        return [
            self._checked(value, made, kind, batch)
            for (made, kind), value in zip(self.makes.items(), self._values(result))
        ]

    def _values(self, result: Any) -> list[Any]:
        if isinstance(result, Mapping):
            missing = [made for made in self.makes if made not in result]
            if missing:
                raise UsageError(f"operator '{self.name}': returned a dict without '{missing[0]}', which it makes.")
            return [result[made] for made in self.makes]
        values = list(result) if isinstance(result, (tuple, list)) and len(self.makes) > 1 else [result]
        if len(values) != len(self.makes):
            raise UsageError(
                f"operator '{self.name}': makes {len(self.makes)} attributes, but returned {len(values)}; return a dict."
            )
        return values

    def _checked(self, value: Any, made: str, kind: np.dtype[Any], batch: Any) -> np.ndarray:
        if np.ma.is_masked(value):
            raise UsageError(f"operator '{self.name}': returned masked values for '{made}'; fill them, e.g. with NaN.")
        array = np.asarray(value)
        shape = (batch.size, *kind.shape)
        if array.shape != shape:
            what = "nothing" if value is None else f"an array of the shape {array.shape}"
            raise UsageError(f"operator '{self.name}': returned {what} for '{made}', but this batch needs {shape}.")
        if array.dtype.kind not in ("biuf" if kind.base.kind == "f" else "biu"):
            raise UsageError(
                f"operator '{self.name}': returned {array.dtype} for '{made}', which makes {kind.base}; convert it, e.g. with .astype('{kind.base}')."
            )
        with np.errstate(over="ignore"):
            result = np.ascontiguousarray(array, kind.base)
        if not np.can_cast(array.dtype, kind.base, "safe"):
            self._require_fit(array, result, made, batch)
        return result.reshape(batch.size, kind.shape[0] if kind.shape else 1)

    def _require_fit(self, array: np.ndarray, result: np.ndarray, made: str, batch: Any) -> None:
        """Raises UsageError if an integer of `array` is outside the range of the type of `result`, the converted array, or if a
        finite value has become infinite there."""
        limits = ""
        if result.dtype.kind == "f":
            wrong = np.isinf(result)
            wrong &= np.isfinite(array)
        else:
            least, most = np.iinfo(result.dtype).min, np.iinfo(result.dtype).max
            if not array.size or (least <= int(array.min()) and int(array.max()) <= most):
                return
            wrong = (array < least) | (array > most)
            limits = f", {least} to {most}"
        if wrong.any():
            first = tuple(np.argwhere(wrong)[0])
            raise UsageError(
                f"operator '{self.name}': row {batch.rows()[first[0]]}: {made} would be {array[first]}, which is not "
                f"{result.dtype}{limits}; return other values, or name a larger type in makes."
            )


def _made_type(name: str, kind: Any) -> np.dtype[Any]:
    if not name:
        raise UsageError("makes: an attribute has no name; give each one.")
    if name == "xyz":
        raise UsageError("makes: 'xyz' is what results call the positions; to move points, make 'position' of the type ('f8', 3).")
    if kind is None:  # to NumPy None is float64
        raise UsageError(f"makes: '{name}' has no type; give a number such as 'f4', or ('f4', 3) for three of them.")
    try:
        made = np.dtype(kind)
    except (TypeError, ValueError) as error:
        raise UsageError(f"makes: {kind!r} of '{name}' is not a type: {error}.") from None
    if name in ("position", "normal") and (made.base.name, made.shape) != (_FIXED[name], (3,)):
        raise UsageError(f"makes: '{name}' is always ('{_FIXED[name]}', 3).")
    if made.base.name not in _TYPES or len(made.shape) > 1 or made.shape == (0,):
        raise UsageError(f"makes: '{name}' cannot be {kind!r}; give a number such as 'f4', or ('f4', 3) for three of them.")
    return made


_FIXED = {"position": "float64", "normal": "float32"}


class Select(Operator):
    """A Python function that decides which points are kept; made with `pointsweep.select`."""

    def __init__(self, function: Callable[[Points], Any], reads: Sequence[str], name: str | None) -> None:
        super().__init__(function, reads, (), {}, name, sees_neighbors=False)

    def __repr__(self) -> str:
        return f"<pointsweep.Select {self.name}: {', '.join(self.reads) or 'positions'}>"

    def _call(self, batch: Any) -> list[np.ndarray]:
        result = self.function(Points(batch, self.reads, []))
        if np.ma.is_masked(result):
            raise UsageError(f"select '{self.name}': returned masked values; fill them with True or False.")
        mask = np.asarray(result)
        if mask.shape != (batch.size,) or mask.dtype != np.bool_:
            raise UsageError(
                f"select '{self.name}': returned {mask.dtype} of the shape {mask.shape}, "
                f"but this batch needs a mask, bool of the shape ({batch.size},)."
            )
        return [mask.astype(np.uint8)[:, np.newaxis]]


@with_parentheses("makes={'roughness': 'f4'}")
def operator(
    *,
    makes: Mapping[str, Any],
    reads: Sequence[str] = (),
    reads_neighbors: Sequence[str] = (),
    name: str | None = None,
    neighbors: bool = True,
) -> Callable[[Callable[[Points], Any]], Operator]:
    """Makes an operator of a function over batches of points with their exact neighbours.

    Parameters
    ----------
    makes : name -> type of the returned arrays, e.g. ``{"roughness": "f4", "axis": ("f4", 3)}``.
        ``("f8", 3)`` under the name ``position`` moves the points. Arrays of other types are converted; a value that the
        type does not hold raises UsageError with its row, and so do real numbers where integers are promised.
    reads : attributes of the points, from the input or made by earlier stages. Attributes of the input are passed as float64
        (64-bit integers unchanged), normals as float32.
    reads_neighbors : attributes of the neighbours, in the same types. Positions can always be read.
    name : name in errors and plans; default: the name of the function.
    neighbors : False for a function that reads no neighbours, which then needs no search.

    The function gets a `Points` and returns the array of the made attribute, or a dict of arrays. It is called from several
    threads, on batches of any size, and may be called twice for a point: its result for a point may depend only on that
    point and its neighbours. With ``neighbors=False`` points with NaN or infinite coordinates are passed to it like all
    others. Otherwise they are not passed to it: an attribute that the function both reads and makes keeps its value,
    and other made attributes are NaN there, or 0 for integers. An exception ends the run; no output remains.

    >>> @ps.operator(reads=["normal"], makes={"roughness": "f4"})
    ... def roughness(p):
    ...     d = p.neighbors_xyz - p.xyz[:, None]
    ...     return np.abs(np.einsum("nkj,nj->nk", d, p.normal)).mean(1)
    """
    read, read_of_neighbors = _names(reads=reads, reads_neighbors=reads_neighbors)

    def made(function: Callable[[Points], Any]) -> Operator:
        result = Operator(function, read, read_of_neighbors, makes, name, neighbors)
        if not result.makes:
            raise UsageError(f"operator '{result.name}': makes nothing; name what it makes, e.g. makes={{'roughness': 'f4'}}.")
        return result

    return made


@with_parentheses("reads=['normal']")
def select(*, reads: Sequence[str] = (), name: str | None = None) -> Callable[[Callable[[Points], Any]], Select]:
    """Makes a stage of a function that decides which points are kept. Later stages find neighbours among the kept points.

    Parameters
    ----------
    reads : attributes of the points, as for `operator`.
    name : name in errors and plans; default: the name of the function.

    The function gets a `Points` without neighbours and returns a mask, (n,) bool. Points with NaN or infinite coordinates are passed, too.

    >>> @ps.select(reads=["normal"])
    ... def flat(p):
    ...     return np.abs(p.normal[:, 2]) > 0.9
    """
    (read,) = _names(reads=reads)
    return lambda function: Select(function, read, name)


def _names(**options: Any) -> list[list[str]]:
    """Returns the names in each option as a list. Raises UsageError if an option holds no names."""
    lists = []
    for option, given in options.items():
        if isinstance(given, str):
            raise UsageError(f"{option}: give a list of names, [{given!r}].")
        if not isinstance(given, Iterable):
            raise UsageError(f"{option}: {given!r} is no list of names, such as ['normal'].")
        lists.append(list(given))
        if "" in lists[-1]:
            raise UsageError(f"{option}: a name is empty; leave it out.")
    return lists
