"""Mistakes on the command line: the message names the offending word and only it, and says what to do."""

import shlex

import rodwake
from rodwake import PAIR, ProgramTest

# A command, and below it the whole of what is printed after "rodwake: ". my.toml is a pair of rods, points.csv has no point.
MISTAKES = r"""
rodwake rnu my.toml
    rnu: no such command (did you mean "run"?)
rodwake Run my.toml
    Run: no such command (did you mean "run"?)
rodwake my.toml
    my.toml: a command comes first, for example rodwake run my.toml
rodwake frobnicate
    frobnicate: no such command; there are scenes, new, check, field, rods, dem, measure, fit, scan, tradeoff, design, run, impact, camera, convert, replay, explore, plot, info, help
rodwake -j 2 run my.toml
    -j: comes after the command: rodwake run -j
rodwake --quiet
    --quiet: comes after a command, for example rodwake scenes --quiet
rodwake help rnu
    rnu: no such command (did you mean "run"?)
rodwake help -j
    -j: rodwake help has no such option
rodwake run
    SCENE is required; see rodwake run --help
rodwake run nope.toml
    nope.toml: no such file
rodwake run elsewhere/pair.toml
    elsewhere/pair.toml: no such file; rodwake scenes -o . copies the shipped scenes into this folder, rodwake scenes pair prints this one
rodwake run .
    .: is a directory, not a scene file
rodwake run my.toml other.toml
    other.toml: not expected; rodwake run takes one SCENE
rodwake run my.toml --ouput out
    --ouput: rodwake run has no such option (did you mean "--output"?)
rodwake run --ouput out my.toml
    --ouput: rodwake run has no such option (did you mean "--output"?)
rodwake run my.toml --ouput=out
    --ouput: rodwake run has no such option (did you mean "--output"?)
rodwake run --hlep
    --hlep: rodwake run has no such option (did you mean "--help"?)
rodwake run my.toml -output out
    -output: a long option has two dashes: --output
rodwake run my.toml -q
    -q: rodwake run has no such option
rodwake run my.toml --quiet -v
    --quiet and --verbose: give one of them
rodwake rods my.toml -o
    --output: its value is missing; see rodwake rods --help
rodwake rods my.toml -j two
    --threads: two is not a whole number from 1 to 1024
rodwake rods my.toml -j 0
    --threads: 0 is not a whole number from 1 to 1024
rodwake rods my.toml -j 1.5
    --threads: 1.5 is not a whole number from 1 to 1024
rodwake rods my.toml --seed -1
    --seed: -1 is not a whole number from 0 to 9223372036854775807
rodwake rods my.toml --seed 1e400
    --seed: 1e400 is not a whole number from 0 to 9223372036854775807
rodwake rods my.toml -s
    --set: its value is missing, table.key=value; see rodwake rods --help
rodwake rods my.toml -s nonsense
    -s nonsense: expected table.key=value, for example coupling.kappa=0.5
rodwake rods my.toml -s coupling.kapa=1
    -s coupling.kapa=1: [coupling] unknown key "kapa" (did you mean "kappa"?). Known keys: kappa, gamma1, gamma2, polar_basis, gamma_flow, gamma_rows, rows_direction
rodwake rods my.toml -s kappa=1
    -s kappa=1: unknown table or key "kappa" ([coupling] has it). Known keys: schema, units, title, scales, medium, coupling, noise, body, rods_random, rods, rods_run, field, granular, tracks, rods_order, measure, fit, figures, variants, scan
rodwake rods my.toml -s coupling.kappa=1e400
    -s coupling.kappa=1e400: 1e400 is too large for a number, which ends at 1.8e308
rodwake rods my.toml -s coupling.kappa = 1e400
    -s coupling.kappa=1e400: 1e400 is too large for a number, which ends at 1.8e308
rodwake rods my.toml -s coupling.kappa= 2
    2: not expected; rodwake rods takes one SCENE
rodwake rods my.toml -s coupling.kappa=two
    -s coupling.kappa=two: coupling.kappa: expected a rate, found "two" (string): a string must be a finite number and a unit: 1/s, 1/ms, 1/min, Hz, kHz, mu v0/f
rodwake rods my.toml -s coupling.kapa=
    -s coupling.kapa=: nothing to unset: coupling has no kapa (did you mean "kappa"?)
rodwake rods my.toml -s rods.2.heading=1
    -s rods.2.heading=1: no entry 2: rods has 2 (numbered from 0)
rodwake rods my.toml -s rods.heading=1
    -s rods.heading=1: rods is a list: give an index from 0 after it, not "heading"
rodwake rods my.toml -s rods_run.method=adms
    -s rods_run.method=adms: rods_run.method = "adms": must be one of auto, bdf, adams, erk (did you mean "adams"?)
rodwake rods my.toml -s rods_run.t_end=60 parsec
    parsec: not expected; rodwake rods takes one SCENE
rodwake rods my.toml -s medium.eta=-2
    -s medium.eta=-2: medium.eta = -2: must be > -1 and <= 1e+12: the longitudinal modulus 1 + eta must be positive
rodwake check my.toml -j 2
    -j: rodwake check has no such option
rodwake field
    field: give either a SCENE or --points FILE
rodwake field my.toml --points points.csv
    field: give either a SCENE or --points FILE
rodwake field --points points.csv --backend fast
    --backend: fast is none of exact, table
rodwake field --points points.csv --table-tolerance 2
    --table-tolerance: 2 is not from 1e-12 to 0.1
rodwake field --points nope.csv
    nope.csv: cannot read the file (does it exist?)
rodwake scan my.toml
    my.toml: no [scan] table, so there is nothing to scan
rodwake scan my.toml --part 3
    --part: expected i/n with 1 <= i <= n, found 3
rodwake scan my.toml --part 5/4
    --part: expected i/n with 1 <= i <= n, found 5/4
rodwake scan my.toml --part 1/2 --merge
    --part and --merge: give one of them
rodwake tradeoff my.toml --for much
    --for: much is not a number
rodwake tradeoff my.toml --for 1e400
    --for: 1e400 is too large for a number, which ends at 1.8e308
rodwake tradeoff my.toml --within soon
    --within: soon is not a time such as 5ms, 2s or 1min
rodwake tradeoff my.toml --error pth
    --error: pth is none of final_state, contact_time, outcome, path (did you mean "path"?)
rodwake tradeoff my.toml --for 1e-6 --within 1ms
    --for and --within: give one of them
rodwake impact
    --cases is required; see rodwake impact --help
rodwake plot
    RESULT is required; see rodwake plot --help
rodwake plot nope
    nope: not a run directory; rodwake run SCENE makes one
rodwake info nope
    nope: no such file or folder
rodwake info --shema
    --shema: rodwake info has no such option (did you mean "--schema"?)
rodwake scenes pari
    pari: no such scene is shipped (did you mean "pair"?); rodwake scenes lists them
rodwake scenes pair -o .
    NAME and --output: give one of them
rodwake new --kind bd
    --kind: bd is none of rods, bed, scan, critical (did you mean "bed"?)
rodwake new --rods 21
    --rods: 21 is not a whole number from 1 to 20
rodwake new --kind bed --kappa 1
    --kappa: a scene of kind bed has no use for it
rodwake new my.toml
    my.toml: already exists; choose another name, or --force to replace it
"""


class MistakesTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("my.toml", PAIR)
        self.write("points.csv", "x,y,xi,eta\n")

    def test_every_mistake_has_its_message(self):
        commands, messages = MISTAKES.strip().split("\n")[::2], MISTAKES.strip().split("\n")[1::2]
        self.assertGreaterEqual(len(messages), 40)
        for command, message in zip(commands, messages, strict=True):
            with self.subTest(command):
                done = self.refuse(2, ".", *shlex.split(command)[1:])
                self.assertEqual(done.stderr, f"rodwake: {message.strip()}\n")


class RightTest(ProgramTest):
    """What looks like a mistake and is none."""

    def setUp(self):
        super().setUp()
        self.write("my.toml", PAIR)

    def resolved(self, *words):
        return self.expect(0, "check", "my.toml", *words).stdout

    def test_spaces_around_the_sign(self):
        for words in (["-s", "coupling.kappa", "=", "2"], ["--set", "coupling.kappa", "=2"], ["-s", "coupling.kappa = 2"],
                      ["-s", "coupling.kappa=2"]):
            self.assertIn("kappa = 2.0", self.resolved(*words), words)

    def test_a_key_is_unset(self):
        self.assertIn("# contact_distance: no stop", self.resolved("-s", "rods_run.contact_distance="))

    def test_a_heading_beyond_a_turn_is_pointed_out(self):
        self.assertIn('rods[0].heading = 90 rad is 14.3 turns; a plain number is in rad, degrees are written as "90 deg"',
                      self.resolved("-s", "rods.0.heading=90"))
        self.assertNotIn("what you mean", self.resolved("-s", "rods.0.heading=90 deg"))
        self.assertIn("rods[0].heading = 90 rad is 14.3 turns", self.expect(0, "rods", "my.toml", "-s", "rods.0.heading=90").stderr)


if __name__ == "__main__":
    rodwake.main()
