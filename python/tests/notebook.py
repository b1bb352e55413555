# SPDX-License-Identifier: MIT
"""Runs the code of a notebook, cell after cell, and collects what a notebook would show: values, tables, pictures.

    python notebook.py NOTEBOOK   writes these outputs into the notebook
"""

import ast
import base64
import contextlib
import io
import json
import os
import sys
import tempfile
from pathlib import Path

os.environ.setdefault("MPLBACKEND", "Agg")


@contextlib.contextmanager
def working_in(folder):
    before = os.getcwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def run_notebook(path: Path) -> dict:
    """The notebook with new outputs. Files that it writes are in a temporary folder."""
    import matplotlib.pyplot as plt

    notebook = json.loads(path.read_text())
    names: dict = {"__name__": "__main__"}
    number = 0
    with tempfile.TemporaryDirectory() as folder, working_in(folder):
        for cell in notebook["cells"]:
            if cell["cell_type"] != "code":
                continue
            number += 1
            printed, shown = io.StringIO(), None
            tree = ast.parse("".join(cell["source"]), f"{path.name}, cell {number}")
            last = ast.Expression(tree.body.pop().value) if isinstance(tree.body[-1], ast.Expr) else None
            with contextlib.redirect_stdout(printed):
                exec(compile(tree, f"{path.name}, cell {number}", "exec"), names)
                if last is not None:
                    shown = eval(compile(last, f"{path.name}, cell {number}", "eval"), names)
            cell["execution_count"] = number
            cell["outputs"] = list(_outputs(number, printed.getvalue(), shown, plt))
    return notebook


def _outputs(number, printed, shown, plt):
    if printed:
        yield {"output_type": "stream", "name": "stdout", "text": printed.splitlines(keepends=True)}
    if shown is not None and not plt.get_fignums():
        data = {"text/plain": repr(shown).splitlines(keepends=True)}
        if hasattr(shown, "_repr_html_"):
            data["text/html"] = shown._repr_html_().splitlines(keepends=True)
        yield {"output_type": "execute_result", "execution_count": number, "metadata": {}, "data": data}
    for figure in map(plt.figure, plt.get_fignums()):
        png = io.BytesIO()
        figure.savefig(png, format="png", dpi=60, bbox_inches="tight")
        plt.close(figure)
        text = base64.b64encode(png.getvalue()).decode()
        yield {"output_type": "display_data", "metadata": {}, "data": {"image/png": text + "\n"}}


if __name__ == "__main__":
    target = Path(sys.argv[1])
    target.write_text(json.dumps(run_notebook(target.resolve()), indent=1, ensure_ascii=False) + "\n")
