#!/usr/bin/env python3
"""Write the pages of commands and options from the program's help, and check the pages of its files against a run.

usage: write_reference.py PROGRAM            writes docs/reference/commands.md and docs/reference/options.md
       write_reference.py PROGRAM --check    writes nothing; exit code 1 where those pages differ from the help, where
                                             a column of poses.csv or an entry of run.json (two levels deep) is not
                                             described, or where a described one does not exist

For the check the example is docked once, and once more with distances, for the columns that only they bring.
"""

import argparse
import csv
import difflib
import json
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT / "docs" / "reference"
EXAMPLES = ROOT / "structures" / "examples"
SHARED = ("--json", "--quiet", "--verbose", "--help", "--version")
"""Options of all commands, described once."""
HIDDEN = ("preset", "completions", "man")
"""Commands that the list of the help leaves out."""
DEFAULT = re.compile(r"\s*\[default: ([^\]]*)\]")
POSSIBLE = re.compile(r"\.?\s*\[possible values: ([^\]]*)\]")


@dataclass
class Entry:
    """An argument or option: its name with its value, its meaning, and its default."""

    name: str
    meaning: str
    default: str

    @property
    def row(self) -> str:
        return f"| `{cell(self.name)}` | {cell(self.meaning)} | {f'`{cell(self.default)}`' if self.default else ''} |"

    @property
    def long(self) -> str:
        found = re.search(r"--[\w-]+", self.name)
        return found[0] if found else self.name


@dataclass
class Command:
    """What the help of a command says."""

    name: str
    about: str = ""
    usage: str = ""
    groups: dict[str, list[Entry]] = field(default_factory=dict)
    commands: dict[str, str] = field(default_factory=dict)
    subjects: dict[str, str] = field(default_factory=dict)
    examples: list[str] = field(default_factory=list)

    @property
    def summary(self) -> str:
        return " ".join(self.about.split("\n\n")[0].split()).removesuffix(".")


def cell(text: str) -> str:
    """Text as a cell of a table holds it."""
    return text.replace("|", "\\|")


def help_of(program: Path, words: list[str]) -> str:
    done = subprocess.run(
        ["knotdock", *words, "--help"], executable=program, capture_output=True, text=True, check=True
    )
    return done.stdout


def entry(name: str, lines: list[str]) -> Entry:
    """An entry from the lines below its name; possible values become a sentence each."""
    said: list[str] = []
    values: list[str] = []
    part = said
    for line in (line.strip() for line in lines):
        if line == "Possible values:":
            part = values
        elif not line or line.startswith("[default:"):
            part = said
            said.append(line)
        elif part is values and not line.startswith("- "):
            values[-1] += f" {line}"
        else:
            part.append(line.removeprefix("- ") if part is values else line)
    text = POSSIBLE.sub(r". One of \1.", " ".join(" ".join(said).split()))
    default = DEFAULT.search(text)
    text = DEFAULT.sub("", text).strip()
    if values:
        named = (value.partition(":") for value in values)
        shown = "; ".join(f"`{value.strip()}`: {meaning.strip()}" for value, _, meaning in named)
        text = text.rstrip(".") + f". {shown}"
    return Entry(name, text.replace("<", "\\<"), default[1] if default else "")


def read(program: Path, words: list[str]) -> Command:
    """The help of a command, in parts."""
    lines = help_of(program, words).splitlines()
    command = Command(" ".join(["knotdock", *words]))
    start = next(number for number, line in enumerate(lines) if line.startswith("Usage:"))
    end = next(number for number in range(start, len(lines)) if not lines[number])
    command.about = "\n".join(lines[:start]).strip()
    command.usage = " ".join(" ".join(lines[start:end]).split()).removeprefix("Usage: ")
    group, name = "", ""
    held: list[str] = []
    for line in [*lines[end:], "End:"]:
        if re.match(r"\S", line) or re.match(r" {2,6}[-\[<]", line):
            if name:
                command.groups.setdefault(group, []).append(entry(name, held))
            name, held = "", []
        if re.match(r"\S.*:$", line):
            group = line[:-1]
        elif group == "Commands" or (not words and group != "Options"):
            read_command(command, group, line)
        elif group == "Examples":
            command.examples += [line.strip()] if line.startswith("  ") else []
        elif re.match(r" {2,6}[-\[<]", line):
            # A short help has the meaning on the same line.
            name, *held = re.split(r" {2,}", line.strip(), maxsplit=1)
        else:
            held.append(line)
    return command


def read_command(command: Command, subject: str, line: str) -> None:
    """A line of a list of commands: a command with its description, or more of the description."""
    begun = re.match(r"  (\S+) +(.*)", line)
    if begun:
        command.commands[begun[1]] = begun[2]
        command.subjects[begun[1]] = subject
    elif line.strip():
        last = list(command.commands)[-1]
        command.commands[last] += f" {line.strip()}"
    command.commands.pop("help", None)


def all_commands(program: Path) -> list[Command]:
    """All commands in the order of the help, subcommands behind their own, and those that are not listed."""
    found = []
    for word in (*read(program, []).commands, *HIDDEN):
        command = read(program, [word])
        found.append(command)
        found.extend(read(program, [word, below]) for below in command.commands)
    return found


def anchor(name: str) -> str:
    return name.replace(" ", "-")


def table(entries: list[Entry], first: str) -> str:
    return "\n".join([f"| {first} | meaning | default |", "|---|---|---|", *(each.row for each in entries)])


def commands_page(program: Path) -> str:
    """docs/reference/commands.md."""
    commands = all_commands(program)
    subjects = read(program, []).subjects
    top = [(command.name.split()[1], command) for command in commands if command.name.count(" ") == 1]
    parts = [
        "# Commands",
        "Written by `scripts/book/write_reference.py` from the help of each command. [recipes.md](recipes.md) has a "
        "command\nfor each question, and [options.md](options.md) every option.",
        "\n".join(
            ["| subject | command | what it does |", "|---|---|---|"]
            + [
                f"| {subjects.get(word, 'Other')} | [`{word}`](#knotdock-{word}) | {cell(command.summary)} |"
                for word, command in top
            ]
        ),
    ]
    for command in commands:
        parts.append(f"## {command.name}")
        parts += [paragraph(part) for part in command.about.split("\n\n")]
        parts.append(f"Usage: `{command.usage}`")
        arguments = command.groups.get("Arguments")
        if arguments:
            parts.append(table(arguments, "argument"))
        if command.commands:
            rows = [f"| [`{w}`](#{anchor(command.name)}-{w}) | {cell(a)} |" for w, a in command.commands.items()]
            parts.append("\n".join(["| command | what it does |", "|---|---|", *rows]))
        if command.examples:
            parts.append("\n".join(["```console", *command.examples, "```"]))
        if own_options(command):
            parts.append(f"Options: [options.md](options.md#{anchor(command.name)})")
    return "\n\n".join(parts) + "\n"


def paragraph(text: str) -> str:
    """A paragraph of a help as Markdown; lines that each name a command are a list."""
    lines = text.splitlines()
    if all(re.match(r"\w+: knotdock ", line) for line in lines):
        return "\n".join(re.sub(r"^(\w+): (.*?)(?=, in a folder|$)", r"- \1: `\2`", line) for line in lines)
    return wrapped(text)


def wrapped(text: str, width: int = 118) -> str:
    """Words in lines of at most `width` characters."""
    lines = [""]
    for word in text.replace("<", "\\<").split():
        if lines[-1] and len(lines[-1]) + 1 + len(word) > width:
            lines.append("")
        lines[-1] += (" " if lines[-1] else "") + word
    return "\n".join(lines)


def own_options(command: Command) -> dict[str, list[Entry]]:
    """The options of a command by group, without those of all commands."""
    groups = {}
    for group, entries in command.groups.items():
        kept = [each for each in entries if each.name.startswith("-") and each.long not in SHARED]
        if kept:
            groups[group] = kept
    return groups


def options_page(program: Path) -> str:
    """docs/reference/options.md."""
    commands = [command for command in all_commands(program) if own_options(command)]
    first: dict[tuple[str, str, str], str] = {}
    shared = [each for each in read(program, []).groups["Options"] if each.long in SHARED]
    parts = [
        "# Options",
        "Written by `scripts/book/write_reference.py` from the help of each command. Lengths are in Å, of meshes in "
        "the unit of\ntheir files. Weights and potentials of the score are set by files of options: "
        "[config_files.md](config_files.md).",
        "All commands have",
        table(shared, "option"),
    ]
    for command in commands:
        parts.append(f"## {command.name}")
        same: dict[str, list[str]] = {}
        for group, entries in own_options(command).items():
            new = []
            for each in entries:
                owner = first.setdefault((each.name, each.meaning, each.default), command.name)
                if owner == command.name:
                    new.append(each)
                else:
                    same.setdefault(owner, []).append(each.long)
            if new:
                parts.append(f"**{group}**\n\n{table(new, 'option')}")
        rows = [
            f"| [{owner}](#{anchor(owner)}) | {', '.join(f'`{n}`' for n in names)} |" for owner, names in same.items()
        ]
        if rows:
            parts.append("\n".join(["| as of | options |", "|---|---|", *rows]))
    return "\n\n".join(parts) + "\n"


def described(page: Path) -> dict[str, set[str]]:
    """Names in backticks in the first cells of a page's tables, by heading and the table's first column name."""
    found: dict[str, set[str]] = {}
    heading, first = "", ""
    for line in page.read_text().splitlines():
        if line.startswith("#"):
            heading = line.lstrip("# ").strip()
        elif not line.startswith("|"):
            first = ""
        elif not first:
            first = line.split("|")[1].strip()
        elif not line.startswith("|---"):
            names = re.findall(r"`([^`]+)`", line.split("|")[1])
            found.setdefault(f"{heading}/{first}", set()).update(names)
    return found


def compare(what: str, real: set[str], page: set[str], maybe: frozenset[str] = frozenset()) -> list[str]:
    """Sentences on names that only one of the two has; those in `maybe` need not be real."""
    lacking = [f"{what}: {name} is not described" for name in sorted(real - page)]
    return lacking + [f"{what}: {name} is described, and does not exist" for name in sorted(page - real - maybe)]


def run_example(program: Path, folder: Path) -> tuple[set[str], dict[str, object]]:
    """Columns of poses.csv, also those of a run with distances, and the record of a run of the example."""
    pairs = folder / "pairs.csv"
    pairs.write_text("receptor,ligand,upper\nA:189,B:5,8\n")
    predicted = folder / "predicted.csv"
    predicted.write_text("chain,residue,probability\nA,57,0.8\nA,100,0.1\n")
    partners = [EXAMPLES / f"1ppe_{side}_unbound.pdb" for side in ("receptor", "ligand")]
    base: list[Path | str] = [program, "dock", *partners, "--rotations", "300", "--diagnostics", "-q"]
    natives = [f"--native-{side}={EXAMPLES / f'1ppe_{side}_bound.pdb'}" for side in ("receptor", "ligand")]
    known: list[Path | str] = [
        "--restraints",
        pairs,
        "--interface-receptor",
        predicted,
        "--membrane=-60,-30",
        "--no-report",
    ]
    subprocess.run([*base, *natives, "-o", folder / "example"], check=True)
    subprocess.run([*base, *known, "-o", folder / "known"], check=True)
    columns = set()
    for name in ("example", "known"):
        with (folder / name / "poses.csv").open(newline="") as table_file:
            columns |= set(next(csv.reader(table_file)))
    return columns, json.loads((folder / "example" / "run.json").read_text())


def check_files(program: Path) -> list[str]:
    """Entries that the pages of poses.csv and run.json lack, and entries that they should not have."""
    with tempfile.TemporaryDirectory() as folder:
        columns, record = run_example(program, Path(folder))
    pages = described(REFERENCE / "poses_csv.md")
    faults = compare("poses.csv", columns, set().union(*(v for k, v in pages.items() if k.endswith("/column"))))
    pages = described(REFERENCE / "run_json.md")
    faults += compare("run.json", set(record), pages["The whole/entry"])
    for key, value in record.items():
        entries = pages.get(f"{key}/entry")
        if entries is not None and isinstance(value, dict):
            faults += compare(f"run.json, {key}", set(value), entries)
        elif entries is None and isinstance(value, dict) and key not in ("files", "match"):
            faults.append(f"run.json, {key}: there is no table of its entries")
    return faults


def check_weights(program: Path) -> list[str]:
    """What the table of weights lacks, and where it has another default."""
    words = [program, "preset", "default", "--all"]
    text = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    real = {name: float(value) for name, value in re.findall(r"^(\w+_weight) = (\S+)$", text, re.MULTILINE)}
    page = (REFERENCE / "config_files.md").read_text()
    listed = {
        name: float(value) for name, value in re.findall(r"^\| `(\w+_weight)` \| ([\d.]+) \|", page, re.MULTILINE)
    }
    different = [name for name in sorted(real.keys() | listed.keys()) if real.get(name) != listed.get(name)]
    return [f"config_files.md: {name} is {real.get(name)}, not {listed.get(name)}" for name in different]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    program = arguments.program.resolve()
    faults = []
    for name, text in {"commands.md": commands_page(program), "options.md": options_page(program)}.items():
        page = REFERENCE / name
        if not arguments.check:
            page.write_text(text)
        elif page.read_text() != text:
            change = difflib.unified_diff(page.read_text().splitlines(), text.splitlines(), name, "help", "", "", 0, "")
            faults.append("\n".join(change) + f"\n{name} differs from the help: run write_reference.py")
    if arguments.check:
        faults += check_files(program) + check_weights(program)
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
