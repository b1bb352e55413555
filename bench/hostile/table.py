# SPDX-License-Identifier: MIT
"""Prints the tables of docs/reliability.md from results of script/hostile: python3 bench/hostile/table.py RESULT.json..."""
import json
import sys


def chains_table(result):
    """Returns the table of script/hostile --operators: a row for each chain, over all clouds."""
    print("| chain | clouds | least memory | peak memory | time: median | most, of | missed |\n|---|---|---|---|---|---|---|")
    for chain in result["chains"]:
        rows = [row for row in result["rows"] if row["chain"] == chain]
        ran = [row for row in rows if "cpu_seconds" in row]
        ratios = sorted((row["ratio"], row["cloud"]) for row in ran if "ratio" in row)
        memory = [row["memory_mib"] for row in ran]
        missed = [f"{row['cloud']}: {goal}" for row in rows for goal in row["missed"] if goal != "time"]
        print(f"| {chain} | {len(ran)} | {min(memory)} to {max(memory)} MiB | {max(row['peak_rss_mib'] for row in ran)} MiB | {ratios[len(ratios) // 2][0]:.2f} "
              f"| {ratios[-1][0]:.2f}, {ratios[-1][1]} | {'; '.join(missed) or '-'} |")


def clouds_table(results):
    print("| cloud | points | time | peak memory | window | recalled | chain of three steps | peak memory | recalled | missed |\n|---|---|---|---|---|---|---|---|---|---|")
    for result in results:
        for row in result["rows"]:
            name = f"| {row['cloud']} | {row['points'] / 1e6:g}M |"
            if "ratio" not in row:
                print(f"{name} | | | | | | | {row['verdict']} |")
                continue
            print(f"{name} {row['ratio']:.2f} | {row['peak_rss_mib']} of {result['memory_mib']} MiB "
                  f"| {row['window_percent']:.2f} % ({row['clean_window_percent']:.2f} %) | {row['recalled']} "
                  f"| {row.get('deep_ratio', '-')} | {row.get('deep_peak_rss_mib', '-')} MiB | {row.get('deep_recalled', '-')} "
                  f"| {', '.join(row['missed']) or '-'} |")


def main():
    results = [json.load(open(path)) for path in sys.argv[1:]]
    for result in results:
        if "chains" in result:
            chains_table(result)
    if clouds := [result for result in results if "chains" not in result]:
        clouds_table(clouds)


if __name__ == "__main__":
    main()
