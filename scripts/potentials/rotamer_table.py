#!/usr/bin/env python3
"""Derives the program's table of rotamers from the backbone-dependent rotamer library of 2010.

    python3 scripts/potentials/rotamer_table.py dunbrack-2010.lib.csv [-o FILE]

The library: Shapovalov & Dunbrack, Structure 19 (2011) 844-858, free under the Open Data Commons Attribution License
(ODC-By). It gives probabilities and mean chi angles at phi and psi every 10 degrees. Its rows as CSV are in the crate
dunbrack 0.1.0:

    cargo init --name fetch fetch && cd fetch && cargo add dunbrack@0.1.0 && cargo vendor
    python3 .../rotamer_table.py vendor/dunbrack/data/dunbrack-2010.lib.csv

The table keeps every fourth node of phi and psi, rotamers of at least 2% there, and the free form of cysteine. Angles
are in whole degrees, probabilities in thousandths. Psi begins 20 degrees later than phi, so that the nodes lie near
helices (-60, -40) and strands (-140, 120).

Needs Python 3.9 or later.
"""

import argparse
import csv
from pathlib import Path

TABLE = Path(__file__).resolve().parents[2] / "structures/src/molecule/chemistry/rotamers.csv"
# Proline's ring is left as it is; cysteine as the library has it free and bridged together, or bridged, is not used.
LEFT_OUT = {"PRO", "CPR", "TPR", "CYS", "CYD"}
CHI_ANGLES = {"ARG": 4, "LYS": 4, "GLN": 3, "GLU": 3, "MET": 3, "CYH": 1, "SER": 1, "THR": 1, "VAL": 1}
STEP = 40
LEAST = 0.02
HEADER = """\
# Rotamers of amino acids by backbone: probability in thousandths and mean chi angles in degrees, at nodes of phi, psi.
# From the 2010 Backbone-Dependent Rotamer Library, M. V. Shapovalov & R. L. Dunbrack Jr., Structure 19 (2011) 844-858,
# which is distributed under the Open Data Commons Attribution License (ODC-By 1.0); this excerpt is under it, too:
# https://opendatacommons.org/licenses/by/1-0/
# Made by scripts/potentials/rotamer_table.py: nodes every 40 degrees, rotamers of at least 2%. Read by rotamers.rs.
residue,phi,psi,probability,chi1,chi2,chi3,chi4
"""


def rows(path):
    with path.open(newline="") as lines:
        for row in csv.DictReader(lines):
            phi, psi, probability = int(row["phi"]), int(row["psi"]), float(row["prob"])
            on_node = (phi + 180) % STEP == 0 and (psi + 180 - STEP // 2) % STEP == 0 and phi < 180
            if on_node and row["res"] not in LEFT_OUT and probability >= LEAST:
                count = CHI_ANGLES.get(row["res"], 2)
                chi = [str(round(float(row[f"chi{k}-val"]))) if k <= count else "" for k in range(1, 5)]
                name = "CYS" if row["res"] == "CYH" else row["res"]
                yield ",".join([name, str(phi), str(psi), str(round(1000 * probability)), *chi])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("library", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=TABLE)
    arguments = parser.parse_args()
    table = HEADER + "".join(row + "\n" for row in rows(arguments.library))
    arguments.output.write_text(table, encoding="ascii")
    print(f"{arguments.output}: {len(table)} bytes")


if __name__ == "__main__":
    main()
