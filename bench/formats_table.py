# SPDX-License-Identifier: MIT
"""The tables of script/bench formats as Markdown, and their place in docs/performance.md."""
import committed


def comparisons(result):
    """Returns the rows of the table: the comparison, the figures of both sides, and their ratio. A figure is the median of CPU or wall
    seconds."""
    median = {row["program"]: row["median"] for row in result["rows"]}
    threads = result["threads"]

    def cpu(label):
        return median[label]["cpu_seconds"]

    def wall(label):
        return median[label]["wall_seconds"]

    codec = f"decode LAZ, {threads} threads", f"encode LAZ with normals, {threads} threads"
    parts = cpu(codec[0]) + cpu(codec[1]) + cpu("normals LAS to LAS")
    yield "`normals` LAZ to LAZ over decoding and encoding alone and `normals` LAS to LAS", "CPU s", cpu("normals LAZ to LAZ"), parts, "at most 1.25"
    for label, what in (("decode LAZ", "decoding"), ("encode LAZ with normals", "encoding"), ("read .laz", "reading LAZ by pointsweep")):
        yield f"{what}, 1 thread over 2", "wall s", wall(f"{label}, 1 threads"), wall(f"{label}, 2 threads"), "at least 1.85"
    yield "reading LAZ by laspy with lazrs over pointsweep", "CPU s", cpu("laspy reads .laz"), cpu("read .laz"), ""
    yield "reading LAZ by laspy with lazrs over pointsweep", "wall s", wall("laspy reads .laz"), wall("read .laz"), ""
    yield ("that read and normals by nanoflann over `normals` LAZ to LAS", "CPU s", cpu("laspy reads .laz") + cpu("nanoflann LAS to LAS"),
           cpu("normals LAZ to LAS"), "")


def reads(result):
    """Millions of points a second by the wall, and of CPU, of each format; over PLY by CPU."""
    median = {row["program"]: row["median"] for row in result["rows"]}
    millions = result["points"] / 1e6
    ply = median["read .ply"]["cpu_seconds"]
    for label, figures in median.items():
        if label.startswith("read ") and "threads" not in label:
            yield label.removeprefix("read .").upper(), millions / figures["wall_seconds"], millions / figures["cpu_seconds"], figures["cpu_seconds"] / ply


def of(result):
    machine = result["machine"]
    lines = [f"{result['shape']}, {result['points'] / 1e6:g}M points in {result['order']} order, k = {result['k']}, {result['threads']} threads, medians of "
             f"{len(result['rows'][0]['runs'])}; {machine['cpu']}, {machine['cpus']} cores, commit {result['commit']}, {result['date']}.", "",
             "| compared | figure | first | second | ratio | wanted |", "|---|---|---|---|---|---|"]
    lines += [f"| {what} | {figure} | {a:.2f} | {b:.2f} | {a / b:.2f} | {wanted} |" for what, figure, a, b, wanted in comparisons(result)]
    lines += ["", "| reading | Mpoints a second | Mpoints a CPU second | CPU over PLY |", "|---|---|---|---|"]
    lines += [f"| {name} | {by_wall:.1f} | {by_cpu:.1f} | {over:.1f} |" for name, by_wall, by_cpu, over in reads(result)]
    if large := result.get("large"):
        free, limited = large["free"], large["limited"]
        lines += ["", f"{large['points'] / 1e6:g}M points, LAZ to LAZ: with `--memory {large['memory']}` {limited['cpu_seconds']:.1f} CPU s and a peak of "
                  f"{limited['peak_rss_bytes'] / 2**20:.0f} MiB, without it {free['cpu_seconds']:.1f} CPU s and {free['peak_rss_bytes'] / 2**20:.0f} MiB; the same bytes."]
    return "\n".join(lines) + "\n"


def write(results, paths):
    tables = "\n".join(of(result) for result in results)
    committed.write_table("formats", f"{tables}\nRuns in {committed.names(paths)}.\n")
