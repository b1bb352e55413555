# SPDX-License-Identifier: MIT
"""What stages, operators and pipelines have in common: they are joined, compared and pickled."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._pipeline import Pipeline, PipelineLike


class Joinable:
    """Joined by ``|``. Equal are those that stand for the same stages with the same options."""

    def __or__(self, other: PipelineLike) -> Pipeline:
        from ._pipeline import Pipeline

        return Pipeline(self, other)

    def __ror__(self, other: PipelineLike) -> Pipeline:
        from ._pipeline import Pipeline

        return Pipeline(other, self)

    def __eq__(self, other: object) -> bool:
        from ._pipeline import canonical_stages

        if not isinstance(other, Joinable):
            return NotImplemented
        return self is other or canonical_stages(self) == canonical_stages(other)

    def __hash__(self) -> int:
        from ._pipeline import canonical_stages

        return hash(canonical_stages(self))


class MadeOfFunction:
    """What a decorator made of a function. Pickled by reference where other processes can import it, as functions are,
    else by value, which needs cloudpickle."""

    function: Callable[..., Any]

    def _takes_the_place_of(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.__doc__ = getattr(function, "__doc__", None)
        self.__module__ = getattr(function, "__module__", None) or "__main__"

    def __copy__(self) -> Any:
        copied = object.__new__(type(self))
        copied.__dict__.update(self.__dict__)
        return copied

    def __reduce__(self) -> Any:
        name = str(getattr(self.function, "__qualname__", ""))
        found: Any = sys.modules.get(self.__module__)
        for part in name.split("."):
            found = getattr(found, part, None)
        if found is self and self.__module__ != "__main__":
            return name
        try:
            import cloudpickle
        except ImportError:  # joblib and Dask have their own
            return name if found is self else (_restored, (type(self), self.__dict__))
        return _unpickled, (cloudpickle.dumps((type(self), self.__dict__)),)


def _restored(kind: type, state: dict[str, Any]) -> Any:
    made: Any = object.__new__(kind)
    made.__dict__.update(state)
    return made


def _unpickled(pickled: bytes) -> Any:
    import pickle

    return _restored(*pickle.loads(pickled))
