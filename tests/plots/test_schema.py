"""Tests of what the plots take from schema.json: /usr/bin/python3 tests/plots/test_schema.py"""

import inspect
import re
import unittest
from dataclasses import fields
from pathlib import Path

import made_up_measured
import plot_case  # noqa: F401, where the plots are
from rodwake_plots import bed_run, draw, fit_words, schema, sections, series, words
from rodwake_plots.schema import Spec

MEDIUM = {"eta": 1.0, "xi": 2.5, "field": "exact", "table": {"tolerance": 1e-8}}
BED = {"phi_b": 0.8, "box": 0.0312, "plates": {"gap": 1.2e-3}, "contacts": {"rod_wall": {"friction": 0.03, "restitution": 0.1}},
       "rods": [{"position": [0.008, 0.0186], "heading": 0.0}]}


def table_of(scene, path, labels=sections.KeyLabels("reduced")):
    """Rows by key of the table with this header."""
    return {re.sub("<.*?>", "", row[0]): row[1:] for name, _, _, rows in sections.scene_tables(scene, labels) if f">{path}<" in name for row in rows}


class KindsTest(unittest.TestCase):
    def test_every_kind_is_drawn_or_written_by_one_module(self):
        self.assertEqual(sorted(kind for module in draw.MODULES for kind in module.KINDS), sorted(schema.FIGURES))
        for kind, made in draw.KINDS.items():
            self.assertTrue(bool(made.draw) != bool(made.write) and callable(made.caption), kind)

    def test_every_key_of_a_kind_can_be_asked_for(self):
        known = {one.name for one in fields(Spec)}
        for kind, entry in schema.FIGURES.items():
            self.assertEqual(set(entry["keys"]) - known, set(), kind)
            self.assertTrue(all(("figures[]", key) in schema.KEYS for key in entry["keys"]), kind)

    def test_a_module_reads_the_keys_that_its_kinds_have(self):
        """The reverse, where a module says it in so many words."""
        for module in draw.MODULES:
            used = set(re.findall(r"\bspec\.(\w+)", inspect.getsource(module))) - {"name", "kind", "title", "overlay"}  # the last is of the command line
            self.assertEqual(used - {key for kind in module.KINDS for key in schema.FIGURES[kind]["keys"]}, set(), module)

    def test_what_a_series_can_show_has_its_words(self):
        self.assertEqual(schema.KEYS["figures[]", "quantity"]["choices"], list(schema.FIGURES["series"]["quantities"]))
        self.assertEqual(set(bed_run.AGAINST), set(schema.KEYS["figures[]", "against"]["choices"]))
        quantities = [series.quantity_of(name) for name in schema.FIGURES["series"]["quantities"]]
        self.assertEqual(len({one.label for one in quantities}), len(quantities))


class MeasuresTest(unittest.TestCase):
    def test_every_value_of_a_measured_run_is_described(self):
        """The file is the program's own (tests/report compares)."""
        measures = {entry["measure"] for entry in schema.MEASURED} & set(made_up_measured.PATTERN)
        self.assertGreaterEqual(len(measures), 6)
        results = {name: made_up_measured.PATTERN[name] for name in measures}
        self.assertEqual({f"{entry['measure']}.{entry['key']}" for entry in schema.MEASURED if entry["measure"] in measures}, set(names(results)))

    def test_texts_are_texts_and_the_rest_is_none(self):
        part = bed_run.Part("", "", Path())
        part.results = made_up_measured.PATTERN
        for entry in schema.MEASURED:
            if entry["measure"] in part.results:
                self.assertEqual(isinstance(part.value(entry["measure"], entry["key"]), str), "factor" not in entry, entry)

    def test_titles_and_meanings_become_a_page(self):
        for entry in schema.MEASURED:
            for text in (entry.get("title", ""), entry["meaning"]):
                self.assertNotRegex(words.text_html(text), r"[\\{}$]|<i></i>|<sub></sub>", entry)


def names(table, before=""):
    """Dotted names of the values; an estimate is one."""
    for key, value in table.items():
        if isinstance(value, dict) and "samples" not in value:
            yield from names(value, f"{before}{key}.")
        else:
            yield before + key


class WordsTest(unittest.TestCase):
    def test_symbols(self):
        for tex, page in ((r"\gamma_1", "<i>γ</i><sub>1</sub>"), (r"f/\mu", "<i>f</i>/<i>μ</i>"), (r"t_\mathrm{end}", "<i>t</i><sub>end</sub>"),
                          (r"f_2 d/\mu", "<i>f</i><sub>2</sub><i>d</i>/<i>μ</i>"), (r"\Delta t", "Δ<i>t</i>"), ("", ""),
                          (r"U_x^{(0)}", "<i>U</i><sub><i>x</i></sub><sup>(<i>0</i>)</sup>".replace("<i>0</i>", "0"))):
            self.assertEqual(words.tex_html(tex), page)

    def test_text_with_formulas(self):
        for text, page in (("beads' & <rods>", "beads' &amp; &lt;rods&gt;"), (r"of $g_B \propto r^{-\eta_6}$, fitted", "of <i>g</i><sub><i>B</i></sub> ∝ <i>r</i><sup>−<i>η</i><sub>6</sub></sup>, fitted"),
                           (r"$\tilde{\Delta}(s)$ for $s \to 0$", "Δ\u0303(<i>s</i>) for <i>s</i> → 0"), (r"$\mathrm{exp}(-1)$", "exp(−1)"),
                           (r"$\kappa\,f = 0.5\ \mathrm{s}$", "<i>κ</i>\u2009<i>f</i> = 0.5\u2009s")):
            self.assertEqual(words.text_html(text), page)

    def test_every_symbol_of_the_schema_becomes_a_page(self):
        symbols = [one["symbol"] for one in (*schema.KEYS.values(), *schema.FIT_PARAMETERS.values()) if "symbol" in one]
        self.assertGreater(len(symbols), 20)
        for symbol in symbols:
            self.assertNotRegex(words.tex_html(symbol), r"[\\{}$]|<i></i>|<sub></sub>")

    def test_meanings(self):
        self.assertEqual(words.prose("gamma1_lap of kappa & mu, f_over_mu"),
                         "<i>γ</i><sub>1,lap</sub> of <i>κ</i> &amp; <i>μ</i>, f_over_mu")
        self.assertEqual(words.prose("zeta v0"), "<i>ζ</i> <i>v</i><sub>0</sub>")
        self.assertEqual(words.prose("eta of [fit], at times; \"eta\""), "<i>η</i> of [fit], at times; \"eta\"")

    def test_meanings_with_formulas(self):
        self.assertEqual(words.prose("N pi a^2 = phi_b L^2 in `a`"), "N π a<sup>2</sup> = <i>φ</i><sub>b</sub> L<sup>2</sup> in <code>a</code>")
        self.assertEqual(words.prose("|s|^(1/2) U"), "|s|^(1/2) U")
        self.assertEqual(words.number(None), "unknown")  # null in the program's files

    def test_every_unit_of_the_schema_becomes_a_page(self):
        units = {unit for key in schema.KEYS.values() for unit in key.get("unit", {}).values()} - {schema.PROFILES_UNIT}
        units |= {entry["unit"] for entry in schema.MEASURED if "unit" in entry}
        self.assertGreater(len(units), 8)
        for unit in units:
            self.assertNotRegex(fit_words.unit_html(unit), r"\bmu\b|\bv0\b|\^", unit)


class TablesTest(unittest.TestCase):
    def test_symbols_units_and_meanings(self):
        rows = table_of({"medium": MEDIUM}, "[medium]")
        self.assertEqual(rows["xi"], ("<i>ξ</i>", "2.5 <i>f</i>/<i>μ</i>", words.prose(schema.KEYS["medium", "xi"]["meaning"])))
        self.assertEqual(table_of({"medium": MEDIUM}, "[medium]", sections.KeyLabels("si"))["xi"][1], "2.5 m")
        self.assertEqual(table_of({"medium": MEDIUM}, "[medium.table]")["tolerance"][1], "10<sup>−8</sup>")

    def test_a_string_has_its_unit_already(self):
        self.assertEqual(table_of({"medium": {"xi": "2.5 f/mu"}}, "[medium]", sections.KeyLabels("si"))["xi"][1], "2.5 f/mu")

    def test_the_bed_is_si_in_every_scene(self):
        self.assertEqual(table_of({"granular": BED}, "[granular]")["box"][1], "0.0312 m")
        self.assertEqual(table_of({"granular": BED}, "[granular.plates]")["gap"][1], "0.0012 m")
        contact = table_of({"granular": BED}, "[granular.contacts]")["rod_wall"]
        self.assertEqual(contact[1:], ("friction = 0.03, restitution = 0.1", "Rods with floor and lid."))

    def test_lists_have_a_row_each_and_units_above(self):
        (_, meaning, heads, rows), = [one for one in sections.scene_tables({"granular": {"rods": BED["rods"]}}, sections.KeyLabels("reduced"))]
        self.assertEqual(heads, ["No.", "position (m)", "heading (rad)"])
        self.assertEqual((meaning, rows), ("One entry for each rod in the bed.", [["0", "0.008, 0.0186", "0"]]))

    def test_lengths_of_a_fit_are_in_the_unit_of_its_profiles(self):
        rows = table_of({"fit": {"core": 8.0, "heading": 0.5}}, "[fit]", sections.KeyLabels("reduced", "a"))
        self.assertEqual((rows["core"][1], rows["heading"][1]), ("8 <i>a</i>", "0.5 rad"))

    def test_keys_that_nobody_knows_stand_as_they_are(self):
        self.assertEqual(table_of({"medium": {"<new>": 1.0}}, "[medium]")["&lt;new&gt;"], ("", "1", ""))


if __name__ == "__main__":
    unittest.main()
