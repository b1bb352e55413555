# SPDX-License-Identifier: MIT
"""Checks README.md and the pages of docs/.

    pages.py commands TOOL [--write]   runs the commands of the pages below, and the tables of tasks of README.md and docs/tasks.md, and compares what
                                       they print with the page; --write puts it there
    pages.py paths                     every path in backticks exists, every fenced block has a kind that is run or is text, README.md is short

Commands are the blocks ```sh. A block ```text right after one is what its commands print. Seconds, rates and amounts of memory differ from
run to run and are not compared."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES_WITH_COMMANDS = ["README.md", "docs/index.md", "docs/cookbook.md", "docs/levels.md"]
# Lines of blocks that set a machine up: script/ and pip are tested by themselves.
SETS_UP = re.compile(r"(script/|pip )")
# README.md generates a cloud that takes seconds; a smaller one shows the same.
SMALLER = ("-n 500k", "-n 20k")
BLOCK = re.compile(r"^```sh\n(?P<commands>.*?)^```\n(?P<shown>\n?```text\n(?P<text>.*?)^```\n)?", re.MULTILINE | re.DOTALL)
VARYING = re.compile(r"\d[\d.,]*(?:(?= s\b)|[KMG]?(?=/s\b| of memory)|(?= [KMG]B\b))|(?<=commit )\w+")
# Rows of README.md's table of tasks, whose code is a command, options, or a pipeline.
PROGRESS = re.compile(r"^\w+ \d+ %, .*\n", re.MULTILINE)  # a slow machine prints it after some seconds
TASKS = re.compile(r"^## I want to \.\.\.\n(.*?)^## ", re.MULTILINE | re.DOTALL)
# Kinds of blocks, and the pages whose blocks of the kind are run: here, by python/tests/test_docs.py and by examples/CMakeLists.txt; tests/package has the
# lines of cmake.
RUN = {"sh": PAGES_WITH_COMMANDS, "python": ["README.md", "docs/python.md"], "cpp": ["docs/cpp.md"], "cmake": ["docs/cpp.md"]}


class Workshop:
    """A folder with the inputs that the pages name, and the tool under its name."""

    def __init__(self, tool):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        (self.path / "bin").mkdir()
        (self.path / "bin/pointsweep").symlink_to(pathlib.Path(tool).resolve())

    def run(self, commands):
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", commands], cwd=self.path, capture_output=True, text=True, stdin=subprocess.DEVNULL,
                              env={"PATH": f"{self.path}/bin:/usr/bin:/bin", "LANG": "C.UTF-8", "HOME": self.folder.name, "TERM": "dumb"})
        if done.returncode != 0:
            sys.exit(f"{commands}\nends with status {done.returncode}:\n{done.stdout}{done.stderr}")
        return done.stdout + done.stderr

    def make_inputs(self):
        """A terrain of 400 by 400 m, whose rasters are smaller than those of the whole terrain."""
        self.run("pointsweep generate terrain whole.laz -n 80000 --noise 0.05; pointsweep run whole.laz scan.laz --pipeline 'crop([300,300,700,700])'\n"
                 "pointsweep generate terrain whole.laz -n 80000 --noise 0.05 --seed 2 -f; pointsweep run whole.laz after.laz --pipeline 'crop([300,300,700,700])'\n"
                 "rm whole.laz; mkdir tiles; pointsweep sort scan.laz before.laz\n"
                 "pointsweep run scan.laz tiles/west.laz --pipeline 'where(x < 500)'; pointsweep run scan.laz tiles/east.laz --pipeline 'where(x >= 500)'\n"
                 "pointsweep run scan.laz labelled.laz --pipeline 'voxel(20) | set(tree_id = floor(x), as=uint32)'\n"
                 "pointsweep run after.laz photo.laz --pipeline 'color(z, bits=16) | set(red = floor(red / 257), green = floor(green / 257), blue = floor(blue / 257))'\n"
                 "pointsweep run before.laz station.e57 --pipeline 'drop(intensity) | set(intensity = x / 1000 - floor(x / 1000), as=float32)'\n"
                 "pointsweep run scan.laz stations.e57 --pipeline 'set(scan = 3, as=uint16)'")
        polygon = '{"type": "Polygon", "coordinates": [[[100, 100], [700, 100], [400, 800], [100, 100]]]}'
        (self.path / "site.geojson").write_text(polygon)
        (self.path / "pdal.json").write_text('["scan.las", {"type": "filters.outlier", "mean_k": 12, "multiplier": 2.2},'
                                             '{"type": "filters.range", "limits": "Classification![7:7]"}, {"type": "filters.normal", "knn": 8},'
                                             '{"type": "filters.voxelcenternearestneighbor", "cell": 0.5}, "out.las"]')
        (self.path / "registration.txt").write_text("0 -1 0 500\n1 0 0 200\n0 0 1 0\n0 0 0 1\n")
        (self.path / "flight.csv").write_text("".join(f"{time},{x},500,800\n" for time, x in ((-1, 0), (1, 1000))))


def commands_of(block):
    return "".join(line + "\n" for line in block.splitlines() if not SETS_UP.match(line))


def run_tasks(workshop, page, table, least):
    """Runs the commands and the pipelines of a table of tasks; other code in it is of other programs, or of Python."""
    operators = {operator["name"] for operator in json.loads(workshop.run("pointsweep operators --json"))}
    codes = [code.replace("\\|", "|") for code in re.findall(r"`([^`]+)`", table)]
    codes = [code for code in codes if re.match(r"\w*", code)[0] in operators | {"pointsweep"}]
    if len(codes) < least:
        sys.exit(f"{page}: only {len(codes)} commands and pipelines are found in the table of tasks")
    for code in codes:
        (workshop.path / "out.laz").unlink(missing_ok=True)
        workshop.run(code if code.startswith("pointsweep ") else f"pointsweep run scan.laz out.laz --pipeline '{code}'")


def run_all_tasks(tool):
    workshop = Workshop(tool)
    workshop.make_inputs()
    text = (ROOT / "docs/tasks.md").read_text()
    numbers = [int(number) for number in re.findall(r"^\| (\d+)\. ", text, re.MULTILINE)]
    if numbers != list(range(1, 61)):
        sys.exit("docs/tasks.md: the tasks are not numbered from 1 to 60")
    run_tasks(workshop, "docs/tasks.md", "\n".join(line for line in text.splitlines() if line.startswith("|")), 50)


def check_commands(tool, write):
    codecs = subprocess.run([tool, "generate", "statue", "/dev/null", "--output-format", "laz"], capture_output=True, text=True).stderr
    if "built without" in codecs:
        print("skipped: this build cannot write LAZ")
        sys.exit(77)
    for page in PAGES_WITH_COMMANDS:
        workshop = Workshop(tool)
        workshop.make_inputs()
        text = (ROOT / page).read_text()
        if page == "README.md" or page == "docs/index.md":
            (workshop.path / "scan.laz").unlink()
        count = 0

        def printed(match):
            nonlocal count
            commands = commands_of(match["commands"])
            count += commands.count("\n")
            if page == "README.md":
                commands = commands.replace(*SMALLER)
            output = PROGRESS.sub("", workshop.run(commands)) if commands else ""
            if match["text"] is None:
                return match[0]
            if not write and VARYING.sub("#", output) != VARYING.sub("#", match["text"]):
                sys.exit(f"{page} shows another output than these commands print; script/docs --outputs puts it there.\n{commands}\n{output}")
            begin, end = (place - match.start() for place in match.span("text"))
            return match[0][:begin] + output + match[0][end:]

        made = BLOCK.sub(printed, text)
        if page == "README.md":
            run_tasks(workshop, page, TASKS.search(text)[1], 12)
        if count < 5:
            sys.exit(f"{page}: only {count} commands are found")
        if write:
            (ROOT / page).write_text(made)
    run_all_tasks(tool)


def check_paths():
    wrong = []
    pages = [ROOT / name for name in ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md")] + sorted((ROOT / "docs").rglob("*.md"))
    folders = sorted(path.name for path in (ROOT / "pointsweep").iterdir() if path.is_dir())
    starts = [path.name for path in ROOT.iterdir() if path.is_dir() and not path.name.startswith(".") and path.name != "build"] + folders
    for page in pages:
        name, text = page.relative_to(ROOT), page.read_text()
        for kind, block in re.findall(r"^ *```([^\n]*)\n(.*?)^ *```", text, re.MULTILINE | re.DOTALL):
            if kind != "text" and str(name) not in RUN.get(kind, []) and not (kind == "sh" and not commands_of(block)):
                wrong.append(f"{name}: a fenced block of the kind '{kind}' is neither run nor marked text")
        for code in re.findall(r"`([^`\n]+)`", re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)):
            path = code.split(" ")[0].rstrip("/")
            if not re.fullmatch(r"[\w./*{},-]+", path) or path.split("/")[0] not in starts or "/" not in path:
                continue
            bases = [ROOT, ROOT / "pointsweep", ROOT / "include/pointsweep"]
            if not any(list(base.glob(found)) for base in bases for one in braces(path) for found in (one, one + ".*", one + "-*")):
                wrong.append(f"{name}: there is no {path}")
    readme = (ROOT / "README.md").read_text().splitlines()
    if len(readme) > 95 or max(map(len, readme)) > 160:
        wrong.append("README.md has more than 95 lines, or a line of more than 160 characters")
    sys.exit("\n".join(wrong) or 0)


def braces(path):
    """`a/{b,c}` as a/b and a/c."""
    match = re.match(r"(.*)\{([^{}]*)\}(.*)", path)
    return [path] if match is None else [match[1] + one + match[3] for one in match[2].split(",")]


if __name__ == "__main__":
    if sys.argv[1] == "paths":
        check_paths()
    else:
        check_commands(sys.argv[2], "--write" in sys.argv)
