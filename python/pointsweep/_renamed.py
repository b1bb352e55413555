# SPDX-License-Identifier: MIT
"""Former names of functions. They work for one release and warn with the new name."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
from typing import Any, TypeVar

from . import _stages

_Function = TypeVar("_Function", bound=Callable[..., Any])


def _former_name(name: str, function: _Function) -> _Function:
    @functools.wraps(function)
    def renamed(*arguments: Any, **options: Any) -> Any:
        warnings.warn(
            f"pointsweep.{name} is now called pointsweep.{function.__name__}; the former name will go with the next release.",
            DeprecationWarning,
            stacklevel=2,
        )
        return function(*arguments, **options)

    renamed.__name__ = renamed.__qualname__ = name
    return renamed  # type: ignore[return-value]


set = _former_name("set", _stages.assign)
