# SPDX-License-Identifier: MIT
"""The formulas of docs/operators.md on the site (docs/site.py), read as a browser shows them: what is raised, lowered and slanted."""
import importlib.util
import pathlib
import re
import unittest

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs"
found = importlib.util.spec_from_file_location("hooks", DOCS / "site.py")  # `site` is a module of Python itself
hooks = importlib.util.module_from_spec(found)
found.loader.exec_module(hooks)


def seen(text):
    """{} holds what is lowered, ^{} what is raised, * stands before a slanted letter."""
    text = text.replace("<sub>", "{").replace("</sub>", "}").replace("<sup>", "^{").replace("</sup>", "}")
    return re.sub(r"<i>(.*?)</i>", r"*\1", text)


class Formulas(unittest.TestCase):
    def test_each_is_set_as_mathematics(self):
        for plain, expected in [
            ("M_i = 1/|N_i| Σ_j (p_j - p_i)^T", "*M{*i} = 1/|*N{*i}| Σ{*j} (*p{*j} − *p{*i})^{*T}"),
            ("|p - q|² <= R·R", "|*p − *q|^{2} ≤ *R·*R"),
            ("√(μ1 / t1^T D t1) >= 2^-40", "√(*μ{1} / *t{1}^{*T} *D *t{1}) ≥ 2^{-40}"),
            ("A point a of 3 < 4 points: mean_k, k_min", "A point a of 3 &lt; 4 points: mean_k, k_min"),
            ("seed ^ x", "seed ^ *x"),
        ]:
            self.assertEqual(seen(hooks.formula(plain)), expected)

    def test_every_block_of_the_page_is_set(self):
        page = (DOCS / "operators.md").read_text()
        blocks = list(hooks.FORMULAS.finditer(page))
        self.assertEqual(len(blocks), page.count("```text"))
        for block in blocks:
            html = hooks.set_formulas(block)
            plain = re.sub(r"<[^>]+>", "", html).replace("&lt;", "<").replace("&gt;", ">")
            for word in re.findall(r"\w{4,}", block[1].replace("sqrt", "")):
                self.assertIn(re.sub(r"[_²³]", "", word), re.sub(r"[_²³]", "", plain))


if __name__ == "__main__":
    unittest.main()
