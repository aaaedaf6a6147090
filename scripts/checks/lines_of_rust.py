#!/usr/bin/env python3
"""Count the lines of Rust in each crate, with and without inline tests.

usage: lines_of_rust.py      from anywhere in the repository

Inline tests are modules behind `#[cfg(test)]`, in the file or in one of their own. CI prints the table; nothing fails
by it.
"""

import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
CRATES = ("src", "cli/src", "structures/src", "scoring/src", "python/src")
INLINE = re.compile(r"^#\[cfg\(test\)\]\n(?:#.*\n)*(?:pub(?:\(.*?\))? )?mod \w+ \{\n.*?^\}\n", re.M | re.S)
OF_FILES = re.compile(r"^#\[cfg\(test\)\]\n(?:#.*\n)*(?:pub(?:\(.*?\))? )?mod (\w+);", re.M)


def test_files(path, text):
    """Files of the modules that are compiled for tests alone."""
    folder = path.parent if path.stem in ("lib", "main", "mod") else path.with_suffix("")
    for name in OF_FILES.findall(text):
        yield folder / f"{name}.rs"
        yield from (folder / name).rglob("*.rs")


def counted(folder):
    texts = {path: path.read_text() for path in sorted(folder.rglob("*.rs"))}
    tests = {file for path, text in texts.items() for file in test_files(path, text)}
    plain = sum(INLINE.sub("", text).count("\n") for path, text in texts.items() if path not in tests)
    return plain, sum(text.count("\n") for text in texts.values())


def main():
    found = {name: counted(ROOT / name) for name in CRATES}
    found["all"] = tuple(map(sum, zip(*found.values())))
    print(f"{'lines of Rust':16} without inline tests    with them")
    for name, (plain, whole) in found.items():
        print(f"{name:16} {plain:20,} {whole:12,}")


if __name__ == "__main__":
    main()
