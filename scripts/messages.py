#!/usr/bin/env python3
"""List every error, warning and remedy that a user may read, from the code: to be read in one go.

usage: scripts/messages.py [--long N]        --long: only those of more than N words
"""

import argparse
import pathlib
import re

ROOT = pathlib.Path(__file__).parents[1]
# What begins a message: the attribute of an error, and the calls that take one.
BEGINS = re.compile(
    r"#\[error\(|Failure::(?:input|other|of_program)\(|\.remedy\(|\.warn\(|\.error\(|warnings\.push\(|"
    r"(?:fn (?:remedy|advice|help)\w*\([^)]*\)[^{;]*\{)|(?:message|remedy|reason|instead)\s*[:=]\s*|"
    r"Err\((?:format!\()?\"|"
    r"wrong\(|refuse\w*\(|fault\(|unreadable\("
)
LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"', re.S)


def balanced(text: str, start: int) -> str:
    """The text from an opening bracket to the one that closes it; else to the end of the line."""
    opening = text[start - 1] if start and text[start - 1] in "([{" else None
    if opening is None:
        end = min((i for i in (text.find(";", start), text.find(",\n", start)) if i >= 0), default=len(text))
        return text[start:end]
    depth, i = 1, start
    while i < len(text) and depth:
        literal = LITERAL.match(text, i)
        if literal:
            i = literal.end()
            continue
        depth += {"(": 1, "[": 1, "{": 1, ")": -1, "]": -1, "}": -1}.get(text[i], 0)
        i += 1
    return text[start:i]


def messages(path: pathlib.Path):
    """Line and text of each message in a file, without its tests."""
    text = path.read_text().split("#[cfg(test)]\nmod tests")[0]
    text = re.sub(r"^\s*//.*$", lambda comment: " " * len(comment.group()), text, flags=re.M)
    seen = set()
    for begin in BEGINS.finditer(text):
        start = begin.end() - (1 if begin.group().endswith('"') else 0)
        for literal in LITERAL.finditer(balanced(text, start)):
            place = start + literal.start()
            words = re.sub(r"\\\n\s*", "", literal.group(1)).replace('\\"', '"').replace("\\n", " ")
            # A message has words.
            if place not in seen and len(re.findall(r"[A-Za-z]{2,}", words)) > 2:
                seen.add(place)
                yield text.count("\n", 0, place) + 1, words


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--long", type=int, default=0)
    wanted = parser.parse_args()
    count = 0
    for folder in ("src", "cli/src", "structures/src", "scoring/src", "python/src"):
        for path in sorted((ROOT / folder).rglob("*.rs")):
            found = [(line, text) for line, text in messages(path) if len(text.split()) > wanted.long]
            if found:
                print(path.relative_to(ROOT))
            for line, text in sorted(set(found)):
                print(f"  {line}: {text}")
                count += 1
    print(f"{count} messages")


if __name__ == "__main__":
    main()
