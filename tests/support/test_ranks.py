"""The helper of the tests of MPI jobs must be able to fail."""

import rodwake
from ranks import RanksTest


class RanksTestTest(RanksTest):
    def test_ranks_want_the_exit_code(self):
        self.ranks(2, "scan", "none.toml", code=2)
        with self.assertRaises(self.failureException):
            self.ranks(2, "scan", "none.toml")


if __name__ == "__main__":
    rodwake.main()
