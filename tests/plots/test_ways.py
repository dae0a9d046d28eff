"""Figures of made-up ways to compute a bed, a fit and a field map."""

import json
import sys
import unittest

from plot_case import PlotCase


def found(quantity, bias, scatter=0.0, scale=1.0):
    return {"quantity": quantity, "unit": "1", "value": scale, "error": 0.3 * scatter, "scatter": scatter, "bias": bias, "bias_error": 0.4 * scatter, "scale": scale}


def way(keys, seconds, *quantities, status="ok"):
    return {"keys": keys, "seconds": seconds, "runs": 10, "found": list(quantities), "status": status}


def bed(step, duration, bias, seconds):
    return way([f'granular.time_step="{step} s"', f'granular.duration="{duration} s"'], seconds,
               found("rod_speed", bias, 2e-4, 2e-3), found("T_z", 1e-6, 1e-6, 1.7e-3))


def fit(method, polish, starts, likelihood, optimum):
    keys = [f'fit.method="{method}"', f"fit.polish={polish}", f"fit.starts={starts}", f"fit.likelihood=[{likelihood}]"]
    return way(keys, 0.01 * starts, found("optimum", optimum), found("interval", 0.2 if not likelihood else 1e-9))


BED = [bed(5e-6, 4, 0.0, 4.0), bed(1e-5, 4, 1e-4, 2.0), bed(2e-5, 4, 4e-4, 1.0), bed(1e-5, 2, 2e-4, 1.0),
       way(['granular.time_step="1 s"', 'granular.duration="4 s"'], 1.0, status="too long a step")]
FIT = [fit("slsqp", "true", 1, "", 1e-8), fit("mma", "false", 10, "", 1e-4), fit("slsqp", "true", 10, '"xi"', 0.0), fit("bobyqa", "false", 1, "", None)]
FIELD = [way(['medium.field="exact"'], 1e-3, *(found(name, 2e-13) for name in ("displacement", "strain", "gradients"))),
         way(['medium.field="table"', "medium.table.tolerance=1e-06"], 5e-4, found("displacement", 2e-13), found("strain", 3e-7), found("gradients", 1e-7))]


class WaysFigureTest(PlotCase):
    def build(self):
        self.tell("bed", BED)

    def tell(self, part, ways):
        (self.folder / "ways.json").write_text(json.dumps({"of": part, "ways": ways}))

    def axes(self):
        from rodwake_plots import tradeoff  # found by plot_case
        record = json.loads((self.folder / "ways.json").read_text())
        return {"bed": tradeoff.draw_bed, "fit": tradeoff.draw_fit, "field": tradeoff.draw_field}[record["of"]]([one for one in record["ways"] if one["found"]]).axes

    def test_all_are_drawn(self):
        for part, ways in (("bed", BED), ("fit", FIT), ("field", FIELD)):
            with self.subTest(part):
                self.tell(part, ways)
                self.assert_drawn("ways")

    def test_bias_counts_as_far_as_it_exceeds_its_error(self):
        curves = [line for line in self.axes()[1].lines]
        self.assertEqual(len(curves), 4)  # one for each way with a result
        floors = [line.get_ydata()[-1] for line in curves]
        self.assertLess(floors[0], 0.2)  # unbiased: the scatter of 10^4 runs alone, 10 %/100
        self.assertAlmostEqual(floors[2], 100 * ((4e-4 ** 2 - 8e-5 ** 2) / 2e-3 ** 2 + (0.1 / 100) ** 2) ** 0.5, delta=1e-6)

    def test_biases_are_those_of_the_full_duration(self):
        points = self.axes()[0].containers[0].lines[0]
        self.assertEqual([round(y, 6) for y in points.get_ydata()], [0.0, 5.0, 20.0])

    def test_only_the_reference_has_a_result(self):
        self.tell("bed", [bed(5e-6, 4, 0.0, 4.0), BED[-1]])
        bias, costs = self.axes()
        self.assertEqual((len(bias.containers), len(costs.lines)), (2, 1))

    def test_a_scale_of_zero_does_not_divide(self):
        ways = [way(one["keys"], 1.0, found("rod_speed", 0.0, 2e-4, 0.0)) for one in BED[:2]]
        self.tell("bed", ways)
        self.assertAlmostEqual(self.axes()[1].lines[0].get_ydata()[0], 100 * 2e-4)

    def test_nothing_to_show_is_reported(self):
        self.tell("bed", [way(BED[0]["keys"], 1.0, found("rod_speed", None))])
        self.assert_fails("no configuration of the longest duration")

    def test_no_result_is_reported(self):
        self.tell("bed", BED[-1:])
        self.assert_fails("no configuration has a result")


if __name__ == "__main__":
    sys.exit(unittest.main())
