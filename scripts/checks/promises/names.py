"""Names in files: no harm to a spreadsheet or a terminal."""

import csv
import io
import re

from promises.exact_scores import atom_line
from promises.folders import tree
from promises.hostile_sizes import cif
from promises.scenes import prism, write_inputs

FORMULAS = ["=1+1", "+1+1", "-1+1", "@SUM(1)", "=cmd|'/c calc'!A0", "=HYPERLINK(1)", "-A", "+B", "@x"]
CONTROLS = ["\x1b[2J", "\x1b]0;title\x07", "\x07", "\x08\x08", "\x9b31m", "\r", "\x7f", "\x0c", "\x1b[8m"]


def quoted(word):
    """A value of mmCIF in quotes."""
    return f'"{word}"' if '"' not in word else f"'{word}'"


def structure(trial, words):
    """mmCIF text of a few residues with names out of a list."""
    pick, rows = trial.random.choice, []
    for number in range(12):
        chain, residue = quoted(pick(words)), quoted(pick(words)) if number % 3 == 0 else "ALA"
        atom = quoted(pick(words)) if number % 4 == 0 else "CA"
        rows.append(f"ATOM {number + 1} C {atom} . {residue} {chain} {number + 1} {number + 1} {chain}"
                    f" {number * 3.8:.1f} 0 0 1 10 1\n")  # fmt: skip
    return cif(rows)


def is_number(cell):
    return re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", cell) is not None


def spreadsheet_cells(trial):
    """No cell of a table begins as a formula: with =, +, -, @, a tab or a carriage return, but for numbers.

    Chains, residues, atoms and files with such names, in `inspect --atoms`, `batch` and `dock`; every cell of every
    table that is written is looked at.
    """
    write_inputs(trial.folder)
    before = tree(trial.folder)
    trial.make("a.cif", structure(trial, FORMULAS))
    name = trial.random.choice(["=1+1.pdb", "+x.pdb", "@x.pdb", "-x.pdb", "none.pdb"])
    (trial.folder / name).write_bytes((trial.folder / "ligand.pdb").read_bytes())
    label = trial.random.choice(["one", "-one", "=one", "+one", "@one"])
    gone = trial.random.choice([name, "=gone.pdb"])
    trial.make("pairs.csv", f"receptor,ligand,name\nreceptor.pdb,{gone},{label}\nreceptor.pdb,{name},two\n")
    trial.run("inspect", "a.cif", "--atoms", "atoms.csv")
    trial.run("batch", "pairs.csv", "-o", "runs", "--", "--rotations", "2", "--poses", "5")
    for path, content in tree(trial.folder).items():
        if path.endswith(".csv") and path not in before and isinstance(content, bytes):
            for row in csv.reader(io.StringIO(content.decode())):
                bad = [cell for cell in row if cell[:1] in ("=", "+", "-", "@", "\t", "\r") and not is_number(cell)]
                trial.check(not bad, f"{path} has cells {bad[:3]}")


def control_characters(trial):
    """Control characters of files and of their names do not reach the terminal.

    Escape sequences in the names of chains, residues, solids, pairs and options and of files; output and messages of
    inspect, sample, batch and dock hold no control character but line ends and tabs.
    """
    write_inputs(trial.folder)
    pick = trial.random.choice
    bad = pick(CONTROLS)
    trial.make("a.cif", structure(trial, [f"A{bad}", f"{bad}B", "C"]).encode("utf-8"))
    residue = atom_line(1, "CA", 1, (0, 0, 0), name=(bad + "XX")[:3], chain=bad[0])
    trial.make("a.pdb", residue + (trial.folder / "ligand.pdb").read_text())
    trial.make("a.stl", f"solid {bad}\nfacet normal {bad}\nendsolid\n")
    trial.make("a.obj", f"g {bad}\nmtllib {bad}\n{bad} 1\n" + prism([(0, 0), (2, 0), (0, 2)], 2))
    trial.make("a.csv", f"receptor,ligand,name,{bad}\nreceptor{bad}.pdb,ligand.pdb,one{bad},1\n")
    trial.make("a.toml", f'[search]\n"rota{bad}tions" = 4\n')
    trial.make(f"b{bad}.pdb", residue)
    calls = [
        ["inspect", "a.cif"],
        ["inspect", "a.pdb", "-v"],
        ["inspect", f"b{bad}.pdb"],
        ["inspect", f"gone{bad}.pdb"],
        ["sample", "a.stl", "--grid", "2^9"],
        ["sample", "a.obj", "--grid", "2^9"],
        ["batch", "a.csv", "-o", "runs"],
        ["dock", "receptor.pdb", "ligand.pdb", "--config", "a.toml", "-o", "run"],
        ["dock", "receptor.pdb", "a.pdb", "--rotations", "2", "-o", "run"],
    ]
    for words in trial.random.sample(calls, 4):
        is_json = trial.random.random() < 0.3
        call = trial.run(*words, *(["--json"] if is_json else []))
        # JSON has a program for a reader, and need not escape characters above 0x7e.
        said = call.err if is_json else call.out + call.err
        found = re.search(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]", said) or re.search(r"[\x00-\x09\x0b-\x1f]", call.out)
        shown = repr(found[0]) + " in " + said[-200:] if found else ""
        trial.check(not found, f"{words}: {shown!r}")
