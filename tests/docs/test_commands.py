"""Every command block of README and docs, in order, each page in a folder of its own that is empty but for the shipped scenes."""

import re
import time

import rodwake
from doc_commands import blocks_of, run
from rodwake import SOURCE, ProgramTest

TUTORIAL = SOURCE / "docs/tutorial.md"
PAGES = [SOURCE / "README.md", *sorted((SOURCE / "docs").glob("*.md"))]


class CommandsTest(ProgramTest):
    def page(self, path):
        if path.name != "README.md":  # which copies them itself, and so tells how
            self.expect(0, "scenes", "-o", ".")
        blocks = blocks_of(path.relative_to(SOURCE), path.read_text(encoding="utf-8"))
        self.output = ""
        for block in blocks:
            if block.reason:
                continue
            began = time.monotonic()
            done = run(block, self.folder)
            print(f"{block.place}: {time.monotonic() - began:.1f} s")
            self.assertEqual(done.returncode, 0, f"{block.place}\n{block.text}\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}")
            self.output += done.stdout + done.stderr
        return blocks

    def test_readme(self):
        commands = [line for block in self.page(PAGES[0]) if not block.reason for line in block.text.splitlines() if line.startswith("rodwake ")]
        self.assertGreaterEqual(len(commands), 6)

    def test_tutorial(self):
        """It promises what its reader will see."""
        self.page(TUTORIAL)
        text = " ".join(TUTORIAL.read_text(encoding="utf-8").split())
        promised = re.findall(r"(?:`(rods: [^`]*)`|`(\d+ missed[^`]*)`|(\d+ of \d+ points))", text)
        self.assertEqual(len(promised), 3)
        for words in promised:
            self.assertIn("".join(words), self.output)
        self.assertIn("at t = 40.6", text)
        for ending in ("at t = 40.59", "undecided", "escape", "pursuit"):  # of sections 3 and 5
            self.assertIn(ending, self.output)

    def test_docs(self):
        blocks = []
        for path in PAGES[1:]:
            if path == TUTORIAL:
                continue
            with self.subTest(path.name):
                self.setUp()  # a fresh folder
                blocks += self.page(path)
        self.assertGreater(len([block for block in blocks if not block.reason]), 6)


if __name__ == "__main__":
    rodwake.main()
