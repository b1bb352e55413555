# SPDX-License-Identifier: MIT
"""Objects that decorators make from functions, with their copying and pickling."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any


class MadeOfFunction:
    """The result of a decorator. It is pickled by reference if other processes can import it, like a function, else by
    value, which needs cloudpickle."""

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
        except ImportError:  # a pickler such as joblib's can pickle the function by value without it
            return name if found is self else (_restored, (type(self), self.__dict__))
        return _unpickled, (cloudpickle.dumps((type(self), self.__dict__)),)


def _restored(kind: type, state: dict[str, Any]) -> Any:
    made: Any = object.__new__(kind)
    made.__dict__.update(state)
    return made


def _unpickled(pickled: bytes) -> Any:
    import pickle

    return _restored(*pickle.loads(pickled))
