"""Machines that stop: what a verb asks of the file system, the folders that a crash may leave of it, and the same command there.

strace records the calls. A crash after any of them leaves what was synced; of all else any part: a write that is missing, cut short or
zeros, a name that is not there yet, a rename or removal that did not happen, whatever came later. fsync of a file makes its bytes safe,
fsync of a folder its names; renames are atomic.
"""

import dataclasses
import hashlib
import os
import re
import shutil
import subprocess
from pathlib import Path

import faults

BED = faults.SHORT_BED.replace('duration = "0.05 s"', 'duration = "1 s"').replace('"0.01 s"', '"0.1 s"')
BED = BED.replace("[granular.output]\n", '[granular.output]\ncheckpoint = "0.02 s"\n')
faults.VERBS["dem"] = (BED, {}, [], "rodwake")
faults.VERBS["ensemble"] = (BED.replace("[granular]\n", "[granular]\nruns = 3\n", 1), {}, [], "rodwake")
VERBS = ("rods", "field", "scan", "dem", "ensemble", "measure", "fit")
CALLS = ("openat,creat,write,pwrite64,pwritev,pwritev2,writev,ftruncate,truncate,rename,renameat,renameat2,unlink,unlinkat,rmdir,fsync,"
         "fdatasync,sync_file_range,syncfs,sync,mkdir,mkdirat,link,linkat,symlink,symlinkat,fallocate,copy_file_range,sendfile,lseek")


def arguments(verb):
    return faults.arguments({"ensemble": "dem"}.get(verb, verb))


# What was asked of the file system.


@dataclasses.dataclass
class Op:
    """kind: data (bytes at a place of a file), size (it gets that size), name (a file or folder, or None, under a name)."""
    kind: str
    file: int = 0
    at: int = 0
    data: bytes = b""
    names: dict = dataclasses.field(default_factory=dict)  # path: number of the file, or None
    safe: float = float("inf")  # number of the operations after which it cannot be lost


def unhex(text):
    return bytes.fromhex(text.replace("\\x", ""))


def calls_in(trace):
    """(name, arguments, result) of the calls that succeeded, in the order of their ends."""
    begun = {}
    for line in trace.read_text(encoding="ascii").splitlines():
        pid, rest = line.split(maxsplit=1)
        if rest.endswith("<unfinished ...>"):
            begun[pid] = rest.removesuffix("<unfinished ...>").rstrip()
            continue
        if resumed := re.match(r"<\.\.\. \w+ resumed>,? ?(.*)", rest):
            rest = begun.pop(pid) + " " + resumed[1]
        found = re.match(r"(\w+)\((.*)\)\s+= (-?\d+)", rest)
        if found and int(found[3]) >= 0:
            yield found[1], re.split(r", ?", found[2]), int(found[3])


class Recorder:
    """Operations below a folder, of a trace; the files that were there have the numbers of their paths in `first`."""

    def __init__(self, root, first):
        self.root, self.ops, self.positions, self.sizes = str(root), [], {}, {}
        self.live = {path: number for number, path in enumerate(first)}  # path: number
        self.folders = {number for path, number in self.live.items() if first[path] is None}
        for path, number in self.live.items():
            self.sizes[number] = len(first[path] or b"")
        self.count = len(first)

    def path(self, text, base=None):
        """Below the root, of an argument; None if it is elsewhere."""
        if text.startswith('"'):
            path = os.path.normpath(os.path.join(base or self.root, unhex(text.strip('"')).decode()))
        else:
            path = unhex(text[text.index("<") + 1:text.index(">")]).decode()
        return os.path.relpath(path, self.root) if path.startswith(self.root + "/") or path == self.root else None

    def add(self, op):
        self.ops.append(op)

    def make(self, path, folder=False):
        self.live[path] = self.count
        self.sizes[self.count] = 0
        if folder:
            self.folders.add(self.count)
        self.add(Op("name", names={path: self.count}))
        self.count += 1

    def resize(self, path, size):
        number = self.live[path]
        self.sizes[number] = size
        self.add(Op("size", number, size))

    def put(self, path, at, data):
        number = self.live[path]
        self.sizes[number] = max(self.sizes[number], at + len(data))
        self.add(Op("data", number, at, data))

    def sync(self, path):
        number, now = self.live[path], len(self.ops)
        for op in self.ops:
            own = number in self.folders and any(os.path.dirname(name) == (path if path != "." else "") for name in op.names)
            if op.safe > now and (own if op.kind == "name" else op.file == number and number not in self.folders):
                op.safe = now

    def take(self, name, words, result):
        if name == "openat":
            path = self.path(words[1], unhex(words[0][words[0].index("<") + 1:-1]).decode() if "<" in words[0] else None)
            if path is None or path not in self.live and "O_CREAT" not in words[2]:
                return
            if path not in self.live:
                self.make(path)
            if "O_TRUNC" in words[2] and self.sizes[self.live[path]]:
                self.resize(path, 0)
            self.positions[result, path] = None if "O_APPEND" in words[2] else 0
        elif name in ("mkdir", "unlink", "rename", "rmdir"):
            paths = [self.path(word) for word in words[:2] if word.startswith('"')]
            if None in paths:
                return
            if name == "mkdir":
                self.make(paths[0], folder=True)
            elif name == "rename":
                number = self.live.pop(paths[0])
                self.live[paths[1]] = number
                self.add(Op("name", names={paths[0]: None, paths[1]: number}))
            else:
                self.live.pop(paths[0])
                self.add(Op("name", names={paths[0]: None}))
        elif "<" not in words[0]:
            raise ValueError(f"{name}: a call that this study does not know")
        else:
            path = self.path(words[0]) if "(deleted)" not in words[0] else None
            if path is not None and path in self.live:
                self.on_file(name, int(words[0].split("<")[0]), path, words, result)

    def on_file(self, name, handle, path, words, result):
        number = self.live[path]
        if name == "pwrite64":
            self.put(path, int(words[3]), unhex(words[1].strip('"'))[:result])
        elif name in ("write", "writev"):
            data = unhex("".join(re.findall(r'"([^"]*)"', ",".join(words[1:]))))[:result]
            at = self.positions.get((handle, path))
            self.put(path, self.sizes[number] if at is None else at, data)
            if at is not None:
                self.positions[handle, path] = at + result
        elif name == "lseek":
            if self.positions.get((handle, path)) is not None:
                self.positions[handle, path] = result
        elif name == "ftruncate":
            self.resize(path, int(words[1]))
        elif name in ("fsync", "fdatasync"):
            self.sync(path)
        else:
            raise ValueError(f"{name} {path}: a call that this study does not know")


# States that a crash may leave.


def tree_of(root):
    """Bytes of each file and None of each folder below, by relative path, folders first."""
    return {".": None, **{os.path.relpath(path, root): path.read_bytes() if path.is_file() else None for path in sorted(root.rglob("*"))}}


def applied(op, fate, files):
    """A write or change of size as it came to the disk: whole (1), zeros (-1), or a part from its start."""
    data = files.setdefault(op.file, bytearray())
    if op.kind == "size":
        del data[op.at:]
        data.extend(bytes(op.at - len(data)))
        return
    piece = bytes(len(op.data)) if fate < 0 else op.data if fate == 1 else op.data[:int(fate * len(op.data))]
    data.extend(bytes(max(0, op.at - len(data))))
    data[op.at:op.at + len(piece)] = piece


def state_of(first, ops, folders, length, fate_of):
    """The tree after a crash: the first `length` operations, those that are not safe as fate_of says (0: lost)."""
    names = {path: number for number, path in enumerate(first)}
    files = {number: bytearray(first[path] or b"") for path, number in names.items()}
    for op in ops[:length]:
        fate = 1 if op.safe <= length else fate_of(op)
        if not fate:
            continue
        if op.kind != "name":
            applied(op, fate, files)
            continue
        for path, number in op.names.items():
            names.pop(path, None)
            if number is not None:
                names[path] = number
    return {path: None if number in folders else bytes(files.get(number, b"")) for path, number in names.items()
            if all(str(above) in names for above in Path(path).parents)}


def fates(chance):
    """Of operations that are not safe: lost with one probability in a state, else whole, or, if a write, in part or zeros."""
    lost, torn = chance.choice((0.1, 0.5, 0.9)), chance.choice((0.0, 0.2))

    def fate(op):
        if chance.random() < lost:
            return 0
        if op.kind != "data" or chance.random() >= torn:
            return 1
        return chance.choice((-1, chance.random()))
    return fate


def digest(tree):
    return hashlib.sha256(repr(sorted(tree.items())).encode()).hexdigest()


def crash_states(first, recorder, most, chance, seen):
    """Up to `most` trees unlike those seen: all prefixes in order, with nothing unsafe, then by chance."""
    ops, folders = recorder.ops, recorder.folders
    planned = [(length, how) for how in (lambda op: 1, lambda op: 0) for length in range(len(ops) + 1)]
    chance.shuffle(planned)
    found = []
    for attempt in range(20 * most):
        length, how = planned[attempt] if attempt < min(len(planned), most // 2) else (chance.randint(1, len(ops)), fates(chance))
        tree = state_of(first, ops, folders, length, how)
        if digest(tree) not in seen:
            seen.add(digest(tree))
            found.append(tree)
        if len(found) == most:
            break
    return found


# What the program makes of them.


class Bench(faults.Bench):
    """A verb, its results when nothing disturbs it, and folders in which it is run again."""

    def __init__(self, verb, folder):
        self.verb, self.folder = {"ensemble": "dem"}.get(verb, verb), Path(os.path.realpath(folder))
        self.place, self.command = self.folder / "place", arguments(verb)
        scene, files, before, _ = faults.VERBS[verb]
        self.place.mkdir(parents=True)
        for name, text in {"scene.toml": scene, **files}.items():
            (self.place / name).write_text(text)
        for earlier in before:
            if self.call(faults.arguments(earlier)).returncode:
                raise RuntimeError(f"{earlier} before {verb} fails")
        self.first = tree_of(self.place)
        if (done := self.call(self.command)).returncode:
            raise RuntimeError(f"{verb}: {done.stderr}")
        self.clean = self.results(self.place)

    def call(self, command):
        return subprocess.run(command, cwd=self.place, capture_output=True, text=True, errors="replace", timeout=60, check=False)

    def put(self, tree):
        shutil.rmtree(self.place)
        for path, data in sorted(tree.items()):
            if data is None:
                (self.place / path).mkdir(exist_ok=True, parents=True)
            else:
                (self.place / path).write_bytes(data)

    def record(self, tree):
        self.put(tree)
        trace = self.folder / "trace"
        self.call(["strace", "-f", "-y", "-xx", "-s", str(1 << 26), "-e", f"trace={CALLS}", "-o", trace, *self.command])
        recorder = Recorder(self.place, tree)
        for name, words, result in calls_in(trace):
            recorder.take(name, words, result)
        self.check(tree, recorder)
        return recorder

    def check(self, tree, recorder):
        """All operations together make what is on the disk."""
        whole = state_of(tree, recorder.ops, recorder.folders, len(recorder.ops), lambda op: 1)
        now = tree_of(self.place)
        if different := [path for path in now.keys() | whole.keys() if now.get(path) != whole.get(path)]:
            raise RuntimeError(f"the record does not make what is there: {different}")

    def judge(self, tree):
        """(ending, what is wrong, message) of the same command in this state."""
        self.put(tree)
        try:
            info, done = self.call([faults.PROGRAM, "info", "out"]), self.call(self.command)
        except subprocess.TimeoutExpired:
            return "hang", "more than a minute", ""
        for one in (info, done):
            if one.returncode not in (0, 1, 2) or faults.UNSEEMLY.search(one.stderr):
                return "unseemly", f"exit code {one.returncode}", one.stderr
        finished = done.returncode == 0 and "holds a finished run" in done.stderr
        if done.returncode == 0:
            differing = self.differing(self.place)
            return "finished" if finished else "resumed", f"silent: {differing}" if differing else "", ""
        forced = self.call([*self.command, "--force"])
        wrong = [f"--force: {forced.stderr.strip()[-300:]}"] if forced.returncode or self.differing(self.place) else []
        if not re.search(r"\bout\b", done.stderr):
            wrong.append("no file is named")
        return "refused", "; ".join(wrong), done.stderr
