#!/usr/bin/env python3
"""Run the commands of the book's Start and Guides, and compare what they print with the pages.

usage: check_book.py PROGRAM [--page PART_OF_NAME ...] [--jobs N] [--keep]

Fenced blocks of a page, by the word behind the fence:

    sh        commands; each block is run by `bash -euo pipefail`, all of a page in one fresh folder
    text      after an sh or python block: what it prints. `...` alone on a line stands for any lines, within a line
              for any characters; runs of blanks are one, and empty lines do not count
    python    run by python3 where it can import knotdock; the blocks of a page share their names
    console   commands that are not run (they install, open a window or need a cluster): the options are looked up

The folder of a page has `structures/examples` of this repository. A command `knotdock` in indented code, or in a
fence without one of these words, is an error. In docs/reference only the options of console blocks are looked up.
"""

import argparse
import difflib
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TIME_LIMIT = 300
"""Seconds that a block may take."""

PYTHON_LOOP = """
import contextlib, io, json, sys, traceback
names = {"__name__": "__main__"}
for line in sys.stdin:
    printed, good = io.StringIO(), True
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        try:
            exec(compile(json.loads(line), "page", "exec"), names)
        except BaseException:
            traceback.print_exc()
            good = False
    print(json.dumps([printed.getvalue(), good]), flush=True)
"""


@dataclass
class Block:
    """A fenced block of a page: its word, its first line's number and its text."""

    word: str
    line: int
    text: str
    expected: str | None = None


class Failure(Exception):
    """What is wrong with a page."""


def blocks(page: Path) -> list[Block]:
    """The blocks of a page in order; a text block right behind a block that is run is what that one prints."""
    found: list[Block] = []
    adjacent = False
    lines = iter(enumerate(page.read_text().splitlines(), 1))
    for number, line in lines:
        fence = re.match(r"\s*```\s*(\S*)", line)
        if fence is None:
            if re.match(r"\s{4,}(\S*/)?knotdock\s", line):
                raise Failure(f"{page}:{number}: a command in indented code, which nothing runs: {line.strip()}")
            adjacent = adjacent and not line.strip()
            continue
        word, held = fence[1], []
        for _, inner in lines:
            if inner.strip() == "```":
                break
            held.append(inner)
        block = Block(word, number, "\n".join(held) + "\n")
        if word == "text" and adjacent:
            found[-1].expected = block.text
            adjacent = False
            continue
        if word not in ("sh", "console") and re.search(r"^knotdock\s", block.text, re.MULTILINE):
            raise Failure(f"{page}:{number}: a command in a block of {word or 'no word'}: use sh or console")
        found.append(block)
        adjacent = word in ("sh", "python")
    return found


def squeezed(text: str) -> list[str]:
    """Lines that are not empty, runs of blanks as one."""
    return [" ".join(line.split()) for line in text.splitlines() if line.strip()]


def agrees(expected: list[str], printed: list[str]) -> bool:
    """Whether printed lines are the expected ones, `...` being any."""
    parts = []
    for line in expected:
        if line == "...":
            parts.append(r"(?:[^\n]*\n)*?")
        else:
            parts.append(".*".join(re.escape(part) for part in line.split("...")) + r"\n")
    return re.fullmatch("".join(parts), "".join(line + "\n" for line in printed)) is not None


def difference(expected: str, printed: str) -> str:
    """The two, line by line."""
    return "\n".join(difflib.unified_diff(squeezed(expected), squeezed(printed), "page", "printed", lineterm="", n=1))


class Options:
    """The options that each command of the program has, from its help."""

    def __init__(self, program: Path):
        self.program = program
        self.known: dict[tuple[str, ...], set[str]] = {}

    def of(self, command: tuple[str, ...]) -> set[str]:
        if command not in self.known:
            text = subprocess.run([self.program, *command, "--help"], capture_output=True, text=True, check=False)
            if text.returncode != 0:
                raise Failure(f"there is no command `knotdock {' '.join(command)}`")
            self.known[command] = set(re.findall(r"(?<![\w-])--?[a-zA-Z][\w-]*", text.stdout))
        return self.known[command]

    def check(self, line: str) -> None:
        """Refuse a command line that names a command or an option that does not exist."""
        words = shlex.split(re.sub(r"[<>|;&()]", " ", line), comments=True)
        words = words[words.index("knotdock") + 1 :]
        if not words or words[0].startswith("-"):
            self.require((), words)
            return
        command: tuple[str, ...] = (words[0],)
        rest = words[1:]
        if words[0] in ("morph", "se3") and rest and not rest[0].startswith("-"):
            command, rest = (words[0], rest[0]), rest[1:]
        behind = rest.index("--") if "--" in rest else len(rest)
        self.require(command, rest[:behind])
        self.require(("dock",), rest[behind + 1 :])

    def require(self, command: tuple[str, ...], words: list[str]) -> None:
        for word in words:
            option = re.match(r"--?[a-zA-Z][\w-]*", word)
            if option and option[0] not in self.of(command):
                raise Failure(f"`knotdock {' '.join(command)}` has no option {option[0]}")
        self.of(command)


def look_up(block: Block, page: Path, options: Options) -> None:
    """Look up the commands and options of a console block."""
    for line in block.text.replace("\\\n", " ").splitlines():
        if re.match(r"\s*(\$ )?(\w+=\S+ )*knotdock(\s|$)", line):
            try:
                options.check(line)
            except Failure as failure:
                raise Failure(f"{page}:{block.line}: {failure}\n    {line}") from None


class Page:
    """The folder of a page, and what runs in it."""

    def __init__(self, program: Path, folder: Path):
        self.folder = folder
        tools = folder / "tools"
        tools.mkdir()
        (tools / "knotdock").symlink_to(program)
        self.work = folder / "page"
        (self.work / "structures").mkdir(parents=True)
        (self.work / "structures" / "examples").symlink_to(ROOT / "structures" / "examples")
        self.environment = {**os.environ, "PATH": f"{tools}{os.pathsep}{os.environ['PATH']}", "NO_COLOR": "1"}
        self.environment["XDG_CACHE_HOME"] = str(folder / "cache")
        self.python: subprocess.Popen[str] | None = None

    def run_shell(self, text: str) -> tuple[str, bool]:
        """What a block of commands prints, and whether all of them succeeded."""
        try:
            done = subprocess.run(
                ["bash", "-euo", "pipefail", "-c", text],
                cwd=self.work,
                env=self.environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                timeout=TIME_LIMIT,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return f"stopped after {TIME_LIMIT} s", False
        return done.stdout, done.returncode == 0

    def run_python(self, text: str) -> tuple[str, bool]:
        """The same of a block of Python."""
        if self.python is None:
            self.python = subprocess.Popen(
                ["python3", "-c", PYTHON_LOOP],
                cwd=self.work,
                env=self.environment,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
        assert self.python.stdin and self.python.stdout
        self.python.stdin.write(json.dumps(text) + "\n")
        self.python.stdin.flush()
        answer = self.python.stdout.readline()
        return tuple(json.loads(answer)) if answer else ("python3 ended", False)

    def close(self) -> None:
        if self.python is not None:
            self.python.communicate()


def run_block(block: Block, page: Page, name: Path) -> None:
    """Run a block; raises `Failure` where it fails or prints something else than its page says."""
    printed, good = (page.run_shell if block.word == "sh" else page.run_python)(block.text)
    if not good:
        raise Failure(f"{name}:{block.line}: this failed:\n{block.text}\nIt printed:\n{printed}")
    if block.expected is not None and not agrees(squeezed(block.expected), squeezed(printed)):
        change = difference(block.expected, printed)
        raise Failure(f"{name}:{block.line}: this prints something else:\n{block.text}\n{change}")


def run_page(path: Path, program: Path, options: Options, with_python: bool, keep: bool) -> str:
    """Run a page's blocks, and say what ran; raises `Failure` at the first that fails or prints something else."""
    name = path.relative_to(ROOT)
    found = blocks(path)
    counts = {"sh": 0, "python": 0, "console": 0, "compared": 0}
    start = time.monotonic()
    folder = Path(tempfile.mkdtemp(prefix="knotdock_book_"))
    page = Page(program, folder)
    try:
        for block in found:
            if block.word == "console":
                look_up(block, name, options)
            elif block.word == "sh" or (block.word == "python" and with_python):
                run_block(block, page, name)
                counts["compared"] += block.expected is not None
            else:
                continue
            counts[block.word] += 1
    finally:
        page.close()
        if keep:
            print(f"{name}: kept in {page.work}")
        else:
            shutil.rmtree(folder)
    skipped = "" if with_python else ", python not run" * any(block.word == "python" for block in found)
    said = ", ".join(f"{count} {word}" for word, count in counts.items())
    return f"{name}: {said}{skipped}: {time.monotonic() - start:.1f} s"


def check_page(path: Path, program: Path, options: Options, with_python: bool, keep: bool) -> tuple[bool, str]:
    """Whether a page is right, and what to print."""
    try:
        if path.parent.name != "reference":
            return True, run_page(path, program, options, with_python, keep)
        name = path.relative_to(ROOT)
        for block in (block for block in blocks(path) if block.word == "console"):
            look_up(block, name, options)
        return True, f"{name}: read"
    except Failure as failure:
        return False, f"FAILED {failure}\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--page", action="append", help="only pages whose path has this in it")
    parser.add_argument("--jobs", type=int, default=2, help="pages that run at the same time")
    parser.add_argument("--keep", action="store_true", help="keep the folders of the pages")
    arguments = parser.parse_args()
    program = arguments.program.resolve()
    wanted = [p for part in ("start", "guides", "reference") for p in sorted((ROOT / "docs" / part).glob("*.md"))]
    if arguments.page:
        wanted = [path for path in wanted if any(part in str(path) for part in arguments.page)]
    imported = subprocess.run(["python3", "-c", "import knotdock"], capture_output=True, check=False)
    with_python = imported.returncode == 0
    if not with_python:
        print("python3 has no knotdock here: blocks of Python are not run")
    options = Options(program)
    start, failed = time.monotonic(), 0
    with ThreadPoolExecutor(arguments.jobs) as pool:
        waiting = [pool.submit(check_page, path, program, options, with_python, arguments.keep) for path in wanted]
        for done in as_completed(waiting):
            good, said = done.result()
            failed += not good
            print(said, flush=True)
    print(f"{len(wanted)} pages, {failed} failed, {time.monotonic() - start:.1f} s")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
