#!/usr/bin/env python3
"""Checks knotdock's atoms, radii, volumes, surfaces and overlaps against RDKit (PyPI).

    python scripts/checks/check_rdkit.py target/release/knotdock structures/examples

Needs rdkit and numpy (requirements_rdkit.txt) in the running Python. The molecules are the example pair, read by RDKit
without sanitising, and some that RDKit builds and embeds itself (fixed seeds). Those are a peptide of all twenty amino
acids and small molecules, with and without their hydrogens. What is compared, with the tolerance:

    atoms       names, residues, numbers and coordinates of the atoms read, exactly
    radii       ProtOr's of every amino acid atom, as FreeSASA in RDKit has them, within 0.005 Å but for the atoms of
                MEANT; all-atom radii against RDKit's van der Waals radii within 0.16 Å
    volume      of the union of balls: a grid of 0.2 Å (0.1 Å for fewer than 100 atoms) within 0.2%,
                DoubleCubicLatticeVolume within 0.8%
    accessible  area, probe 1.4 Å: FreeSASA (Shrake and Rupley; its slices of Lee and Richards are 2.7% off on flat
                caffeine) within 1.2%, and 2.5% for fewer than 100 atoms: it counts 100 points a sphere
    buried      area of a placed pair: FreeSASA within 1.5% or 8 Å^2
    overlap     of a placed pair: Tanimoto and protrude distance of grids of 0.2 Å within 0.004; RDKit's
                ShapeTanimotoDist and ShapeProtrudeDist with its own radii, hydrogens kept, within 0.05

At the end each comparison is made again with a figure spoilt on purpose, which must fail.
Exit code 0: all agree; 1: a figure drifted; 2: the check could not be made.
"""

import argparse
import csv
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from rdkit import Chem, DataStructs
from rdkit.Chem import AllChem, rdFreeSASA, rdMolDescriptors, rdShapeHelpers
from rdkit.Geometry import rdGeometry

# Where our radii differ from FreeSASA's on purpose: a carboxylate shares its charge, so both oxygens are alike,
# those of the chain's end included.
MEANT = {("ASP", "OD2"), ("GLU", "OE2"), ("*", "OXT")}

SMALL = {
    "caffeine": "Cn1cnc2c1c(=O)n(C)c(=O)n2C",
    "cholesterol": "C[C@H](CCCC(C)C)[C@H]1CC[C@@H]2[C@@]1(CC[C@H]3[C@H]2CC=C4[C@@]3(CC[C@@H](C4)O)C)C",
    "halogens": "Fc1cc(Cl)cc(Br)c1SCCP(=O)(O)O",
}


class Failure(Exception):
    """The check could not be made."""


class Tally:
    """Comparisons made, and those that failed."""

    def __init__(self):
        self.made, self.failed, self.worst = 0, 0, {}

    def compare(self, kind, name, ours, reference, tolerance):
        self.made += 1
        off = abs(ours - reference)
        share = off / tolerance if math.isfinite(off) else math.inf
        self.worst[kind] = max(self.worst.get(kind, 0.0), share)
        if not share <= 1.0:
            self.failed += 1
            print(
                f"DRIFT {kind}, {name}: knotdock {ours:.6g}, RDKit {reference:.6g}, "
                f"off by {off:.3g} where {tolerance:.3g} is allowed"
            )


def run(knotdock, *arguments):
    done = subprocess.run([knotdock, *map(str, arguments), "--json", "--quiet"], capture_output=True, text=True)
    if done.returncode != 0:
        raise Failure(f"knotdock {' '.join(map(str, arguments))} failed:\n{done.stderr}")
    return json.loads(done.stdout)


class Molecule:
    """A file as both programs see it."""

    def __init__(self, knotdock, path, scratch, options=()):
        self.path, self.options = path, options
        table = scratch / "atoms.csv"
        self.reported = run(knotdock, "inspect", path, "--atoms", table, "--force", *options)
        with open(table, newline="") as file:
            rows = list(csv.DictReader(file))
        self.rows = [row for row in rows if not row["dropped"]]
        self.names_dropped = {row["residue"] for row in rows if row["dropped"] in ("water", "additive")}
        whole = Chem.MolFromPDBFile(str(path), sanitize=False, removeHs=False, proximityBonding=False)
        if whole is None:
            raise Failure(f"RDKit cannot read {path}")
        keeps_hydrogens = "--hydrogens" in options
        drop = [
            atom.GetIdx()
            for atom in whole.GetAtoms()
            if atom.GetPDBResidueInfo().GetResidueName().strip() in self.names_dropped
            or (atom.GetAtomicNum() == 1 and not keeps_hydrogens)
        ]
        editable = Chem.RWMol(whole)
        for index in reversed(drop):
            editable.RemoveAtom(index)
        self.rdkit = editable.GetMol()
        self.radii = [float(row["radius"]) for row in self.rows]
        self.positions = np.array([[float(row[axis]) for axis in "xyz"] for row in self.rows])

    def placed(self, rotation, translation):
        return self.positions @ rotation.T + translation


def check_atoms(tally, name, molecule):
    """The atoms read: one comparison, of how many differ."""
    theirs = []
    positions = molecule.rdkit.GetConformer().GetPositions()
    for atom, position in zip(molecule.rdkit.GetAtoms(), positions):
        info = atom.GetPDBResidueInfo()
        theirs.append(
            (
                info.GetName().strip(),
                info.GetResidueName().strip(),
                info.GetChainId().strip(),
                info.GetResidueNumber(),
                info.GetInsertionCode().strip(),
                atom.GetSymbol(),
                tuple(np.round(position, 3)),
            )
        )
    ours = [
        (
            row["atom"],
            row["residue"],
            row["chain"],
            int(row["number"]),
            row["insertion"],
            row["element"],
            tuple(np.round([float(row[axis]) for axis in "xyz"], 3)),
        )
        for row in molecule.rows
    ]
    if not ours:
        raise Failure(f"{name}: no atoms")
    different = len(set(ours) ^ set(theirs)) + abs(len(ours) - len(theirs))
    tally.compare("atoms", name, different, 0, 0.5)
    return ours == theirs


def check_radii(tally, name, molecule, least_share):
    options = rdFreeSASA.SASAOpts()
    options.classifier = rdFreeSASA.Protor
    reference = rdFreeSASA.classifyAtoms(molecule.rdkit, options)
    if reference is None:
        raise Failure(f"{name}: FreeSASA classifies nothing")
    compared = 0
    for row, radius in zip(molecule.rows, reference):
        atom = row["residue"], row["atom"]
        if radius > 0 and atom not in MEANT and ("*", atom[1]) not in MEANT:
            compared += 1
            tally.compare("radii", f"{name} {row['residue']} {row['atom']}", float(row["radius"]), radius, 0.005)
    if compared < least_share * len(molecule.rows):
        raise Failure(f"{name}: only {compared} of {len(molecule.rows)} radii can be compared")


def check_all_atom_radii(tally, name, molecule):
    table = Chem.GetPeriodicTable()
    for row in molecule.rows:
        tally.compare(
            "all-atom radii", f"{name} {row['atom']}", float(row["radius"]), table.GetRvdw(row["element"]), 0.16
        )


def grid_of(positions, radii, low, high, spacing):
    size = [float(x) for x in high - low]
    grid = rdGeometry.UniformGrid3D(
        *size, spacing, DataStructs.DiscreteValueType.ONEBITVALUE, rdGeometry.Point3D(*map(float, low))
    )
    for position, radius in zip(positions, radii):
        grid.SetSphereOccupancy(rdGeometry.Point3D(*map(float, position)), radius, 0.0, 0)
    return grid


def accessible(molecule, radii):
    options = rdFreeSASA.SASAOpts()
    options.algorithm = rdFreeSASA.ShrakeRupley
    return rdFreeSASA.CalcSASA(molecule, radii, opts=options)


def check_solid(tally, name, molecule, spoil=0.0):
    radii = [radius + spoil for radius in molecule.radii]
    volume, area = molecule.reported["volume"], molecule.reported["accessible_area"]
    lattice = rdMolDescriptors.DoubleCubicLatticeVolume(molecule.rdkit, radii, False, True, 1.4).GetVDWVolume()
    tally.compare("volume, lattice", name, volume, lattice, 0.008 * lattice)
    low, high = molecule.positions.min(0) - 3, molecule.positions.max(0) + 3
    spacing = 0.2 if len(radii) >= 100 else 0.1
    # The vector lives in its grid, which must be held.
    grid = grid_of(molecule.positions, radii, low, high, spacing)
    counted = grid.GetOccupancyVect().GetTotalVal() * spacing**3
    tally.compare("volume, grid", name, volume, counted, 0.002 * counted)
    reference = accessible(molecule.rdkit, radii)
    tally.compare("accessible", name, area, reference, (0.012 if len(radii) >= 100 else 0.025) * reference)


def with_positions(molecule, positions):
    copy = Chem.Mol(molecule)
    conformer = copy.GetConformer()
    for index, position in enumerate(positions):
        conformer.SetAtomPosition(index, rdGeometry.Point3D(*map(float, position)))
    return copy


def rotation_of(quaternion):
    w, x, y, z = np.array(quaternion) / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def check_pair(tally, knotdock, name, receptor, ligand, quaternion, translation, spoil=0.0, own_radii=False):
    """One placed pair; `spoil` in Å moves RDKit's ligand away from ours."""
    unit = np.array(quaternion) / np.linalg.norm(quaternion)
    pose = ",".join(f"{x:.12f}" for x in [*unit, *translation])
    # What is compared does not depend on the resolution; the fewest modes are the quickest.
    few = ["--effects", "shape", "--resolution", "20"]
    scored = [receptor.path, ligand.path, "--pose", pose, *few, *receptor.options]
    reported = run(knotdock, "score", *scored)["geometry"]
    placed = ligand.placed(rotation_of(unit), np.array(translation)) + spoil
    moved = with_positions(ligand.rdkit, placed)
    together = Chem.CombineMols(receptor.rdkit, moved)
    alone = accessible(receptor.rdkit, receptor.radii) + accessible(moved, ligand.radii)
    buried = alone - accessible(together, receptor.radii + ligand.radii)
    tally.compare("buried", name, reported["buried_area"], buried, max(0.015 * buried, 8.0))
    both = np.vstack([receptor.positions, placed])
    low, high = both.min(0) - 3, both.max(0) + 3
    grids = [
        grid_of(positions, radii, low, high, 0.2)
        for positions, radii in ((receptor.positions, receptor.radii), (placed, ligand.radii))
    ]
    tally.compare("Tanimoto", name, 1 - reported["shape_tanimoto"], rdGeometry.TanimotoDistance(*grids), 0.004)
    smaller_first = sorted(grids, key=lambda grid: grid.GetOccupancyVect().GetTotalVal())
    tally.compare("protrusion", name, reported["protrusion"], rdGeometry.ProtrudeDistance(*smaller_first), 0.004)
    if own_radii:
        options = dict(
            gridSpacing=0.2,
            bitsPerPoint=DataStructs.DiscreteValueType.ONEBITVALUE,
            vdwScale=1.0,
            stepSize=0.0,
            maxLayers=0,
            ignoreHs=False,
        )
        shape = rdShapeHelpers.ShapeTanimotoDist(receptor.rdkit, moved, **options)
        tally.compare("ShapeTanimotoDist", name, 1 - reported["shape_tanimoto"], shape, 0.05)
        shape = rdShapeHelpers.ShapeProtrudeDist(receptor.rdkit, moved, allowReordering=True, **options)
        tally.compare("ShapeProtrudeDist", name, reported["protrusion"], shape, 0.05)


def build(scratch):
    """Files of molecules that RDKit builds: name to path."""
    made = {}
    peptide = Chem.AddHs(Chem.MolFromSequence("ACDEFGHIKLMNPQRSTVWY"), addResidueInfo=True)
    if AllChem.EmbedMolecule(peptide, randomSeed=7, useRandomCoords=True) != 0:
        raise Failure("RDKit cannot embed the peptide")
    made["peptide"] = scratch / "peptide.pdb"
    Chem.MolToPDBFile(peptide, str(made["peptide"]))
    for name, smiles in SMALL.items():
        molecule = Chem.AddHs(Chem.MolFromSmiles(smiles))
        if AllChem.EmbedMolecule(molecule, randomSeed=7) != 0:
            raise Failure(f"RDKit cannot embed {name}")
        made[name] = scratch / f"{name}.pdb"
        Chem.MolToPDBFile(molecule, str(made[name]))
    return made


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("knotdock")
    parser.add_argument("examples", type=Path)
    options = parser.parse_args()
    tally = Tally()
    try:
        with tempfile.TemporaryDirectory() as folder:
            scratch = Path(folder)

            def read(path, *extra):
                return Molecule(options.knotdock, path, scratch, extra)

            example = {
                name: read(options.examples / f"1ppe_{name}.pdb")
                for name in ("receptor_unbound", "ligand_unbound", "receptor_bound", "ligand_bound")
            }
            paths = build(scratch)
            built = {name: read(path) for name, path in paths.items()}
            hydrogens = {f"{name} with hydrogens": read(path, "--hydrogens", "keep") for name, path in paths.items()}
            for name, molecule in {**example, **built, **hydrogens}.items():
                if not check_atoms(tally, name, molecule):
                    continue
                check_solid(tally, name, molecule)
            for name, molecule in {**example, "peptide": built["peptide"]}.items():
                check_radii(tally, name, molecule, 0.9)
            for name, molecule in hydrogens.items():
                check_all_atom_radii(tally, name, molecule)
            receptor, ligand = example["receptor_unbound"], example["ligand_unbound"]
            middle = ligand.positions.mean(0)
            turned = (0.97, 0.1, -0.2, 0.1)
            stay = middle - rotation_of(turned) @ middle

            def pair(*arguments, **extra):
                return check_pair(tally, options.knotdock, *arguments, **extra)

            pair("example as it stands", receptor, ligand, (1, 0, 0, 0), (0, 0, 0))
            pair("example turned in place", receptor, ligand, turned, stay)
            pair("bound example", example["receptor_bound"], example["ligand_bound"], (1, 0, 0, 0), (0, 0, 0))
            pair("example in the middle", receptor, ligand, (1, 0, 0, 0), receptor.positions.mean(0) - middle)
            pair("peptide beside itself", built["peptide"], built["peptide"], (1, 0, 0, 0), (2.0, 1.0, -1.0))
            for name, molecule in hydrogens.items():
                pair(name, molecule, molecule, (0.9, 0.3, 0.1, 0.2), (0.8, -0.5, 0.4), own_radii=True)
            print(
                f"RDKit {Chem.rdBase.rdkitVersion}: {tally.made} comparisons, {tally.failed} failed; "
                "the worst as a share of its tolerance: "
                + ", ".join(f"{kind} {share:.2f}" for kind, share in tally.worst.items())
            )
            # The checks must be able to fail.
            print("Spoilt on purpose, so that each kind must drift:")
            spoilt = Tally()
            check_solid(spoilt, "example, radii 0.2 Å larger", ligand, spoil=0.2)
            check_pair(
                spoilt,
                options.knotdock,
                "example moved by 0.5 Å an axis",
                receptor,
                ligand,
                (1, 0, 0, 0),
                (0, 0, 0),
                spoil=0.5,
            )
            caffeine = hydrogens["caffeine with hydrogens"]
            # A protein's accessible area hardly grows with its radii, for its crevices close; a small molecule's does.
            check_solid(spoilt, "caffeine, radii 0.2 Å larger", caffeine, spoil=0.2)
            check_pair(
                spoilt,
                options.knotdock,
                "caffeine moved by 0.5 Å an axis",
                caffeine,
                caffeine,
                (1, 0, 0, 0),
                (0.8, -0.5, 0.4),
                spoil=0.5,
                own_radii=True,
            )
            for row in ligand.rows[:5]:
                row["radius"] = str(float(row["radius"]) + 0.02)
                row["atom"] += "X"
            check_radii(spoilt, "spoilt", ligand, 0.5)
            check_atoms(spoilt, "spoilt", ligand)
            deaf = {kind for kind, share in spoilt.worst.items() if share <= 1.0}
            if deaf:
                raise Failure(f"cannot fail: {', '.join(sorted(deaf))}")
    except Failure as failure:
        print(f"error: {failure}", file=sys.stderr)
        return 2
    return 1 if tally.failed else 0


if __name__ == "__main__":
    sys.exit(main())
