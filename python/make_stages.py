#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes pointsweep/_stages.py of what `pointsweep operators --json` prints on standard input; script/docs calls it."""

import json
import keyword
import sys
import textwrap

HEAD = '''# SPDX-License-Identifier: MIT
# Made by script/docs from the declarations of the operators; a test compares it with them.
"""The built-in operators as stages of pipelines: ``ps.knn(16) | ps.normals(orient="up") | ps.sor()``."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from ._files import Cloud
from ._stage import Stage, made_stage, makes_stage

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = [{names}]  # fmt: skip
'''

TYPES = {
    "whole": "int", "number": "float", "point": "Sequence[float]", "numbers": "Sequence[float]", "attribute": "str",
    "condition": "str", "word": "str", "file": "str | os.PathLike[str] | Cloud",
    "matrix": "ArrayLike | str | os.PathLike[str]",
    "attributes": "str | Sequence[str]", "assignments": "str",
}  # fmt: skip
WIDTH = 116
FUNCTIONS = {"set": "assign"}  # names of functions for operators that are called like Python builtins


def variable(option):
    return option["name"] + "_" * keyword.iskeyword(option["name"])


def is_flag(option):
    return option["kind"] == "choice" and set(option["choices"]) in ({"no", "yes"}, {"false", "true"})


def kind_of(option):
    """Returns the kind of an option for made_stage(): for a flag, the texts of False and True, joined by |."""
    return "|".join(sorted(option["choices"])) if is_flag(option) else option["kind"]


def default_of(operator, option):
    if not has_own_default(operator, option):
        return "None"
    if is_flag(option):
        return str(option["default"] in ("yes", "true"))
    return literal(option["default"])


def choices(option):
    return "Literal[" + ", ".join(f'"{choice}"' for choice in option["choices"]) + "]"


def type_of(option):
    if is_flag(option):
        return "bool"
    if option["kind"] == "choice":
        return choices(option)
    if option["kind"] == "names":
        return f"Sequence[{choices(option)}]"
    return TYPES[option["kind"]]


def function_name(operator):
    return FUNCTIONS.get(operator["name"], operator["name"])


def neighborhood(operator):
    """Returns the parameters of `knn` that the function takes as well: k and radius, if the operator reads neighbours and has
    no option of this name."""
    taken = {option["name"] for option in operator["options"]}
    return [name for name in ("k", "radius") if operator["default_k"] and name not in taken]


def has_own_default(operator, option):
    """Returns whether the parameter has the default of the option. In a neighbourhood, the defaults depend on the other options."""
    return option["default"] is not None and operator["name"] not in ("knn", "reneighbor")


def parameter(operator, option):
    if option["required"]:
        return f"{variable(option)}: {type_of(option)}"
    if has_own_default(operator, option):
        return f"{variable(option)}: {type_of(option)} = {default_of(operator, option)}"
    return f"{variable(option)}: {type_of(option)} | None = None"


def literal(value):
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    return json.dumps(value)


def sentence(text):
    text = text[:1].upper() + text[1:]
    return text if text.endswith((".", "!")) else text + "."


def about_option(operator, option):
    facts = [option["meaning"], option.get("allowed")]
    if option.get("unit"):
        facts.append(f"unit: {option['unit']}")
    if option["default"] is not None and not has_own_default(operator, option):
        facts.append(f"default: {literal(option['default'])}")
    text = f"{variable(option)} : " + "; ".join(fact for fact in facts if fact) + "."
    return textwrap.wrap(text, WIDTH - 4, subsequent_indent="    ")


def about_neighborhood(operator):
    if not neighborhood(operator):
        return []
    which = " and ".join(neighborhood(operator))
    default = f"{operator['default_k']} neighbours" + (" where neither is given" if which != "k" else "")
    return textwrap.wrap(f"{', '.join(neighborhood(operator))} : {which} of a knn before the stage, which begins the pipeline; "
                         f"default: {default}.", WIDTH - 4, subsequent_indent="    ")


def about_made(made):
    n = len(made["fields"])
    shape = "(n,)" if n == 1 and made["fields"][0] == made["name"] else f"(n, {n})"
    unit = f", {made['unit']}" if made["unit"] not in ("", "1") else ""
    text = f"{made['name']} : {shape} {made['type']}{unit}; {made['meaning']}."
    return textwrap.wrap(text, WIDTH - 4, subsequent_indent="    ")


def section(title, lines):
    return ["", title, "-" * len(title), *lines] if lines else []


def docstring(operator):
    wrap = lambda text: textwrap.wrap(text, WIDTH - 4)
    wrap_indented = lambda text: textwrap.wrap(text, WIDTH - 4, subsequent_indent="  ")
    lines = wrap(sentence(operator["meaning"]))
    lines += section("Parameters", [line for option in operator["options"] for line in about_option(operator, option)]
                      + about_neighborhood(operator))
    lines += section("Makes", [line for made in operator["makes"] for line in about_made(made)])
    reads = [read["name"] for read in operator["reads"]]
    reads += [f"{read['name']} of neighbours" for read in operator["reads_neighbors"]]
    lines += section("Reads", wrap(", ".join(reads)))
    lines += section("Neighbours", [f"{operator['default_k']} where neither k nor a radius is given."] if operator["default_k"] else [])
    for title in ("formula", "undefined", "source", "cost"):
        text = operator[title]
        broken = wrap(sentence(text)) if text else []
        if title == "formula":
            broken = [line for whole in text.splitlines() for line in wrap_indented(whole)]
        lines += section(title.capitalize(), broken)
    lines += section("In a text", [operator["example"]] if operator["example"] else [])
    text = "\n".join("    " + line if line else "" for line in lines).lstrip()
    return ('r' if "\\" in text else "") + f'"""{text}\n    """' if "\n" in text else f'"""{text}"""'


def function(operator):
    options = operator["options"]
    required = [o for o in options if o["required"]]
    leading = required or options[:1]
    others = [o for o in options if o not in leading]
    parameters = [parameter(operator, o) for o in leading]
    others = [parameter(operator, o) for o in others]
    others += [{"k": "k: int | None = None", "radius": "radius: float | None = None"}[n] for n in neighborhood(operator)]
    if others:
        parameters += ["*", *others]
    signature = f"def {function_name(operator)}({', '.join(parameters)}) -> Stage:"
    if len(signature) > 120:
        signature = f"def {function_name(operator)}(\n" + "".join(f"    {p},\n" for p in parameters) + ") -> Stage:"
    given = "".join(
        f'\n        ("{o["name"]}", "{kind_of(o)}", {variable(o)}, {default_of(operator, o)}),'
        for o in options
    )
    given += "\n    " * bool(options)
    neighbors = "".join(f", {name}" for name in neighborhood(operator))
    body = f'    return made_stage("{operator["name"]}", [{given}]{neighbors})'
    return f"\n\n@makes_stage\n{signature}\n    {docstring(operator)}\n{body}\n"


def module(operators):
    exported = sorted({function_name(o) for o in operators} - {"normals"})  # the package has a normals() that also takes points
    names = ", ".join(f'"{name}"' for name in exported)
    names = "\n    " + "\n    ".join(textwrap.wrap(names, WIDTH - 4)) + ",\n"
    return HEAD.replace("{names}", names) + "".join(function(o) for o in operators)


if __name__ == "__main__":
    sys.stdout.write(module(json.load(sys.stdin)))
