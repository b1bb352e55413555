# SPDX-License-Identifier: MIT
"""Two versions of the tool over every operator and format of the registry, in both orders, on tiles, with checkpoints, within 64M and on 1 and 2 threads.

Compared are all files that a run writes, its exit status, its statistics but for times, windows, recalls and those that the old version has not, the plan of a dry run but for sizes, and what it says but for times and
memory. Differences that are intended are listed in a file: one line each, "PATTERN: reason", where PATTERN is a regular expression for names of cases. Ends with
status 1 if another difference is found, or if a listed one is not there."""
import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import cases
import inputs

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "bench"))
IGNORED = {"working_set", "buffers", "recalled", "recall_share", "peak_rss_bytes", "memory_budget_bytes", "ordering", "read", "spilled"}
SIZES = re.compile(r"[\d.]+ ?([kKMGT]i?B?|bytes?|s|s,)\b|[\d.]+[KMG]?/s")


def arguments():
    parser = argparse.ArgumentParser(prog="script/same-bytes", description=__doc__)
    parser.add_argument("old", help="commit or tool that sets the bytes")
    parser.add_argument("new", help="commit or tool that is compared")
    parser.add_argument("--intended", type=pathlib.Path, help="file that lists intended differences")
    parser.add_argument("--only", default="", help="regular expression: only cases whose names match")
    parser.add_argument("--text", action="store_true", help="also compare sentences, on both streams, but for times and memory")
    parser.add_argument("--work", type=pathlib.Path, help="keep inputs and outputs in this folder")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    return parser.parse_args()


def tool_of(name):
    if os.path.isfile(name) and os.access(name, os.X_OK):
        return os.path.abspath(name)
    import against

    return str(against.build_of(name)[1])


def digest_of(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def lasting(value):
    """Statistics without what differs from one run to the next."""
    if not isinstance(value, dict):
        return value
    return {key: lasting(part) for key, part in value.items() if key not in IGNORED and not key.startswith("spilled_") and "seconds" not in key}


def statistics_of(path):
    return lasting(json.loads(path.read_text().replace(str(path.parent), "RUN"))) if path.exists() else None


def outcome(tool, case, folder, options):
    """What a run writes and says, as values that can be compared."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    out = folder / case.out
    if case.out.endswith("/"):
        out.mkdir()
    words = [word.format(out=out, run=folder) if word.startswith(("{out}", "{run}")) else word for word in case.arguments]
    plans = "--dry-run" in words
    if words[0] != "info" and not plans:
        words += ["--stats", folder / "statistics.json"]
    done = subprocess.run([tool, *words], cwd=options.work / "inputs", capture_output=True, text=True)
    told = SIZES.sub("#", (done.stdout + done.stderr).replace(str(folder), "RUN"))
    files = [out] if out.is_file() else sorted(out.glob("*"))
    result = {"status": done.returncode, "files": {file.name: digest_of(file) for file in files}, "statistics": statistics_of(folder / "statistics.json")}
    if plans or words[0] == "info" or options.text:
        result["said"] = told
    shutil.rmtree(folder)
    return result


def compare(case, tools, options):
    label = re.sub(r"\W+", "-", case.name)
    old, new = (outcome(tool, case, options.work / side / label, options) for tool, side in zip(tools, ("old", "new")))
    if old["statistics"] and new["statistics"]:
        new["statistics"] = {key: value for key, value in new["statistics"].items() if key in old["statistics"]}
    return case, [f"{key}: {old.get(key)} -> {new.get(key)}" for key in old if old.get(key) != new.get(key)], old


def intended_of(path):
    lines = [line.split(": ", 1) for line in (path.read_text().splitlines() if path else []) if line and not line.startswith("#")]
    return {re.compile(pattern): reason for pattern, reason in lines}


def report(results, intended):
    """Prints every difference; the names of those that nothing allows, and the patterns that allowed nothing."""
    wrong, unused = [], set(intended)
    for case, differences, old in results:
        if not differences:
            continue
        pattern = next((pattern for pattern in intended if pattern.search(case.name)), None)
        unused.discard(pattern)
        print(f"{'intended' if pattern else 'DIFFERENT'}: {case.name}" + (f" ({intended[pattern]})" if pattern else ""))
        if not pattern:
            wrong.append(case.name)
            for difference in differences:
                print(f"    {difference}"[:2000])
    for pattern in unused:
        print(f"listed as intended, but not there: {pattern.pattern}")
    return wrong, unused


def main():
    options = arguments()
    tools = tool_of(options.old), tool_of(options.new)
    with tempfile.TemporaryDirectory(prefix="pointsweep-same-bytes-") as temporary:
        options.work = (options.work or pathlib.Path(temporary)).resolve()
        inputs.make(tools[0], options.work / "inputs")
        chosen = [case for case in cases.cases(tools[0]) if re.search(options.only, case.name)]
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            results = list(pool.map(lambda case: compare(case, tools, options), chosen))
    wrong, unused = report(results, intended_of(options.intended))
    refused = [case.name for case, _, old in results if old["status"] != 0]
    missing = {operator["name"] for operator in cases.operators(tools[0])} - {operator["name"] for operator in cases.operators(tools[1])}
    print(f"{len(results)} cases; {len(refused)} refused: {'; '.join(refused)}; {len(wrong)} differ" + (f"; operators gone: {', '.join(sorted(missing))}" if missing else ""))
    sys.exit(bool(wrong or unused or missing))


if __name__ == "__main__":
    main()
