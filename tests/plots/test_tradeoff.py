"""The work-precision figure of a made-up tradeoff: errors of 0, infinite ones, kinds that no setting has."""

import json
import sys
import unittest

from plot_case import PlotCase

HEAD = "method,form,field,tolerance,error,seconds,rhs_evaluations,table_tolerance,precision,final_state,contact_time,outcome,path,repeats,status"
ROWS = [("erk,angle,exact", 1e-3, 1e-4, 1e-4), ("erk,angle,exact", 1e-6, 1e-7, 2e-4), ("bdf,dae,exact", 1e-3, "inf", 3e-4),
        ("adams,angle,table", 1e-6, 2e-6, 4e-4), ("bdf,director,exact", 1e-6, 0, 8e-4)]


def row(way, tolerance, error, seconds):
    table = "1e-06" if way.endswith("table") else ""
    return f"{way},{tolerance:g},{error},{seconds},{1e6 * seconds:.0f},{table},full,{error},,0,{error},3,{'ok' if error != 'inf' else 'took too long'}"


class TradeoffFigureTest(PlotCase):
    def build(self):
        self.write(ROWS, {"final_state": 1e-9, "contact_time": None, "outcome": 0.0, "path": 1e-9})

    def write(self, rows, least, kind="final_state"):
        (self.folder / "tradeoff.csv").write_text("\n".join([HEAD, *(row(*one) for one in rows)]) + "\n")
        record = {"unit": "a run", "error": kind, "reference": {"least_error_quoted": least}}
        (self.folder / "tradeoff.json").write_text(json.dumps(record))

    def test_drawn_alone(self):
        self.assert_drawn("tradeoff")

    def test_front_is_what_no_other_setting_beats(self):
        from rodwake_plots import tradeoff  # found by plot_case
        axes = tradeoff.draw(self.folder).axes[0]
        front = max(axes.lines, key=lambda line: line.get_linewidth())
        self.assertEqual(list(front.get_xdata()), [1e-4, 2e-4, 8e-4])
        self.assertEqual(list(front.get_ydata())[:2], [1e-4, 1e-7])

    def test_errors_of_nothing_at_all(self):
        self.write([(way, tolerance, 0, seconds) for way, tolerance, _, seconds in ROWS], {"outcome": 0.0}, kind="outcome")
        self.assert_drawn("tradeoff")

    def test_a_kind_that_no_setting_has(self):
        self.write([(way, tolerance, "inf", seconds) for way, tolerance, _, seconds in ROWS], {"final_state": 1e-9})
        self.assert_fails("no setting has a final_state")

    def test_a_damaged_table(self):
        (self.folder / "tradeoff.csv").write_text(HEAD + "\nerk,angle\n")
        self.assert_fails("tradeoff.csv", "values in another")


if __name__ == "__main__":
    sys.exit(unittest.main())
