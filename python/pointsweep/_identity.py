# SPDX-License-Identifier: MIT
"""A digest of a function and of all values that it uses, by which a resumed run is compared with the run that it continues."""

from __future__ import annotations

import builtins
import copyreg
import sys
import types
from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np

_PLAIN = (type(None), bool, int, float, complex, str, bytes, range, slice, type(...), type(NotImplemented))
_BUILT_IN = (types.BuiltinFunctionType, types.MethodDescriptorType, types.WrapperDescriptorType, types.MethodWrapperType)


class Identity(NamedTuple):
    """A digest that distinguishes functions."""

    digest: str
    unknown: list[str]  #: values that the digest excludes, since they cannot be compared: "'lock' (a lock)"


def identity_of(function: Callable[..., Any], *more: Any) -> Identity:
    """Returns the identity of a function: its code, defaults, variables of enclosing functions, the globals and the
    attributes of modules that it uses, and what these use in turn. Libraries count by their names and versions."""
    digests = _Digests()
    digest = digests.of("function", (function, more))
    return Identity(digest.hex()[:16], list(dict.fromkeys(digests.unknown)))


class _Digests:
    """Digests of values by content. Equal values have equal digests, also in another process."""

    def __init__(self) -> None:
        self.unknown: list[str] = []
        self._known: dict[Any, bytes] = {}  # digests by id; for a module, by its id and the attributes that the function uses
        self._kept: list[Any] = []  # keeps objects alive, so that no id is used again
        self._attributes: frozenset[str] = frozenset()  # attributes that the current function uses
        self._in_foreign = False  # True while an object of a library outside of Python's standard library is described

    def of(self, name: str, value: Any) -> bytes:
        """Returns the digest of the value of a variable called `name`."""
        if type(value) in _PLAIN:
            return _joined(type(value).__name__, repr(value).encode("utf-8", "backslashreplace"))
        key = (id(value), self._attributes) if isinstance(value, types.ModuleType) else id(value)
        if key not in self._known:
            self._kept.append(value)
            self._known[key] = _joined("seen before", str(len(self._known)).encode())  # for a value that refers to itself
            try:
                self._known[key] = _joined(type(value).__name__, *self._parts(name, value))
            except Exception:  # the code of another library may raise anything
                if self._in_foreign:
                    del self._known[key]
                    raise
                self.unknown.append(f"'{name}' (a {type(value).__qualname__})")
        return self._known[key]

    def _all(self, name: str, values: Iterable[Any]) -> list[bytes]:
        return [self.of(name, value) for value in values]

    def _parts(self, name: str, value: Any) -> Iterable[bytes]:
        if isinstance(value, types.ModuleType):
            return self._of_module(value)
        if type(value) in (list, tuple):
            return self._all(name, value)
        if type(value) in (dict, types.MappingProxyType):
            return self._all(name, [part for item in value.items() for part in item])
        if type(value) in (set, frozenset):
            return sorted(self._all(name, value))
        if isinstance(value, types.CodeType):
            return self._all(name, _parts_of_code(value))
        if isinstance(value, types.CellType):
            return self._all(name, [value.cell_contents] if _has_content(value) else [])
        if isinstance(value, types.MethodType):
            return self._all(name, [value.__func__, value.__self__])
        if isinstance(value, _BUILT_IN):
            return [_reference(value), *self._all(name, _bound_to(value))]
        if isinstance(value, (types.FunctionType, type)) and _is_of_library(value.__module__):
            return [_reference(value)]
        if isinstance(value, types.FunctionType):
            return self._of_function(value)
        if isinstance(value, type):
            return self._of_class(value)
        if isinstance(value, (classmethod, staticmethod)):
            return [self.of(name, value.__func__)]
        if isinstance(value, memoryview):
            return [value.tobytes()]
        if isinstance(value, property):
            return self._all(name, [value.fget, value.fset, value.fdel])
        wrapped = getattr(value, "py_func", getattr(value, "__wrapped__", None))  # Numba sets py_func, functools __wrapped__
        if isinstance(wrapped, types.FunctionType):
            return [_reference(type(value)), self.of(name, wrapped)]
        if isinstance(value, (np.ndarray, np.generic)) or hasattr(value, "__dlpack__"):
            return self._of_array(name, value)
        return self._of_object(name, value)

    def _of_function(self, function: types.FunctionType) -> Iterator[bytes]:
        outer, codes = self._attributes, list(_codes_in(function.__code__))
        self._attributes = frozenset(name for code in codes for name in code.co_names)
        try:
            yield self.of(function.__name__, function.__code__)
            yield self.of(f"a default of {function.__name__}", (function.__defaults__, function.__kwdefaults__))
            for name, cell in zip(function.__code__.co_freevars, function.__closure__ or ()):
                yield self.of(name, cell)
            for name, value in _globals_of(function, codes):
                yield _joined(name, self.of(name, value))
        finally:
            self._attributes = outer

    def _of_module(self, module: types.ModuleType) -> Iterator[bytes]:
        yield _joined(module.__name__, _version(module.__name__))
        if not _is_of_library(module.__name__):
            for name in sorted(self._attributes & vars(module).keys()):
                yield _joined(name, self.of(f"{module.__name__}.{name}", vars(module)[name]))

    def _of_class(self, kind: type) -> Iterator[bytes]:
        yield _reference(kind)
        yield from self._all(kind.__name__, kind.__bases__)
        for name, value in vars(kind).items():
            is_code = isinstance(value, (types.FunctionType, classmethod, staticmethod, property))
            if is_code or not name.startswith(("__", "_abc_")):
                yield _joined(name, self.of(f"{kind.__name__}.{name}", value))

    def _of_array(self, name: str, value: Any) -> list[bytes]:
        import hashlib

        array = np.asarray(value.detach() if hasattr(value, "detach") else value)  # PyTorch has detach()
        if self._in_foreign and array.dtype.kind in "uiSV" and array.dtype.itemsize == 1:
            raise TypeError("an image of memory, as SciPy's trees have it, holds addresses")
        layout = repr((array.dtype.str, array.dtype.names, array.shape)).encode()
        if array.dtype.names:  # the padding between fields has arbitrary bytes
            return [layout, *self._all(name, [array[field] for field in array.dtype.names])]
        if array.dtype.hasobject:
            return [layout, *self._all(name, array.ravel().tolist())]
        mask = np.ma.getmask(value) if np.ma.isMaskedArray(value) else None
        return [layout, hashlib.sha256(np.ascontiguousarray(array).data).digest(), self.of(name, mask)]

    def _of_object(self, name: str, value: Any) -> list[bytes]:
        """Describes an object by the state that pickle would save."""
        outer = self._in_foreign
        module = type(value).__module__
        self._in_foreign |= _is_of_library(module) and module.partition(".")[0] not in sys.stdlib_module_names
        try:
            return self._all_of_pickle(name, value)
        finally:
            self._in_foreign = outer

    def _all_of_pickle(self, name: str, value: Any) -> list[bytes]:
        reduce = copyreg.dispatch_table.get(type(value))
        reduced = value.__reduce_ex__(4) if reduce is None else reduce(value)
        if not isinstance(reduced, str):
            made, arguments, state, listed, mapped = (*reduced, None, None, None)[:5]
            return self._all(name, (made, arguments, state, list(listed or ()), list(mapped or ())))
        of_library = _is_of_library(getattr(value, "__module__", None) or "builtins")
        content = [] if of_library else [type(value), vars(value)]
        return [_reference(value, reduced), *self._all(name, content)]


def _joined(kind: str, *parts: bytes) -> bytes:
    import hashlib

    lengths = ",".join(str(len(part)) for part in parts)
    return hashlib.sha256(b"".join([f"{kind} {lengths};".encode(), *parts])).digest()


def _reference(value: Any, name: str | None = None) -> bytes:
    module = getattr(value, "__module__", None) or "builtins"
    return _joined(name or str(value.__qualname__), str(module).encode(), _version(str(module)))


def _version(module: str) -> bytes:
    top = sys.modules.get(module.partition(".")[0])
    return str(getattr(top, "__version__", "")).encode()


def _is_of_library(module: str) -> bool:
    top = str(module).partition(".")[0]
    if top == __name__.partition(".")[0] or top in sys.stdlib_module_names or top in sys.builtin_module_names:
        return True
    path = str(getattr(sys.modules.get(top), "__file__", None) or "")
    return "site-packages" in path or "dist-packages" in path


def _bound_to(function: Any) -> list[Any]:
    owner = getattr(function, "__self__", None)
    return [] if owner is None or isinstance(owner, types.ModuleType) else [owner]


def _has_content(cell: types.CellType) -> bool:
    try:
        cell.cell_contents
    except ValueError:
        return False
    return True


def _parts_of_code(code: types.CodeType) -> tuple[Any, ...]:
    """Returns the parts of a code object that determine its results, without its place in a file."""
    arguments = (code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags)
    return (code.co_code, code.co_consts, code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars, arguments)


def _codes_in(code: types.CodeType) -> Iterator[types.CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _codes_in(constant)


def _globals_of(function: types.FunctionType, codes: list[types.CodeType]) -> Iterator[tuple[str, Any]]:
    """Yields the names and values of the globals and modules that the code uses."""
    import dis

    used = [(i.opname, i.argval) for code in codes for i in dis.get_instructions(code)]
    for name in sorted({name for opcode, name in used if opcode in ("LOAD_GLOBAL", "LOAD_NAME")}):
        if name in function.__globals__:
            yield name, function.__globals__[name]
        elif not hasattr(builtins, name):
            yield name, None  # not defined yet
    for name in sorted({name for opcode, name in used if opcode == "IMPORT_NAME"}):
        yield name, _imported(name, function.__globals__.get("__package__"))


def _imported(name: str, package: str | None) -> Any:
    """Returns the module that a function imports when it is called, or `name` if the import fails."""
    import importlib

    for whole in (name, f"{package}.{name}".rstrip(".")):  # for `import name` and for `from .name import ...`
        try:
            return importlib.import_module(whole)
        except Exception:  # the code of the module may raise anything
            continue
    return name
