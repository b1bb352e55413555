# SPDX-License-Identifier: MIT
"""A hook of mkdocs: lists begin right after a paragraph or a block, as on GitHub. mkdocs itself wants an empty line before them."""
import re

FENCE = re.compile(r"^\s*```")
ITEM = re.compile(r"^\s*([-*]|\d+\.) ")


def on_page_markdown(markdown, **_):
    lines, in_block = [], False
    for line in markdown.split("\n"):
        before = lines[-1] if lines else ""
        if not in_block and ITEM.match(line) and before.strip() and not ITEM.match(before) and not before.startswith(" "):
            lines.append("")
        if FENCE.match(line):
            in_block = not in_block
        lines.append(line)
    return "\n".join(lines)
