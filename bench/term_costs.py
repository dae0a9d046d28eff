#!/usr/bin/python3
"""Instructions of each term of a scene, and that terms which a scene leaves out cost none.

Runs build/release/bench/bench_terms and build/release/rodwake under valgrind --tool=callgrind: the machine's load does not matter.
Prints Markdown; takes two minutes. Exit code 1 if a term that is left out costs more than the limit beside it.
"""

import argparse
import re
import sys
import tempfile
from pathlib import Path

import measure

PAIR, CROWD, BED = "scenes/pair.toml", "scenes/crowd.toml", "scenes/granular_quick.toml"
GAMMA1, GAMMA2, BOX = "coupling.gamma1=0.3", "coupling.gamma2=0.2", "medium.periodic=20"
NO_GAMMA = ("coupling.gamma1=0", "coupling.gamma2=0")
MANY = ("rods_random.count=100", "rods_run.precision=full")
NO_RODS = ("figures=[]", "granular.rods=[]")
# What only these terms call.
FUNCTIONS = {
    "images": r"Periodic",
    "gradients (Jacobian, sensitivities)": r"gradients|turning_rate_derivatives|RodModel::jacobian",
    "sensitivities": r"medium_derivatives|solve_with_sensitivities",
    "polar vectors": r"PolarInLane|strain_and_polar",
    "measures": r"rodwake::measure::",
    "rods of the bed": r"MovingRod|bounce_rod|bead_rod|rod_rod",
}
# The functions whose instructions are counted, with all they call.
COUNTED = {
    "rhs": "rodwake::rods::RodModel::rhs(*",
    "plain_rhs": "*PlainRods::plain_rhs(*",
    "jacobian": "rodwake::rods::RodModel::jacobian(*",
    "run": "rodwake::rods::simulate(rodwake::rods::RodProblem const&, rodwake::rods::RodOptions const&)",
    "bed": "rodwake::granular::Simulation::advance(long)",
    "plain_bed": "*PlainBed::plain_step()",
    "dem": "rodwake::app::run_granular(*",
}


class Counter:
    """Instructions of programs, by callgrind."""

    def __init__(self, folder, build):
        self.folder, self.build = folder, build

    def total(self, command, counted=None):
        """Instructions of a command, all or those within a function, and the names of the functions that ran there."""
        out = self.folder / "callgrind.out"
        only = [f"--toggle-collect={counted}"] if counted else []
        measure.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", *only, *map(str, command)], cwd=measure.SOURCE)
        text = out.read_text(errors="replace")
        return int(re.search(r"^(?:summary|totals): (\d+)", text, re.MULTILINE)[1]), set(
            re.findall(r"^c?fn=\(\d+\) (.+)$", text, re.MULTILINE))

    def each(self, what, scene, settings=(), count=100, first=0):
        """Instructions of one piece of work, without the `first` ones, and the functions."""
        def inside(pieces):
            return self.total([self.build / "bench/bench_terms", what, pieces, scene, *settings], COUNTED[what])

        before = inside(first)[0] if first else 0
        instructions, functions = inside(first + count)
        if instructions == 0:
            raise measure.Problem(f"{COUNTED[what]}: no such function ran; was it inlined or renamed?")
        return (instructions - before) / count, functions

    def program_step(self, settings, steps=(500, 3000), dt=1e-4):
        """Instructions of a step of `rodwake dem`, with all that it does between steps but files of frames: the difference of two
        runs, in which start and end cancel."""
        runs = []
        for count in steps:
            quiet = ("granular.equilibrate=0", f"granular.duration={count * dt!r}", "granular.output.formats=[]",
                     "granular.output.last_period=false", "granular.output.table=1.0", *settings)
            runs.append(self.total([self.build / "rodwake", "dem", BED, "--quiet", "--force", "-j", "1", "-o", self.folder / "run",
                                    *(f"-s{one}" for one in quiet)], COUNTED["dem"]))
        return (runs[1][0] - runs[0][0]) / (steps[1] - steps[0]), runs[1][1]


class Report:
    """Rows of the table, and what was too dear."""

    def __init__(self, counter):
        self.counter, self.failed = counter, False

    def table(self, title):
        print(f"\n{title}\n")
        measure.print_table(("case", "instructions", "compared with", "difference", "allowed"), [])

    def row(self, case, count, against=None, other=None, allowed=None):
        difference = "" if other is None else f"{count - other:+.0f} ({100 * (count / other - 1):+.2f} %)"
        bad = allowed is not None and count / other - 1 > allowed
        self.failed = self.failed or bad
        limit = "" if allowed is None else f"{100 * allowed:g} %" + (" EXCEEDED" if bad else "")
        print("| " + " | ".join((case, f"{count:.0f}", against or "", difference, limit)) + " |", flush=True)

    def absent(self, case, functions, terms):
        """None of the functions of these terms ran."""
        for term in terms:
            ran = sorted(name for name in functions if re.search(FUNCTIONS[term], name))
            self.failed = self.failed or bool(ran)
            print(f"* {case}: {term}: " + (f"RAN: {', '.join(ran[:3])}" if ran else "no function of theirs ran"), flush=True)


def rods(report, scene, common, name, count, allowed):
    """Terms of a right-hand side: what is left out against 0 written in the scene, and against code without the term."""
    def each(what, *settings):
        return report.counter.each(what, scene, (*common, *settings), count)

    report.table(f"A right-hand side of {name}")
    kappa, ran = each("rhs")
    plain = each("plain_rhs")[0]
    zero = each("rhs", *NO_GAMMA)[0]
    report.row("kappa alone", kappa, "code that knows the strain alone", plain, allowed)
    report.row("gamma1 = gamma2 = 0 in the scene", zero, "keys left out", kappa, 1e-4)
    polar = each("rhs", GAMMA1, GAMMA2)[0]
    report.row("+ gamma1", each("rhs", GAMMA1)[0], "kappa alone", kappa)
    report.row("+ gamma2", each("rhs", GAMMA2)[0], "kappa alone", kappa)
    report.row("+ gamma1, gamma2", polar, "kappa alone", kappa)
    report.row("+ gamma1, gamma2", polar, "code for strain and polar vectors", each("plain_rhs", GAMMA1, GAMMA2)[0], allowed)
    return kappa, ran


def pair(report):
    kappa, ran = rods(report, PAIR, (), "a pair (scenes/pair.toml)", 2000, 0.70)
    counter = report.counter
    box = counter.each("rhs", PAIR, (BOX,), 20, 1)[0]
    report.row("+ medium.periodic", box, "kappa alone", kappa)
    report.row("+ medium.periodic, gamma1, gamma2", counter.each("rhs", PAIR, (BOX, GAMMA1, GAMMA2), 20, 1)[0], "kappa alone in the box", box)
    report.row("Jacobian, kappa alone", counter.each("jacobian", PAIR)[0])
    report.row("Jacobian, + gamma1, gamma2", counter.each("jacobian", PAIR, (GAMMA1, GAMMA2))[0])
    run, whole = counter.each("run", PAIR, (), 5)
    free = counter.each("run", PAIR, ("rods_run.contact_distance=1e-9",), 5)[0]
    report.row("a whole run to contact", run)
    report.row("the same with contact_distance = 1e-9", free)
    print()
    report.absent("the right-hand side", ran, ["images", "gradients (Jacobian, sensitivities)", "sensitivities", "polar vectors"])
    report.absent("the whole run", whole, ["images", "sensitivities", "polar vectors"])


def bed(report):
    counter, count = report.counter, 1200
    report.table("A step of a bed (scenes/granular_quick.toml, 215 beads)")
    beads, ran = counter.each("bed", BED, NO_RODS, count)
    report.row("beads alone", beads, "code that knows beads alone", counter.each("plain_bed", BED, NO_RODS, count)[0], 0.03)
    report.row("+ a rod", counter.each("bed", BED, (), count)[0], "beads alone", beads)
    program, program_ran = counter.program_step(NO_RODS)
    steps = counter.each("bed", BED, (*NO_RODS, "granular.equilibrate=0"), 2500, 500)[0]  # those of program_step
    report.row("`rodwake dem`, beads alone", program, "the steps by themselves", steps)
    order = counter.program_step((*NO_RODS, "measure.order=true", "measure.interval=1e-3", "measure.order_interval=1e-3"))[0]
    report.row("`rodwake dem`, order measured every 50 steps", order, "not measured", program)
    print()
    report.absent("beads alone", ran, ["rods of the bed"])
    report.absent("`rodwake dem`, beads alone", program_ran, ["rods of the bed", "measures"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=measure.SOURCE / "build/release", help="build folder [build/release]")
    parser.add_argument("--only", choices=("pair", "crowd", "bed"), help="one part")
    options = parser.parse_args()
    measure.need_command("valgrind", "valgrind")
    with tempfile.TemporaryDirectory() as folder:
        report = Report(Counter(Path(folder), options.build.resolve()))
        if options.only in (None, "pair"):
            pair(report)
        if options.only in (None, "crowd"):
            rods(report, CROWD, MANY, "100 rods (scenes/crowd.toml)", 10, 0.04)
        if options.only in (None, "bed"):
            bed(report)
    sys.exit(1 if report.failed else 0)


if __name__ == "__main__":
    measure.main(main)
