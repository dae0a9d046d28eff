"""The helpers of the tests of ranks must be able to fail."""

import rodwake
from ranks import ScanRanksTest, rank_of


class RanksTest(ScanRanksTest):
    def test_a_rank_that_is_not_there_cannot_die(self):
        self.assertFalse(self.kill_rank(7, "run", 0.1))
        self.assertIsNone(rank_of(1))

    def test_another_end_is_seen(self):
        self.scan("scan.toml", "whole", "--quiet", "-s", "scan.boundary_tolerance=1e-2")
        with self.assertRaises(self.failureException):
            self.finish_after_deaths(1, 1)

    def test_ranks_want_the_exit_code(self):
        self.ranks(2, "scan", "none.toml", code=2)
        with self.assertRaises(self.failureException):
            self.ranks(2, "scan", "none.toml")


if __name__ == "__main__":
    rodwake.main()
