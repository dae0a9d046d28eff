"""Damaged films are read or refused in a line that names the file, and nothing else; studies/validate_convert.py tries thousands."""

import random

from films import *  # noqa: F403 (helpers of these tests)


class Damage(ConvertTest):
    def test_damaged_films(self):
        for name, good in small_films(self.folder).items():
            chance, read, true = random.Random(7), 0, self.film(name, good).seen()
            for k in range(80):
                outcome = self.run_on(name, damaged(good, chance))
                with self.subTest(name, k=k):
                    self.assertIn(outcome.code, (0, 2), outcome)
                    self.assertTrue(outcome.code == 0 or outcome.message.startswith(name), outcome)
                    self.assertNotRegex(outcome.message, "\n|internal")
                    if outcome.code == 0:
                        read += 1
                        seen = Film(self.folder / "film.h5md").seen()
                        self.assertTrue(not name.startswith("sums") or seen == true)
            self.assertLess(3, read)  # not all damage is refused, which would be easy


if __name__ == "__main__":
    unittest.main()
