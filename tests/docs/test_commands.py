"""Every command block of README and docs, in order, each page in a folder of its own that is empty but for the shipped scenes."""

import time

import rodwake
from doc_commands import blocks_of, run
from rodwake import SOURCE, ProgramTest

PAGES = [SOURCE / "README.md", *sorted((SOURCE / "docs").glob("*.md"))]


class CommandsTest(ProgramTest):
    def page(self, path):
        if path.name != "README.md":  # which copies them itself, and so tells how
            self.expect(0, "scenes", "-o", ".")
        blocks = blocks_of(path.relative_to(SOURCE), path.read_text(encoding="utf-8"))
        for block in blocks:
            if block.reason:
                continue
            began = time.monotonic()
            done = run(block, self.folder)
            print(f"{block.place}: {time.monotonic() - began:.1f} s")
            self.assertEqual(done.returncode, 0, f"{block.place}\n{block.text}\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}")
        return blocks

    def test_readme(self):
        self.assertGreaterEqual(len([block for block in self.page(PAGES[0]) if not block.reason]), 3)

    def test_docs(self):
        blocks = []
        for path in PAGES[1:]:
            with self.subTest(path.name):
                self.setUp()  # a fresh folder
                blocks += self.page(path)
        self.assertGreater(len([block for block in blocks if not block.reason]), 6)


if __name__ == "__main__":
    rodwake.main()
