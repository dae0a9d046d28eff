"""Results are described once (core/record.hpp): a wrong description does not compile, and names are not quoted elsewhere."""

import json
import os
import re
import subprocess
import unittest
from pathlib import Path

from test_architecture import text_of, tracked

import rodwake

COMPILER = os.environ.get("CXX", "c++")
DESCRIBED = re.compile(r'\bfield\(\s*"(\w+)"')
# One of each in a namespace of its own; lines of each are counted as in a file of that name.
SOURCE = """namespace {name} {{
# 1 "{name}"
struct R {{ double speed = 0.0; static constexpr auto fields() {{ return std::tuple{{rodwake::field({text})}}; }} }};
inline const auto size = std::get<0>(R::fields()).name.size();
}}
"""
COUNTED = """namespace {name} {{
# 1 "{name}"
struct R {{ double speed{text}; static constexpr auto fields() {{ return std::tuple{{rodwake::field("speed", &R::speed, {{"m/s", "of the rod"}})}}; }} }};
static_assert(rodwake::undescribed_members<R>() == 0, "every member has its line");
}}
"""
KEPT = """namespace {name} {{ struct R {{ double x, y; }}; }}
# 1 "{name}"
template<> inline constexpr auto rodwake::store::parts<{name}::R> = rodwake::store::parts_of({text});
inline const auto {name}_size = rodwake::store::Kept<{name}::R>::layout().size();
"""
# Words that files of several kinds have in common.
GENERAL = set("algebraic bead bias blocks branch contact contacts cpu cutoff data drift error errors escape exponential failed failure fit high low mean median message model noise number other outcome "
              "command compare curve distance evaluations free git maps masks medium objective probability profile provenance regions remarks stderr tests text version worst "
              "pair particles path perpendicular phase points pressure pursuit reason rods rows run scale scatter seconds share sigma spring status steady steps theta time times total turn undecided unit used value".split())
# Names of described results that other C++ files quote, and why these may; to grow shorter.
FIGURES = "app/scene/figure_kinds.cpp"  # columns of series.csv and tables that figures draw
QUOTED = {
    "T_xy": {"app/bed/measures/microrheology.cpp"},  # a value of the measure
    "above": {"app/scene/schema_json.cpp"},  # of ranges in the schema
    "absorbing_state": {"app/bed/measures/order.cpp"},  # of the run's summary, which the measure reads
    "beads_fraction": {"app/bed/granular_run.cpp"},  # an attribute of trajectories
    "bound": {"app/run/glossary.cpp", "src/core/encounter.cpp"},  # the outcome, as orbit
    "certificate": {"app/scan/scan_stage.cpp", "app/scan/scan_values.hpp", "app/theory/rods_stage.cpp"},  # columns of scans; an attribute
    "container": {"app/scene/fields_granular.cpp", "models/granular/problem.cpp", "models/granular/start.cpp"},  # the scene's table, in messages too
    "cpu_seconds": {"app/scan/scan_results.cpp"},  # of the scan
    "C11": {FIGURES}, "C22": {FIGURES}, "C66": {FIGURES}, "c_T": {FIGURES}, "diffusion_per_length": {FIGURES}, "drag_rate": {FIGURES},
    "exponent": {FIGURES}, "msd": {FIGURES}, "screening_length": {FIGURES}, "stiffness": {FIGURES},
    "delta_y": {"app/scan/scan_results.cpp", FIGURES},
    "mean_speed": {"app/bed/measures/force.cpp", "app/run/glossary.cpp"},
    "non_reciprocity": {"app/scan/scan_values.cpp", FIGURES},
    "p_xy": {"app/bed/granular_run.hpp"},  # a mean of that column
    "rod_tracks": {"app/cli/verb_new.cpp", "app/scene/figure_kinds.cpp"},  # a kind of figure
    "psi6": {FIGURES},
    "pushed": {"app/bed/measures/mechanics.cpp"},
    "rhs_evaluations": {"app/run/catalogue.cpp"},  # a column of tradeoff.csv, which Python writes
    "omega": {"app/scan/scan_values.cpp"},  # empty columns of scans where there is no orbit
    "orbit": {"app/run/glossary.cpp", "models/rods/pair_equilibria.cpp", "src/core/encounter.cpp"},  # an outcome, a kind of fixed points
    "lambda": {"models/rods/form.cpp"},  # the multiplier of the dae
    "final_separation": {"app/scan/critical_encounters.cpp"},
    "separation": {"app/scan/scan_values.cpp", "app/scan/critical_encounters.cpp"},  # a column of points that brackets read
    "sigma_x": {"app/bed/measured_file.cpp", "app/fit/read_fit_maps.cpp"},
    "sigma_y": {"app/bed/measured_file.cpp", "app/fit/read_fit_maps.cpp"},
    "turn1": {"app/run/record_table.hpp"},  # an example
    "aic": {"app/fit/fit_models.cpp"},  # what weights are from
    "chi2": {"app/bed/measures/force.cpp", "fitting/misfit.cpp", "include/rodwake/fitting/misfit.hpp"},  # of a line; a test
    "dof": {"app/bed/measures/force.cpp"},
    "square": {"app/scene/fields_rods.cpp"},  # where rods start
    "largest": {"fitting/misfit.cpp", "include/rodwake/fitting/misfit.hpp"},  # a test of the residuals
    "log_evidence": {"app/fit/fit_models.cpp", "app/fit/write_posterior.cpp"},  # of posterior.json
    "log_evidence_stderr": {"app/fit/fit_models.cpp"},
    "misfit": {"app/fit/fit_models.cpp"}, "sigma_known": {"app/fit/fit_models.cpp"},  # of models.json, as of fit.json
    "wall_seconds": {"app/scan/scan_results.cpp", "src/store/provenance.cpp"},  # of the scan; of the command
}


def errors_of(header, source, *descriptions):
    """What the compiler says of each description; all are compiled at once, since reading the header takes longest."""
    text = f'#include "{header}"\n' + "".join(source.format(name=f"case{k}", text=one) for k, one in enumerate(descriptions))
    done = subprocess.run([COMPILER, "-std=c++20", "-fsyntax-only", "-I", rodwake.SOURCE / "include", "-I", rodwake.SOURCE / "app",
                           "-isystem", "/usr/include/eigen3", "-x", "c++", "-"], input=text, capture_output=True, text=True)
    said = [""] * len(descriptions)
    for part in re.split(r"(?m)^(?=case\d+:)", done.stderr)[1:]:  # what follows a line of a case is said of it
        places = re.findall(r"(?m)^(/\S+):(\d+):\d+: error: ", part)  # whose line is shown for the first case only
        said[int(re.match(r"case(\d+)", part)[1])] += part + "".join(Path(file).read_text().splitlines()[int(line) - 1] for file, line in places)
    return said


def quoted_elsewhere(files, common):
    """{name: files} of described names, but for those in `common`, quoted outside the files that describe them."""
    homes = {}
    for path, text in files.items():
        for name in DESCRIBED.findall(text):
            homes.setdefault(name, set()).add(path)
    found = {}
    for name in set(homes) - common:
        others = {path for path, text in files.items() if path not in homes[name] and f'"{name}"' in text}
        if others:
            found[name] = others
    return found


class DescribedResultsTest(unittest.TestCase):
    def assert_refused(self, said, *reasons):
        """The first description is good, the others are wrong for these reasons."""
        self.assertEqual(said[0], "")
        for text, why in zip(said[1:], reasons, strict=True):
            self.assertIn("error: ", text)
            self.assertIn(why, text)

    def test_a_wrong_description_does_not_compile(self):
        said = errors_of("rodwake/core/record.hpp", SOURCE, '"speed", &R::speed, {"m/s", "of the rod"}', '"speed", &R::speed, {"m/ss", "of the rod"}',
                         '"speed", &R::speed, {"", "of the rod"}', '"speed", &R::speed, {"m/s", ""}', '"", &R::speed, {"m/s", "of the rod"}')
        self.assert_refused(said, "unit", "unit", "meaning", "name")

    def test_a_member_without_its_line_does_not_compile(self):
        said = errors_of("rodwake/core/record.hpp", COUNTED, "", ", force")
        self.assert_refused(said, "every member has its line")

    def test_a_value_of_a_measure_without_meaning_or_unit_does_not_compile(self):
        speed, force = "[](const R& r) { return r.speed; }", "[](const R&) { return rodwake::Estimate{}; }"
        said = errors_of("rodwake/core/record.hpp", SOURCE, '"force", {"Force", "\\u00b5N"}, {"N", "of the rod"}, ' + force, '"speed", {"Speed"}, {"a/s", ""}, ' + speed,
                         '"speed", {"a/ss", "of the rod"}, ' + speed, '"force", {"", "of the rod"}, ' + force, '"force", {"Force", "m/s"}, {"N", "of the rod"}, ' + force,
                         '"list", {"", "of the rod"}, [](const R&) { return std::vector{1.0}; }')
        self.assert_refused(said, "meaning", "unit", "unit", "prefix", "unit")

    def test_a_struct_of_a_checkpoint_with_a_part_left_out_does_not_compile(self):
        said = errors_of("rodwake/store/archive.hpp", KEPT, '"x y", &{0}::x, &{0}::y'.format("case0::R"), '"x", &case1::R::x', '"x", &case2::R::x, &case2::R::y')
        self.assert_refused(said, "not among its parts", "each part has a name")

    def test_names_are_quoted_where_they_are_described(self):
        """Left out are names that are a scene key too, that several kinds of files have, or of one or two letters."""
        files = {str(p): text_of(p) for p in tracked() if p.suffix in (".hpp", ".cpp") and p.parts[0] in ("app", "include", "models", "src", "fitting")}
        schema = json.loads((rodwake.SOURCE / "plots/rodwake_plots/schema.json").read_text())
        common = {key["key"] for key in schema["keys"]} | {name for text in files.values() for name in DESCRIBED.findall(text) if len(name) < 3}
        common |= {parameter["name"] for parameter in schema["fit_parameters"]} | GENERAL
        self.maxDiff = None
        self.assertEqual(quoted_elsewhere(files, common), QUOTED)

    def test_a_name_quoted_elsewhere_is_seen(self):
        files = {"a.hpp": 'field("psi6", &R::psi6, {})', "b.cpp": 'x.at("psi6")', "c.cpp": '"psi60"'}
        self.assertEqual(quoted_elsewhere(files, set()), {"psi6": {"b.cpp"}})
        self.assertEqual(quoted_elsewhere(files, {"psi6"}), {})


if __name__ == "__main__":
    rodwake.main()
