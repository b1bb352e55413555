# SPDX-License-Identifier: MIT
"""Makes one self-contained page: the tables and figures of the paper, with its numbers beside ours."""
import base64
import html

import svg

# Tables 1 and 2 of the paper: stream size in MB, reading, sorting; output MB, seconds and lifespan of Normal and Curvature.
PAPER = {
    2000646: ("David head", 30, 12, 1.5, (61, 173, 0.66), (122, 223, 1.45)),
    4129534: ("David 2mm", 63, 19, 3.4, (126, 362, 0.62), (252, 470, 1.36)),
    14022961: ("Lucy", 214, 52, 11, (428, 1592, 4.78), (856, 2005, 6.17)),
    28168109: ("David 1mm", 430, 125, 22, (859, 9236, 23.62), (1719, 10365, 29.27)),
    102965801: ("St. Matthew", 1571, 35, 93, (3142, 18145, 7.56), (6284, 28274, 13.0)),
}
STYLE = """body{font:15px/1.5 system-ui,sans-serif;max-width:900px;margin:2em auto;padding:0 1em;color:#1b1e23}
h2{font-size:1.15em;margin-top:2em}table{border-collapse:collapse;font-variant-numeric:tabular-nums}
td,th{padding:.15em .9em .15em 0;border-bottom:1px solid #e4e6ea;text-align:right;font-weight:normal}th{color:#5b626c}
td:first-child,th:first-child{text-align:left}i{color:#8a5a00;font-style:normal}
svg{max-width:760px;width:100%;height:auto;font:12px system-ui,sans-serif;fill:#454b54;margin:.6em 0}svg .title{font-weight:600;fill:#1b1e23}
svg .grid{stroke:#e4e6ea}svg .line{fill:none;stroke-width:1.6;stroke-linejoin:round}svg .inside{fill:#fff}
figure{margin:1em 0}img{max-width:100%;height:auto}figcaption{color:#5b626c;font-size:.9em}"""


def name_of(count):
    return PAPER[count][0] if count in PAPER else f"{svg.short(count)}"


def clock(seconds):
    if seconds < 60:
        return f"{seconds:.1f} s"
    minutes, seconds = divmod(round(seconds), 60)
    return f"{minutes // 60}:{minutes % 60:02}:{seconds:02}" if minutes >= 60 else f"{minutes}:{seconds:02}"


def table(head, rows):
    cells = "".join(f"<th>{html.escape(h)}</th>" for h in head)
    body = "".join("<tr>" + "".join(f"<td>{c}</td>" for c in row) + "</tr>" for row in rows)
    return f"<table><tr>{cells}</tr>{body}</table>"


def paper(value):
    """The paper's own number, in its colour; a dash where the paper has no model of this size."""
    return f"<i>{value}</i>" if value is not None else ""


def table_1(clouds):
    rows = []
    for count, c in clouds.items():
        p = PAPER.get(count)
        seconds = c["sort"]["seconds"]
        rows.append([name_of(count), f"{count:,}", f"{c['input_bytes'] / 1e6:,.0f}", f"{c['sort']['output_bytes'] / 1e6:,.0f}",
                     paper(p and f"{p[1]:,}"), clock(seconds["order"]), paper(p and clock(p[2])), clock(seconds["write"]), paper(p and clock(p[3]))])
    return table(["size of", "points", "input MB", "stream MB", "paper", "reading, distributing", "paper: reading", "sorting, writing",
                  "paper: sorting"], rows)


def table_2(clouds):
    rows = []
    for count, c in clouds.items():
        p = PAPER.get(count)
        for i, (name, run) in enumerate((("Normal", c["normal"]), ("Curvature", c["curvature 2G"]))):
            ours = p and p[4 + i]
            rows.append([name_of(count) if i == 0 else "", name, f"{run['output_bytes'] / 1e6:,.0f}", paper(ours and f"{ours[0]:,}"),
                         clock(run["seconds"]["total"]), paper(ours and clock(ours[1])),
                         f"{run['lifespan_seconds']['mean']:.2g} s", paper(ours and f"{ours[2]} s"),
                         f"{ours[1] / run['seconds']['total']:,.0f}" if ours else ""])
    return table(["size of", "pipeline", "output MB", "paper", "time", "paper", "lifespan", "paper", "times faster"], rows)


def shares(rows, count):
    return [(x, 100 * y / count) for x, y in rows]


def figure_4(clouds, reference):
    out = []
    for count, c in clouds.items():
        run = c["curvature 2G"]
        series = {"window": shares(run["series"], count)}
        series.update({b["operator"]: shares(b["series"], count) for b in run["buffers"]})
        out.append(svg.lines(f"{name_of(count)}: {count:,} points", "points read", "% of the cloud that is active", series))
    count = reference["points"]
    series = {b["operator"]: shares(b["series"], count) for b in reference["buffers"] if max(y for _, y in b["series"]) > 1}
    out.append(svg.lines(f"The paper's own algorithm, {count:,} points", "points read", "% of the cloud in the buffers", series))
    seconds, ours = reference["seconds"]["total"], clouds[count]["curvature 2G"]["seconds"]["total"]
    out.append(f"<p>It took {clock(seconds)}, ours {clock(ours)}. Buffers that hold one point at a time are left out, as in the paper.</p>")
    return "\n".join(out)


def figure_5(clouds):
    groups = {name_of(count): {memory: c[f"curvature {memory}"]["seconds"]["total"] for memory in ("256M", "2G")} for count, c in clouds.items()}
    rows = [[name_of(count)] + [f"{c[f'curvature {memory}']['peak_rss_bytes'] / 2**20:,.0f} MiB" for memory in ("256M", "2G")]
            for count, c in clouds.items()]
    return svg.grouped("Curvature pipeline within 256 MB and 2 GB", "s", groups) + table(["largest resident set", "256M", "2G"], rows)


def figure_6(clouds):
    rows = {}
    for count, c in clouds.items():
        seconds = c["curvature 2G"]["seconds"]
        parts = {"reading, cutting": seconds["read"], "neighbours": seconds["search"], **seconds["operators"]}
        whole = sum(parts.values())
        rows[name_of(count)] = {part: 100 * value / whole for part, value in parts.items()}
    return svg.stacked("Share of time of the operators, summed over threads", rows)


def working_set_law(law):
    rows = [[f"{r['points']:,}", f"{r['peak']:,}", f"{100 * r['peak'] / r['points']:.2f} %", f"{100 * r['mean'] / r['points']:.2f} %"]
            for r in law["rows"]]
    text = table(["points", "peak of the window", "share", "mean share"], rows)
    if law["exponent"] is None:
        return text
    plot = svg.lines("Peak of the window against the size of the cloud", "points", "active points",
                     {"peak": [(r["points"], r["peak"]) for r in law["rows"]]}, log=True, dots=True)
    return (text + f"<p>The peak grows like n<sup>{law['exponent']:.2f}</sup>; a surface cut by a plane is a curve, n<sup>0.5</sup>. "
            "The paper reports 0.2 % to 2 %, most models staying below 0.5 %.</p>" + plot)


def pictures(figures, folder):
    out = []
    for picture in figures:
        file = folder / picture["file"]
        caption = html.escape(picture["caption"])
        if file.exists():
            data = base64.b64encode(file.read_bytes()).decode()
            out.append(f'<figure><img alt="{caption}" src="data:image/png;base64,{data}"><figcaption>{caption}</figcaption></figure>')
        else:
            out.append(f"<p>(No picture: {caption}. Run script/paper.)</p>")
    return "\n".join(out)


def html_of(result, folder):
    clouds = {int(count): cloud for count, cloud in result["clouds"].items()}
    shown = result["pictures"]
    parts = [
        ("Table 1: ordering", "<p>Ours are generated statues of the same numbers of points (binary PLY with normals); the paper's were scans in ASCII "
         "PLY. Its numbers (1.8 GHz PowerMac G5, 2005) are in <i>this colour</i>.</p>" + table_1(clouds)),
        ("Table 2: pipelines and lifespans", "<p>k = 8, whole runs from file to file, ordering included, which the paper counts in Table 1. The lifespan is the time a point spends in the "
         "window.</p>" + table_2(clouds)),
        ("Figure 1: a frame of the sweep", pictures(shown["figure 1"], folder)),
        ("Figure 4: working set", "<p>Curvature pipeline. The paper's buffers hardly ever hold 0.5 % of the points, 2 % at Lucy's peak.</p>" + figure_4(clouds, result["reference"])),
        ("Figure 5: independence of memory", figure_5(clouds)),
        ("Figure 6: share of the operators", figure_6(clouds)),
        ("Figure 7: normals and curvature", pictures(shown["figure 7"], folder)),
        ("Figure 8: fairing", pictures(shown["figure 8"], folder)),
        ("Figure 9: fairing a scan", pictures(shown["figure 9"], folder)),
        ("The law of the working set", working_set_law(result["law"])),
    ]
    body = "\n".join(f"<h2>{title}</h2>\n{content}" for title, content in parts)
    about = f"{html.escape(result['machine'])}; {result['date']}, commit {result['commit']}"
    return (f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>Stream-Processing Points, again</title><style>{STYLE}</style></head>\n'
            f"<body><h1>Stream-Processing Points, again</h1>\n<p>The tables and figures of R. Pajarola, IEEE Visualization 2005, made by pointsweep. "
            f"{about}.</p>\n{body}\n</body></html>\n")
