# SPDX-License-Identifier: MIT
"""Operators that filter, thin, connect, classify and compare, on the hostile clouds: the same bytes inside a hard limit of memory as without, and how slow.

Each chain runs with 4 GiB, and with --memory under RLIMIT_DATA = --memory + --constant. A chain that is refused with the least memory that it needs runs with that.
Lengths follow the cloud: `spacing` is that of `info`, `cell` a 512th of the longer side seen from above. CPU seconds are user +
system of the whole process under the limit, the least of --repeat; ratios are to those of the clean cloud, per point. The values are tested in tests/."""
import datetime
import json
import os
import re
import subprocess
import sys
import threading

import processes
from clouds import CLEAN

CHAINS = {
    "sor, where": "knn(k=8) | sor | where(outlier == 0)",
    "lof": "knn(k=8) | lof",
    "features": "knn(k=8) | features(names=[planarity,verticality])",
    "voxel, centroids": "voxel({spacing4}, keep=centroid)",
    "poisson, normals": "knn(k=8) | poisson({spacing4}) | normals",
    "components": "knn(radius={spacing2}) | components(distance={spacing2}) | where(component_size > 10)",
    "dbscan": "knn(radius={spacing2}) | dbscan(eps={spacing2}, min_points=5)",
    "segments": "knn(k=8) | normals | segments(angle=10)",
    "orient": "knn(k=8) | normals | orient",
    "ground, height": "ground(cell={cell}, window={cell18}) | height(k=3)",
    "distance_to": "distance_to({other})",
    "m3c2": "knn(k=8) | normals | m3c2({other}, cylinder={spacing4}, depth={spacing8})",
}
LEAST = re.compile(r"give --memory (\d+)([KMG])")


class Operators:
    def __init__(self, bench):
        self.bench = bench
        self.clean_seconds = {}
        (self.other,) = bench.inputs(CLEAN[0])

    def lengths(self, cloud):
        """Returns texts for the braces of CHAINS, without those for lengths that the cloud does not have."""
        told = subprocess.run([self.bench.tool, "info", "--json", *self.bench.inputs(cloud)], check=True, capture_output=True, text=True).stdout
        files = json.loads(told)["files"]
        spacing = max(file["spacing"] or 0 for file in files)
        low, high = ([pick(file["bounds"][end][axis] for file in files) for axis in (0, 1)] for end, pick in (("min", min), ("max", max)))
        cell = max(high[0] - low[0], high[1] - low[1]) / 512
        texts = {"other": f'"{self.other}"'}
        if spacing > 0:
            texts.update({f"spacing{times}": repr(times * spacing) for times in (2, 4, 8)})
        if cell > 0:
            texts.update(cell=repr(cell), cell18=repr(18 * cell))
        return texts

    def run(self, cloud, chain, output, memory):
        """Runs with a memory limit in MiB; 0: no limit."""
        options = self.bench.options
        limit = ["prlimit", f"--data={(memory + options.constant) * 2**20}"] if memory else []
        statistics = options.work / "statistics.json"
        command = [*limit, self.bench.tool, "run", *self.bench.inputs(cloud), "--output", output, "--memory", f"{memory or 4096}M",
                   "--temp-dir", options.work, "--stats", statistics, "--quiet", "--force", "--pipeline", chain, *cloud.options]
        process = subprocess.Popen([str(word) for word in command], stderr=subprocess.PIPE, text=True)
        timer = threading.Timer(options.patience, process.kill)
        timer.start()
        error = process.stderr.read().strip()
        _, status, usage = os.wait4(process.pid, 0)
        ended = timer.is_alive()
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        if not ended:
            return {"error": f"not finished within {options.patience} s"}
        if process.returncode != 0:
            return {"error": error or f"status {process.returncode}"}
        return {"error": "", "seconds": usage.ru_utime + usage.ru_stime, "peak": json.loads(statistics.read_text()).get("peak_rss_bytes", 0)}

    def limited(self, cloud, chain, output):
        """The run of the least CPU seconds under the limit, with the memory that it was given."""
        memory = self.bench.memory
        first = self.run(cloud, chain, output, memory)
        if least := LEAST.search(first["error"]):
            memory = int(least[1]) * {"K": 1, "M": 1024, "G": 1024**2}[least[2]] // 1024 + (least[2] == "K")
            first = self.run(cloud, chain, output, memory)
        runs = [first] + [self.run(cloud, chain, output, memory) for _ in range(self.bench.options.repeat - 1) if not first["error"]]
        return memory, min(runs, key=lambda r: r.get("seconds", 0))

    def try_chain(self, cloud, name, chain):
        work = self.bench.options.work
        free, bound = work / "free.ply", work / "bound.ply"
        row = {"cloud": cloud.name, "chain": name, "points": cloud.times * self.bench.points}
        whole = self.run(cloud, chain, free, 0)
        if whole["error"]:
            return {**row, "verdict": whole["error"]}
        memory, run = self.limited(cloud, chain, bound)
        if run["error"]:
            return {**row, "memory_mib": memory, "verdict": run["error"]}
        same = subprocess.run(["cmp", "-s", free, bound], check=False).returncode == 0
        return {**row, "memory_mib": memory, "peak_rss_mib": run["peak"] >> 20, "cpu_seconds": round(run["seconds"], 3), "verdict": "same" if same else "other bytes"}

    def rows_of(self, cloud):
        texts, rows = self.lengths(cloud), []
        for name, chain in CHAINS.items():
            if all(word in texts for word in re.findall(r"{(\w+)}", chain)):
                rows.append(self.try_chain(cloud, name, chain.format(**texts)))
        return rows

    def with_ratios(self, cloud, rows):
        if cloud.clean not in self.clean_seconds:
            clean = next(c for c in CLEAN if c.name == cloud.clean)
            self.clean_seconds[cloud.clean] = {r["chain"]: r.get("cpu_seconds") for r in self.rows_of(clean)}
        for row in rows:
            clean = self.clean_seconds[cloud.clean].get(row["chain"])
            if clean and "cpu_seconds" in row:
                row["ratio"] = round(row["cpu_seconds"] / cloud.times / clean, 2)
        return rows

    def missed(self, cloud, row):
        if cloud.refused and cloud.refused in row["verdict"]:
            return []
        if row["verdict"] != "same":
            return [row["verdict"]]
        return (["memory"] if row["peak_rss_mib"] > row["memory_mib"] else []) + (["time"] if row.get("ratio", 0) > 3 else [])


def main(bench, chosen):
    tried, all_rows, options = Operators(bench), [], bench.options
    print(f"{bench.points} points, --memory {bench.memory}M or the least that a chain needs, hard limit {options.constant} MiB above")
    print(f"{'cloud':<40}{'chain':<20}{'CPU s':>8}{'ratio':>7}{'MiB':>6}{'of':>6}  missed")
    for cloud in chosen:
        for row in tried.with_ratios(cloud, tried.rows_of(cloud)):
            row["missed"] = tried.missed(cloud, row)
            all_rows.append(row)
            print(f"{row['cloud']:<40}{row['chain']:<20}{row.get('cpu_seconds', 0):>8.2f}{row.get('ratio', 0):>7.2f}{row.get('peak_rss_mib', 0):>6}"
                  f"{row.get('memory_mib', 0):>6}  {', '.join(row['missed']) or 'all goals'}", flush=True)
    result = {"date": datetime.date.today().isoformat(), "commit": processes.commit(), "machine": processes.machine(), "points": bench.points,
              "memory_mib": bench.memory, "chains": CHAINS, "rows": all_rows}
    if options.output:
        options.output.parent.mkdir(parents=True, exist_ok=True)
        options.output.write_text(json.dumps(result, indent=1) + "\n")
    if any(goal in ("memory", "other bytes") for row in all_rows for goal in row["missed"]):
        sys.exit("script/hostile: a run took more than its --memory, or gave other bytes")
