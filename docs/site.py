# SPDX-License-Identifier: MIT
"""Two hooks of mkdocs. Lists begin right after a paragraph or a block, as on GitHub; mkdocs itself wants an empty line before them. Blocks of formulas
(```text on the page of the operators) are set as mathematics: indices, powers, signs and variables, by HTML alone, so that no page needs a network."""
import html
import re

FENCE = re.compile(r"^\s*```")
ITEM = re.compile(r"^\s*([-*]|\d+\.) ")
FORMULAS = re.compile(r"^```text\n(.*?)^```$", re.MULTILINE | re.DOTALL)
INDEX = r"(?:[ijPrz0-9]|\([^()]*\))"
SIGNS = [("&lt;=", "≤"), ("&gt;=", "≥"), (" - ", " − "), ("(-", "(−"), (" * ", " · "), (" . ", " · "), ("sqrt(", "√("),
         ("²", "<sup>2</sup>"), ("³", "<sup>3</sup>"), ("(r-1)", "(r−1)")]
SETTINGS = [
    (re.compile(r"\^(T\b|-?\d+|\([^()]*\))"), r"<sup>\1</sup>"),
    (re.compile(rf"([^\W_])_({INDEX})(?!\w)"), r"\1<sub>\2</sub>"),
    (re.compile(r"(?<![\w.])([λμeltk])(\d)(?!\w)"), r"\1<sub>\2</sub>"),
    (re.compile(r"(?<![\w&'])(?<!</)(?<!<)([B-HJ-Zb-zα-ωθΠΦ]̄?)(?![\w>'])(?!\.\w)"), r"<i>\1</i>"),
    (re.compile(r"(?<![\w&'])(?<!</)(?<!<)([aA])(?=<sub>|[(,)])"), r"<i>\1</i>"),
]


def formula(text):
    text = html.escape(text, quote=False)
    for sign, set_sign in SIGNS:
        text = text.replace(sign, set_sign)
    for pattern, setting in SETTINGS:
        text = pattern.sub(setting, text)
    return text


def set_formulas(block):
    """A paragraph for each line; a line that begins with a space goes on with the one before."""
    lines = re.sub(r"\n +", " ", block[1]).splitlines()
    return '<div class="formulas">' + "".join(f"<p>{formula(line)}</p>" for line in lines) + "</div>"


def on_page_markdown(markdown, page=None, **_):
    if page is not None and page.file.src_uri == "operators.md":
        markdown = FORMULAS.sub(set_formulas, markdown)
    lines, in_block = [], False
    for line in markdown.split("\n"):
        before = lines[-1] if lines else ""
        if not in_block and ITEM.match(line) and before.strip() and not ITEM.match(before) and not before.startswith(" "):
            lines.append("")
        if FENCE.match(line):
            in_block = not in_block
        lines.append(line)
    return "\n".join(lines)
