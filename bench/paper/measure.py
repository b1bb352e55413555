# SPDX-License-Identifier: MIT
"""Runs what the tables and figures of the paper show, on this machine; see script/paper --help.

Results (numbers) go to one JSON file, pictures beside it; page.py makes the page from both."""
import argparse
import datetime
import json
import math
import os
import pathlib
import subprocess
import sys
import time

import figures
import page

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAPER_SIZES = {2000646: "David head", 4129534: "David 2mm", 14022961: "Lucy", 28168109: "David 1mm", 102965801: "St. Matthew"}
LAW_SIZES = [1_000_000, 4_000_000, 16_000_000, 64_000_000]
CURVATURE = "knn(k=8) | normals | curvature | splats"


def arguments():
    parser = argparse.ArgumentParser(prog="script/paper", description=__doc__.split("\n")[0])
    parser.add_argument("--sizes", nargs="+", default=["2000646", "4129534"],
                        help="points of the generated clouds, e.g. 2M 14022961 (default: the paper's two smaller models)")
    parser.add_argument("--law", nargs="+", default=["1M", "4M"], help="points for the law of the working set (default 1M 4M)")
    parser.add_argument("--full", action="store_true", help="the sizes of all five models, and 1M to 64M for the law; about ten minutes on two cores, 20 GB")
    parser.add_argument("--data", type=pathlib.Path, default=os.environ.get("POINTSWEEP_DATA"), help="folder of real models")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/paper")
    parser.add_argument("--tool", type=pathlib.Path, default=ROOT / "build/release/cli/pointsweep")
    parser.add_argument("--results", type=pathlib.Path, help="where the numbers go (default: WORK/results.json)")
    parser.add_argument("--page-only", type=pathlib.Path, metavar="RESULTS", help="make the page from these numbers; measure nothing")
    options = parser.parse_args()
    if options.full:
        options.sizes, options.law = list(PAPER_SIZES), LAW_SIZES
    options.sizes = sorted({points(size) for size in options.sizes})
    options.law = sorted({points(size) for size in options.law})
    options.work = options.work.resolve()
    return options


def points(size):
    text = str(size)
    factor = {"k": 10**3, "M": 10**6, "G": 10**9}.get(text[-1])
    return int(float(text[:-1]) * factor) if factor else int(text)


class Tool:
    """Runs the program; everything it leaves lies in `work`."""

    def __init__(self, options):
        self.program, self.work = options.tool, options.work

    def __call__(self, verb, *words):
        command = [str(self.program), verb, *map(str, words), "--force", "--quiet"]
        begin = time.monotonic()
        if subprocess.run(command).returncode != 0:
            sys.exit("script/paper: failed: " + " ".join(command))
        return time.monotonic() - begin

    def with_statistics(self, verb, *words):
        """The statistics of a run over a stream; spilled data stays in the working folder."""
        stats = self.work / "stats.json"
        self(verb, *words, "--stats", stats, "--temp-dir", self.work)
        return json.loads(stats.read_text())


def statue(tool, count):
    path = tool.work / f"statue-{count}.ply"
    if not path.exists():
        tool("generate", "statue", path, "-n", count, "--noise", "0.0003")
    return path


def thinned(rows, most=200):
    """Returns at most `most` rows, each with the largest value of its stretch of rows."""
    stretch = max(1, math.ceil(len(rows) / most))
    return [max(rows[i:i + stretch], key=lambda row: row[1]) for i in range(0, len(rows), stretch)]


def summary(stats, output, with_series=False):
    """Returns the statistics of a run that the tables and plots need."""
    kept = {key: stats[key] for key in ("points", "certified", "recalled", "threads", "peak_rss_bytes", "memory_budget_bytes", "seconds",
                                        "bytes", "lifespan_seconds")}
    kept["output_bytes"] = output.stat().st_size
    if with_series:
        kept["series"] = thinned(stats["working_set"]["series"])
        kept["buffers"] = [dict(buffer, series=thinned(buffer["series"])) for buffer in stats["buffers"]]
    return kept


def measure_cloud(tool, path):
    """Tables 1 and 2, Figures 4, 5 and 6 for one cloud."""
    output = tool.work / "output.ply"
    result = {"input_bytes": path.stat().st_size}
    result["sort"] = summary(tool.with_statistics("sort", path, output), output)
    result["normal"] = summary(tool.with_statistics("normals", path, output, "-k", 8), output)
    for memory in ("256M", "2G"):
        stats = tool.with_statistics("run", path, output, "--pipeline", CURVATURE, "--memory", memory)
        result[f"curvature {memory}"] = summary(stats, output, with_series=memory == "2G")
    output.unlink()
    return result


def measure_reference(tool, path):
    """The paper's own algorithm, point by point, for the buffers of its operators."""
    output = tool.work / "output.ply"
    result = summary(tool.with_statistics("run", path, output, "--pipeline", CURVATURE, "--engine", "reference"), output, with_series=True)
    output.unlink()
    return result


def law(tool, sizes):
    """Peak of the window of the Curvature pipeline against the number of points."""
    rows = []
    for count in sizes:
        output = tool.work / "output.ply"
        stats = tool.with_statistics("run", statue(tool, count), output, "--pipeline", CURVATURE)
        rows.append({"points": count, "peak": stats["working_set"]["peak_points"], "mean": stats["working_set"]["mean_points"]})
        output.unlink()
    return {"rows": rows, "exponent": exponent(rows)}


def exponent(rows):
    """Returns the exponent of a power law through the peaks, by least squares of logarithms; None for one size."""
    if len(rows) < 2:
        return None
    xs, ys = [math.log(r["points"]) for r in rows], [math.log(r["peak"]) for r in rows]
    mean_x, mean_y = sum(xs) / len(xs), sum(ys) / len(ys)
    return sum((x - mean_x) * (y - mean_y) for x, y in zip(xs, ys)) / sum((x - mean_x) ** 2 for x in xs)


def said(*command):
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    return done.stdout.strip() if done.returncode == 0 else "unknown"


def measure(options):
    tool = Tool(options)
    result = {"date": datetime.date.today().isoformat(), "commit": said("git", "rev-parse", "--short", "HEAD"), "clouds": {}}
    for count in options.sizes:
        print(f"script/paper: {count} points", file=sys.stderr)
        result["clouds"][str(count)] = measure_cloud(tool, statue(tool, count))
    print("script/paper: the paper's algorithm", file=sys.stderr)
    result["reference"] = measure_reference(tool, statue(tool, options.sizes[0]))
    print("script/paper: working set", file=sys.stderr)
    result["law"] = law(tool, options.law)
    stats = json.loads((options.work / "stats.json").read_text())
    result["machine"] = stats["machine"]
    print("script/paper: pictures", file=sys.stderr)
    result["pictures"] = figures.draw(tool, options.data)
    return result


def main():
    options = arguments()
    options.work.mkdir(parents=True, exist_ok=True)
    if options.page_only:
        result = json.loads(options.page_only.read_text())
    else:
        result = measure(options)
        (options.results or options.work / "results.json").write_text(json.dumps(result, separators=(",", ":")) + "\n")
    html = options.work / "index.html"
    html.write_text(page.html_of(result, options.work))
    print(html)


if __name__ == "__main__":
    main()
