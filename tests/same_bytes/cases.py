# SPDX-License-Identifier: MIT
"""The runs that script/same-bytes compares. Operators, their options and formats come from the registry of the tool itself."""
import dataclasses
import json
import re
import subprocess


@dataclasses.dataclass(frozen=True)
class Case:
    name: str
    arguments: tuple  # words behind the tool; {out} is the output, {run} a folder for this run alone
    out: str = "out.ply"  # name of the output in {run}; a folder of tiles where it ends in "/"


WAYS = {
    "in memory": ("--threads", "2"),
    "one thread in 64M": ("--threads", "1", "--memory", "64M"),
    "in sweep order": ("--order", "sweep", "--axis", "x"),
    "with checkpoints": ("--resume", "{run}/work"),
}


def said(tool, *words):
    return subprocess.run([tool, *words], check=True, capture_output=True, text=True).stdout


def operators(tool):
    return json.loads(said(tool, "operators", "--json"))


def written_extensions(tool):
    line = re.search(r"^ *writes +(.*)$", said(tool, "--version"), re.MULTILINE)
    return [word.strip() for word in line[1].split(",")]


def on_inputs(example):
    """The example of an operator on the clouds that inputs.py makes."""
    chain = re.sub(r"\b(before|after|labelled)\.las\b", "other.laz", example)
    return chain.replace("crop([0,0,100,100])", "crop([300,300,340,350])")


def with_option(example, operator, name, value):
    """The example with this value of an option at the last stage of that operator. Where another value stands there, all
    named options of the stage go, as they may belong to it."""
    *_, stage = re.finditer(rf"(?<![\w]){operator}\b(\([^()]*(?:\([^()]*\)[^()]*)*\))?", example)
    options = (stage[1] or "()")[1:-1]
    if re.search(rf"\b{name}=", options):
        options = re.sub(r",? *\b\w+=(\[[^\]]*\]|[^,]*)", "", options)
    options = ", ".join(filter(None, [options, f"{name}={value}"]))
    return f"{example[:stage.start()]}{operator}({options}){example[stage.end():]}"


def chains(tool):
    """Name and text: the example of each operator, and with each choice that an option of it leaves."""
    for operator in operators(tool):
        example = on_inputs(operator["example"])
        yield operator["name"], example
        for option in operator["options"]:
            for choice in option.get("choices", []):
                more = ", trajectory=flight.csv" if choice == "trajectory" else ""
                set_to = f"{option['name']}={choice}"
                if set_to not in example and (choice != option["default"] or f"{option['name']}=" in example):
                    yield f"{operator['name']} {set_to}", with_option(example, operator["name"], option["name"], choice + more)


def run(chain, inputs, *more):
    return ("run", *inputs, "-o", "{out}", "--pipeline", chain, *more)


def cases(tool):
    examples = {operator["name"] for operator in operators(tool)}
    for name, chain in chains(tool):
        for way, options in WAYS.items():
            yield Case(f"{name}: {way}", run(chain, ["patch.laz"], *options))
        if name in examples:
            yield Case(f"{name}: plan", run(chain, ["patch.laz"], "--dry-run"))
            yield Case(f"{name}: tiles", run(chain, ["tiles"]), "tiles/")
            yield Case(f"{name}: float32 coordinates", run(chain, ["patch.ply"]), "out.las")
    for extension in written_extensions(tool):
        made = ("neighbors",) if extension == ".npy" else ("normals",)
        for source in ("patch.laz", "patch.ply", "patch.csv"):
            yield Case(f"{source} to {extension}", (*made, source, "-o", "{out}"), f"out{extension}")
    for source in ("patch.pcd", "patch.e57", "patch.pts", "not-finite.ply", "empty.ply", "one.ply"):
        yield Case(f"{source} to .ply", ("normals", source, "-o", "{out}"))
    for verb in ("normals", "curvature", "splats", "features", "fair", "ground", "neighbors"):
        yield Case(f"verb {verb}", (verb, "statue.ply", "-o", "{out}", "-k", "12") if verb != "ground" else (verb, "patch.laz", "-o", "{out}"),
                   "out.npy" if verb == "neighbors" else "out.ply")
    yield Case("verb sort", ("sort", "tls.las", "-o", "{out}"), "out.las")
    yield Case("verb thin", ("thin", "tls.las", "-o", "{out}", "--voxel", "0.5"), "out.las")
    yield Case("verb info", ("info", "patch.laz", "tls.las", "statue.ply"))
    for engine in ("exact", "reference"):
        yield Case(f"engine {engine}", ("normals", "statue.ply", "-o", "{out}", "--engine", engine))
    yield Case("radius", ("normals", "statue.ply", "-o", "{out}", "--radius", "0.05"))
    yield Case("outliers in 64M", ("splats", "outliers.ply", "-o", "{out}", "--memory", "64M", "-k", "24"))
