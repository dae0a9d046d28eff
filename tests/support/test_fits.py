"""The helpers of the tests of rodwake fit must be able to fail."""

import rodwake
from fits import FIT, TRUE, X, FitTest, compare_fits, wake


class FitsTest(FitTest):
    def test_other_parameters_are_not_recovered(self):
        self.make_profile()
        found, _ = self.fit(FIT)
        self.assert_recovered(found, TRUE)
        for name in TRUE:
            with self.assertRaises(self.failureException, msg=name):
                self.assert_recovered(found, {name: 20.0 * TRUE[name]})

    def test_compare_fits_sees_any_change(self):
        compare_fits(self, {"a": [1.0]}, {"a": [1.0]})
        for other in ({"a": [1.0 + 1e-15]}, {"a": [1.0], "b": 2}, {}):
            with self.assertRaises(self.failureException):
                compare_fits(self, {"a": [1.0]}, other)

    def test_every_term_of_the_wake_counts(self):
        def made(**terms):
            return list(wake(self, X, 4.0, "Uy", "x", terms.pop("box", None), **{**TRUE, **terms}))
        plain = made()
        for change in ({"f_over_mu": 3.0}, {"eta": 3.0}, {"xi": 3.0}, {"f2d_over_mu": 1.0}, {"x0": 1.0}, {"offset_y": 1.0}, {"box": 78.0}):
            self.assertNotEqual(made(**change), plain, change)
        self.assertEqual(made(offset=1.0), plain)  # of Ux


if __name__ == "__main__":
    rodwake.main()
