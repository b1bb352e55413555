# SPDX-License-Identifier: MIT
"""Objects that decorators make from functions, with their copying and pickling."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable
from typing import Any, TypeVar

from ._errors import UsageError

_Decorator = TypeVar("_Decorator", bound=Callable[..., Any])


def with_parentheses(example: str) -> Callable[[_Decorator], _Decorator]:
    """Makes a decorator that is used without its parentheses raise UsageError. `example`: arguments for the error message."""

    def wrapped(decorator: _Decorator) -> _Decorator:
        @functools.wraps(decorator)
        def checked(*arguments: Any, **options: Any) -> Any:
            if arguments:
                name = decorator.__name__
                raise UsageError(f"{name}: its arguments have names; write @pointsweep.{name}({example}), with parentheses.")
            return decorator(**options)

        return checked  # type: ignore[return-value]

    return wrapped


class MadeOfFunction:
    """The result of a decorator. It is pickled by reference if other processes can import it, like a function, else by
    value, which needs cloudpickle."""

    function: Callable[..., Any]

    def _takes_the_place_of(self, function: Callable[..., Any]) -> None:
        if not callable(function):
            raise UsageError(f"{type(self).__name__}: {function!r} is no function; decorate one.")
        self.function = function
        self.__name__ = str(getattr(function, "__name__", type(function).__name__))
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
