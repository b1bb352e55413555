# SPDX-License-Identifier: MIT
"""Small tables for notebooks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def span_rows(bounds: tuple[Sequence[float], Sequence[float]] | None) -> list[tuple[str, str]]:
    """Returns a row for each axis, with the range of its coordinates; no rows if there are no bounds."""
    return [] if bounds is None else [(axis, f"{low:.10g} to {high:.10g}") for axis, low, high in zip("xyz", *bounds)]


def html_table(caption: str, header: Sequence[str] | None, rows: Iterable[Sequence[str]]) -> str:
    """Returns an HTML table of texts, whose first column is bold."""

    import html

    def cells(tag: str, texts: Sequence[str]) -> str:
        return "".join(f"<{tag}>{html.escape(text)}</{tag}>" for text in texts)

    lines = [f"<table><caption>{html.escape(caption)}</caption>"]
    if header is not None:
        lines.append(f"<thead><tr>{cells('th', header)}</tr></thead>")
    lines += [f"<tr>{cells('th', row[:1])}{cells('td', row[1:])}</tr>" for row in rows]
    return "\n".join([*lines, "</table>"])
