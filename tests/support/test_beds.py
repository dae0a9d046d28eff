"""The helpers of the tests of granular runs must be able to fail."""

import signal

import h5py
import rodwake
from beds import BedTest, InterruptionTest, columns, content, flip_byte, numbers_of, setting


class BedsTest(BedTest):
    def test_settings(self):
        self.assertEqual(setting(output__frames=1, runs=2), ["-s", "granular.output.frames=1", "-s", "granular.runs=2"])

    def test_content_sees_a_bit_and_a_name(self):
        for name, values in (("a", [1.0]), ("a", [1.0 + 2.0**-52]), ("b", [1.0]), ("a", [1.0, 1.0])):
            with h5py.File(self.folder / f"{name}{len(values)}{values[0]}.h5", "w") as file:
                file[name] = values
        files = list(self.folder.glob("*.h5"))
        self.assertEqual(len({str(content(file)) for file in files}), len(files))

    def test_numbers_that_are_none_are_seen(self):
        good = self.write("run/a.csv", "x,y\n1,2\n")
        self.assertEqual(list(numbers_of(good)), [1.0, 2.0])
        self.assert_finite("run")
        for name, text in (("b.csv", "x\nnan\n"), ("b.csv", "x\n-inf\n"), ("b.json", '{"x": NaN}'), ("b.json", '{"x": -Infinity}')):
            path = self.write(f"run/{name}", text)
            with self.assertRaises(self.failureException):
                self.assert_finite("run")
            path.unlink()
        with h5py.File(self.folder / "run/c.h5md", "w") as file:
            file["x"] = [0.0, float("nan")]
        with self.assertRaises(self.failureException):
            self.assert_finite("run")

    def test_a_flipped_byte_is_another(self):
        path = self.write("a", "some text")
        flip_byte(path)
        self.assertEqual(sum(x != y for x, y in zip(path.read_text(), "some text")), 1)

    def test_columns(self):
        self.assertEqual(columns(self.write("a.csv", "x,y\n1,2\n3,4\n")), {"x": [1.0, 3.0], "y": [2.0, 4.0]})

    def test_steps_gone_on_from(self):
        self.write("run/log.txt", "a: run 0: resuming from step 250\nb\nc: run 0: resuming from step 700\n")
        self.assertEqual(self.steps_gone_on_from("run"), [250, 700])

    def test_waiting_for_a_run_that_ends(self):
        with self.started("info") as process:
            with self.assertRaises(self.failureException):
                self.wait_for(process, "never")

    def test_dem_wants_the_exit_code(self):
        with self.assertRaises(self.failureException):
            self.dem("out", *setting(phi_bb=1))

    def test_an_interruption_says_whether_it_came_in_time(self):
        endless = ("dem", "bed.toml", "-o", "out", *setting(duration=1000.0))
        for number in (signal.SIGKILL, signal.SIGTERM):
            self.assertTrue(self.interrupt(number, 0.3, *endless))
        self.assertFalse(self.interrupt(signal.SIGKILL, 5.0, "info"))
        with self.assertRaises(self.failureException):  # an error is no end
            self.interrupt(signal.SIGKILL, 5.0, "dem", "nowhere.toml")


class InterruptionsTest(InterruptionTest):
    def test_another_end_is_seen(self):
        self.dem("run", *self.SETTINGS, "--seed", "5")
        with self.assertRaises(self.failureException):
            self.finish_after("run", 0, (), 0.0)


if __name__ == "__main__":
    rodwake.main()
