"""Completion and the manual page, made from the definition of the command line."""

import json
import re
import subprocess

import rodwake
from rodwake import ProgramTest

ASK_BASH = """source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); compopt() { :; }; _rodwake; printf '%s\\n' "${COMPREPLY[@]}" """
# A zsh at a terminal of its own, to which the words and a tab are typed; what it shows is the answer.
ASK_ZSH = """zmodload zsh/zpty; zpty shell zsh -f -i; zpty -w shell "PS1=READY; fpath=($1 \\$fpath); autoload -U compinit; compinit -u; \
zstyle ':completion:*' list-colors ''; LISTMAX=1000; COLUMNS=200; stty cols 200 rows 900; echo S''ET"
zpty -r -m shell shown '*SET*'; zpty -w -n shell "rodwake $2"$'\\t\\t'; sleep 1.5
while zpty -r -t shell more; do print -rn -- "$more"; done; zpty -d shell"""


class CompletionTest(ProgramTest):
    def setUp(self):
        super().setUp()
        for shell, name in (("bash", "rodwake"), ("zsh", "_rodwake")):
            self.write(f"{shell}/{name}", self.expect(0, "info", "--completion", shell).stdout)
        self.verbs = re.findall(r"(?m)^  ([a-z]+) ", self.expect(0, "--help").stdout.split("Subcommands:")[1])
        self.assertGreater(len(self.verbs), 12)

    def bash(self, *words):
        done = subprocess.run(["bash", "-c", ASK_BASH, "bash", "bash/rodwake", "rodwake", *words], cwd=self.folder, text=True,
                              capture_output=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return set(done.stdout.split())

    def zsh(self, words):
        done = subprocess.run(["zsh", "-f", "-c", ASK_ZSH, "zsh", "zsh", words], cwd=self.folder, text=True, capture_output=True, timeout=60)
        return done.stdout

    def test_verbs(self):
        self.assertLessEqual(set(self.verbs), self.bash(""))
        self.assertEqual(self.bash("sc"), {"scenes", "scan"})
        self.assertEqual(self.bash("help", "ti"), set())
        self.assertEqual(self.bash("help", "tr"), {"tradeoff"})

    def test_options_of_every_verb(self):
        for verb in self.verbs:
            listed = set(re.findall(r"--[a-z-]+", self.expect(0, "help", verb).stdout.split("Examples:")[0]))
            self.assertLessEqual(listed & self.bash(verb, "--"), self.bash(verb, "-"))
            options = set(re.findall(r"(?m)^  (?:-\w,)?(--[a-z-]+)", self.expect(0, "help", verb).stdout))
            self.assertEqual(self.bash(verb, "--"), options, verb)

    def test_values(self):
        self.assertEqual(self.bash("tradeoff", "x.toml", "--of", "fi"), {"fit", "field"})
        self.assertEqual(self.bash("new", "--kind", ""), {"rods", "bed", "scan", "critical"})
        self.assertEqual(self.bash("rods", "x.toml", "-s", "coupling.k"), {"coupling.kappa="})
        self.assertEqual(self.bash("rods", "x.toml", "-o", "ba"), {"bash"})

    def test_every_key_can_be_set(self):
        schema = json.loads((rodwake.SOURCE / "plots/rodwake_plots/schema.json").read_text())
        keys = {(f"{key['table']}." if key["table"] else "") + key["key"] for key in schema["keys"]}
        self.assertEqual({word.removesuffix("=") for word in self.bash("rods", "--set", "")}, {key.replace("[]", ".0") for key in keys})

    def test_zsh(self):
        self.assertRegex(self.zsh(""), r"(?s)check +-- validate a scene.*tradeoff +-- benchmark")
        self.assertIn("tradeoff --error", self.zsh("tradeoff --err"))
        self.assertIn("coupling.kappa=", self.zsh("rods -s coupling.ka"))
        self.assertRegex(self.zsh("new --kind "), r"(?s)bed.*rods.*scan")

    def test_the_manual_page(self):
        self.write("rodwake.1", self.expect(0, "info", "--man").stdout)
        done = subprocess.run(["groff", "-man", "-ww", "-Tascii", "-P-cbou", "rodwake.1"], cwd=self.folder, text=True, capture_output=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for verb in self.verbs:
            self.assertRegex(done.stdout, rf"(?m)^   {verb}$")
        for text in ("-s, --set TEXT", "table.key=value; repeatable", "rodwake scenes pair > my.toml", "130/143 stopped", "EXIT STATUS"):
            self.assertIn(text, done.stdout)


if __name__ == "__main__":
    rodwake.main()
