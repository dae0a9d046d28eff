"""The helper that uses pages must be able to fail."""

import tempfile
import unittest
from pathlib import Path

from chromium import Browser
from page_driver import Page

TEXT = """<!doctype html><title>t</title><body><main>
<button id="one">one</button> <button id="off" disabled>off</button> <div style="position: relative"><button id="under">under</button>
<div style="position: absolute; inset: 0; background: #fff"></div></div>
<select id="choice"><option value="a">a</option><option value="b">b</option></select><p id="said"></p></main>
<script>
const say = text => { document.getElementById("said").textContent += text + " "; };
document.getElementById("one").addEventListener("click", () => say("clicked"));
document.getElementById("choice").addEventListener("change", event => say(event.target.value));
addEventListener("keydown", event => say(event.key + (event.shiftKey ? " shift" : "")));
addEventListener("wheel", event => say("wheel" + Math.sign(event.deltaY)));
function give() {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob(["given"]));
  link.download = "a.txt";
  link.click();
}
</script></body>"""


class PageDriverTest(unittest.TestCase):
    def page(self, text=TEXT, **how):
        keeper = self.enterContext(tempfile.TemporaryDirectory())
        path = Path(keeper) / "page.html"
        path.write_text(text)
        return self.enterContext(Page(path, 600, 500, **how))

    def test_what_a_reader_does(self):
        page = self.page()
        page.press("#one")
        page.key("ArrowLeft")
        page.key("a", shift=True)
        page.wheel(100, 100, 50)
        page.choose("#choice", "b")
        page.wait_for(lambda: "wheel1" in page.text("#said"), "no wheel")
        self.assertEqual(sorted(page.text("#said").split()), sorted("clicked ArrowLeft a shift wheel1 b".split()))
        self.assertEqual(page.text("#nowhere"), None)

    def test_downloads(self):
        page = self.page()
        page.evaluate("give()")
        self.assertEqual(page.downloaded("a.txt"), "given")
        with self.assertRaisesRegex(AssertionError, "b.txt was not downloaded"):
            page.downloaded("b.txt", 0.2)

    def test_what_cannot_be_pressed(self):
        page = self.page()
        for selector, why in (("#off", "disabled"), ("#under", "not to be seen"), ("#nowhere", "no such element")):
            with self.assertRaisesRegex(AssertionError, why):
                page.press(selector)
        with self.assertRaisesRegex(AssertionError, "has no choice c"):
            page.choose("#choice", "c")

    def test_errors_and_requests(self):
        wrong = '<script>setTimeout(() => { throw new Error("late"); })</script><img src="https://example.org/a.png">'
        page = self.page(TEXT.replace("<main>", "<main>" + wrong))
        page.wait_for(lambda: any("late" in text for text in page.errors), "no error was seen")
        page.wait_for(lambda: any("example.org" in url for url in page.requests), "no request was seen")
        with self.assertRaisesRegex(AssertionError, "nothing is not defined"):
            page.evaluate("nothing.at.all")
        with self.assertRaisesRegex(AssertionError, "wasn't found|not found"):
            page.send("Page.noSuchCommand")

    def test_waiting_ends(self):
        page = self.page()
        with self.assertRaisesRegex(AssertionError, "it never came"):
            page.wait_for(lambda: False, "it never came", 0.1)

    def test_a_page_that_does_not_load(self):
        path = Path(self.enterContext(tempfile.TemporaryDirectory())) / "page.html"
        path.write_text("<!doctype html><script>for (;;);</script>")
        with self.assertRaisesRegex(AssertionError, "did not (load|answer)"), Page(path, timeout=3):
            pass

    def test_many_open_files(self):
        """The descriptors of the pipes have two digits then."""
        Browser.shared().close()
        for _ in range(20):
            self.enterContext(open(__file__))
        self.assertEqual(self.page().evaluate("1 + 1"), 2)

    def test_a_browser_that_ends(self):
        page = self.page()
        page.browser.process.kill()
        with self.assertRaisesRegex(AssertionError, "the browser has ended"):
            page.evaluate("1")
        self.assertEqual(self.page().evaluate("1 + 1"), 2)  # in another one

    def test_one_browser_serves_all_pages_and_they_are_strangers(self):
        one, two = self.page(), self.page()
        self.assertIs(one.browser, two.browser)
        for page, message in ((one, "mine"), (two, "yours")):
            page.evaluate(f"console.error({message!r})")
        self.assertEqual((one.errors, two.errors), (["mine"], ["yours"]))

    def test_a_script_before_those_of_the_page_and_another_page(self):
        page = self.page(first="window.early = typeof say")
        self.assertEqual(page.evaluate("early"), "undefined")
        other = page.path.with_name("other.html")
        other.write_text("<!doctype html><title>other</title>")
        page.go(other)
        self.assertEqual(page.evaluate("[document.title, early]"), ["other", "undefined"])

    def test_dark(self):
        page = self.page(dark=True)
        dark = "matchMedia('(prefers-color-scheme: dark)').matches"
        self.assertTrue(page.evaluate(dark))
        page.set_dark(False)
        self.assertFalse(page.evaluate(dark))


if __name__ == "__main__":
    unittest.main()
