#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""type_names.py ROOT: fails when two types outside of anonymous namespaces have the same full name.

Two such types in different files break the one-definition rule. No compiler notices, and the linker takes the inline
functions of one of them for both."""
import pathlib
import re
import sys

NAMESPACE = re.compile(r"^(?:inline )?namespace ?(\S*) ?\{")
TYPE = re.compile(r"^(?:template ?<.+> ?)?(?:struct|class|union|enum(?: class| struct)?) (?:[A-Z_]+ )?(\w+)(?: final)?(?: ?: ?[^:].*)? ?\{")


def types(path):
    """(full name, line number) of every type defined at the beginning of a line."""
    open_namespaces = []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if found := NAMESPACE.match(line):
            open_namespaces.append(found[1])
        elif re.match(r"^\} *// namespace", line):
            open_namespaces.pop()
        elif (found := TYPE.match(line)) and "" not in open_namespaces:
            yield "::".join([*open_namespaces, found[1]]), number


def main():
    root = pathlib.Path(sys.argv[1])
    places = {}
    for folder in ("include", "pointsweep", "reference", "cli", "python"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                for name, line in types(path):
                    places.setdefault(name, []).append(f"{path.relative_to(root)}:{line}")
    if not places:
        sys.exit(f"{root} holds no types")
    twice = {name: where for name, where in places.items() if len(where) > 1}
    for name, where in twice.items():
        print(f"{name} is defined more than once: {', '.join(where)}")
    print(f"{len(places)} names of types")
    sys.exit(1 if twice else 0)


main()
