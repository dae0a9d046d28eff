"""The runner of the docs' commands must see what fails."""

import rodwake
from doc_commands import Block, blocks_of, extra_arguments, run
from rodwake import ProgramTest


class BlocksTest(ProgramTest):
    def test_blocks_are_found_with_their_comments(self):
        page = ('text\n\n```sh\nrodwake info\n```\n<!-- not run: needs SLURM -->\n```sh\nsbatch x\n```\n```toml\na = 1\n```\n'
                '<!-- run with "b" for "a", "" for "c": short -->\n```sh\nrodwake a c\n```\n')
        blocks = blocks_of("x.md", page)
        self.assertEqual([(block.place, block.text, block.reason) for block in blocks],
                         [("x.md:3", "rodwake info\n", ""), ("x.md:7", "sbatch x\n", "needs SLURM"), ("x.md:14", "rodwake a c\n", "")])
        self.assertEqual(blocks[2].script(), "rodwbke b \n")

    def test_commands_that_no_test_would_run_are_refused(self):
        for page in ("    rodwake info\n", "```\nrodwake info\n```\n", "```console\n$ rodwake info\n```\n", "    tools/test x\n"):
            with self.assertRaisesRegex(ValueError, "x.md:[12]: a command outside"):
                blocks_of("x.md", page)

    def test_comments_without_a_reason_are_refused(self):
        for comment in ("<!-- not run: -->", "<!-- not run -->", '<!-- run with "a" for "b" -->', "<!-- skip: x -->"):
            with self.assertRaisesRegex(ValueError, "x.md:2: the comment"):
                blocks_of("x.md", f"{comment}\n```sh\nrodwake info\n```\n")

    def test_a_block_fails_with_any_of_its_commands(self):
        self.assertEqual(run(Block("x", "rodwake info > info.txt\nrodwake -V\n"), self.folder).stdout.split()[0], "rodwake")
        self.assertTrue((self.folder / "info.txt").is_file())
        for text in ("rodwake rnu\n", "rodwake rnu\nrodwake info\n", "rodwake info\nrodwake plot nope\n", "rodwake rnu | cat\n",
                     "no-such-command\n", 'rodwake info "$UNSET"\n', "rodwake info nope |\n head -1\n"):
            self.assertNotEqual(run(Block("x", text), self.folder).returncode, 0, text)

    def test_what_is_replaced_must_be_there(self):
        with self.assertRaisesRegex(AssertionError, "the block has no '312 a'"):
            Block("x", "rodwake info\n", changes=[("312 a", "40 a")]).script()

    def test_scenes_are_shortened(self):
        self.assertIn("scan.resolution=16", extra_arguments(["scan", "scenes/phase_alpha.toml", "-j", "2"]))
        self.assertEqual(extra_arguments(["dem", "scenes/pair_crystal.toml"]), ["--dry-run"])
        self.assertEqual(extra_arguments(["run", "scenes/pair.toml"]), ["--no-figures"])
        self.assertEqual(extra_arguments(["run", "scenes/pair.toml", "-s", "figures.0.name=a"]), [])
        self.assertEqual(extra_arguments(["check", "scenes/phase_alpha.toml"]), [])
        self.assertEqual(extra_arguments(["rods", "mine.toml", "-s", "a.b=scenes/wake.toml"]), [])


if __name__ == "__main__":
    rodwake.main()
