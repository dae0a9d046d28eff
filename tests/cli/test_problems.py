"""Every problem of fitting/problems is legal, is fitted, and has the figures it names; what they find is as written in docs/fit.md."""

import json
import tomllib

import rodwake
from rodwake import SOURCE, ProgramTest

PROBLEMS = sorted((SOURCE / "fitting/problems").glob("*.toml"))


class ProblemsTest(ProgramTest):
    def fit(self, problem):
        self.expect(0, "fit", problem, "-o", problem.stem, "--quiet")
        return json.loads((self.folder / problem.stem / "fit.json").read_text())

    def test_all(self):
        self.assertEqual([path.stem for path in PROBLEMS], ["dipole", "joint", "monopole", "pair"])
        for problem in PROBLEMS:
            with self.subTest(problem.stem):
                self.expect(0, "check", problem)
                self.assertIn(self.fit(problem)["termination"], ("converged", "roundoff"))
                self.expect(0, "plot", problem.stem, "--quiet")
                named = {figure["name"] + ".png" for figure in tomllib.loads(problem.read_text())["figures"]}
                self.assertEqual({path.name for path in (self.folder / problem.stem / "figures").iterdir()}, named)

    def test_the_monopole_is_that_of_the_documentation(self):
        found = self.fit(SOURCE / "fitting/problems/monopole.toml")
        text = (SOURCE / "docs/fit.md").read_text()
        f, eta, xi = (found["parameters"][name] for name in ("f_over_mu", "eta", "xi"))
        row = f"| {f['value']:.2f} ± {f['stderr']:.2f} | {eta['value']:.1f} ± {eta['stderr']:.1f} | {xi['value']:.0f} ± {xi['stderr']:.0f} |"
        self.assertIn(row, text)


if __name__ == "__main__":
    rodwake.main()
