#!/usr/bin/env python3
"""Checks of the module knotdock with HADDOCK3: python3 check.py RECEPTOR.pdb LIGAND.pdb, run by check.sh."""

import csv
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from Bio.PDB import PDBParser
from Bio.SVDSuperimposer import SVDSuperimposer

from haddock import log
from haddock.core.exceptions import ThirdPartyIntallationError
from haddock.libs.libontology import ModuleIO
from haddock.modules.sampling.knotdock import HaddockModule, find_program

MODELS, SELECTED, ROTATIONS = 5, 1, 100
# Coordinates of PDB files have three digits: two roundings, and a little.
ROUNDED = 0.0011


def ensure(holds: bool, problem: str) -> None:
    if not holds:
        sys.exit(f"check of the HADDOCK3 module failed: {problem}")


def atoms(path: Path) -> dict[tuple[str, str, str], np.ndarray]:
    """Coordinates in Å by chain, residue and atom, in the order of the file."""
    parser = PDBParser(PERMISSIVE=False, QUIET=True)
    found = {}
    for atom in parser.get_structure(path.stem, path).get_atoms():
        residue = atom.get_parent()
        found[residue.get_parent().id, "".join(map(str, residue.id[1:])).strip(), atom.id] = atom.coord
    return found


def largest_shift(ours: dict, theirs: dict) -> float:
    """Largest distance in Å between atoms of the same name; infinite if one of `theirs` is lacking."""
    if not theirs or not theirs.keys() <= ours.keys():
        return float("inf")
    return max(float(np.linalg.norm(ours[name] - theirs[name])) for name in theirs)


def outputs(step: Path) -> list:
    io = ModuleIO()
    io.load(step / "io.json")
    return io.output


def program(*arguments: object) -> None:
    subprocess.run([find_program(), *map(str, arguments), "--quiet"], check=True)


def module(topologies: Path, name: str, models: list) -> HaddockModule:
    """The module after a step of topologies with these models, in its own run folder, now the current folder."""
    run = topologies.parent.parent / name
    shutil.copytree(topologies, run / "0_topoaa")
    (run / "1_knotdock").mkdir()
    io = ModuleIO()
    io.add(models, "o")
    io.save(run / "0_topoaa")
    # HADDOCK3 looks for the step before from the folder of the run.
    os.chdir(run)
    step = HaddockModule(order=1, path=run / "1_knotdock")
    step.update_params(sampling=MODELS, rotations=ROTATIONS, ncores=2)
    return step


def workflow(folder: Path, receptor: Path, ligand: Path) -> Path:
    """Run of HADDOCK3's own command, from topologies to energy minimisation of the best model; returns its folder."""
    for molecule in (receptor, ligand):
        shutil.copy(molecule, folder)
    (folder / "workflow.toml").write_text(
        f'run_dir = "run"\nncores = 2\nclean = false\npostprocess = false\n'
        f'molecules = ["{receptor.name}", "{ligand.name}"]\n[topoaa]\n'
        f"[knotdock]\nsampling = {MODELS}\nrotations = {ROTATIONS}\n[seletop]\nselect = {SELECTED}\n[emref]\n"
    )
    command = [sys.executable, "-m", "haddock.clis.cli", "workflow.toml"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    ensure(done.returncode == 0, f"the workflow ended with {done.returncode}\n{done.stdout}{done.stderr}")
    run = folder / "run"

    # The same run by the program itself, on the molecules as topoaa left them.
    receptor, ligand = (
        Path(model.path, model.file_name) for each in outputs(run / "0_topoaa") for model in each.values()
    )
    alone = folder / "alone"
    program("dock", receptor, ligand, "-o", alone, "--rotations", ROTATIONS, "--write-top", 0, "--no-report")
    program("export", alone, "--rank", f"1-{MODELS}", "--raw")
    with open(alone / "poses.csv") as file:
        expected = [-float(row["score"]) for row in csv.DictReader(file)][:MODELS]

    models = outputs(run / "1_knotdock")
    ensure(len(models) == MODELS, f"{len(models)} models instead of {MODELS}")
    scores = [model.score for model in models]
    ensure(scores == expected, f"scores {scores}, those of the program with the other sign are {expected}")
    ensure(scores == sorted(scores), f"scores are not in order: {scores}")
    input_atoms = atoms(receptor) | atoms(ligand)
    for rank, model in enumerate(models, start=1):
        path = run / "1_knotdock" / model.file_name
        written = atoms(path)
        ensure(list(written) == list(input_atoms), f"{path} has not the atoms of the two molecules in their order")
        ensure({name[0] for name in written} == {"A", "B"}, f"chains of {path} are not A and B")
        for number, line in enumerate(path.read_text().splitlines()[:-1], start=1):
            ensure(line[21] == line[72:76].strip(), f"segid is not the chain ID: {line}")
            ensure(int(line[6:11]) == number, f"serials do not count up: {line}")
        exported = atoms(alone / "top" / f"rank_{rank:04}.pdb")
        shift = largest_shift(written, exported)
        ensure(shift < ROUNDED, f"{path} is {shift} Å from the complex that knotdock exports")
        fixed = largest_shift(written, atoms(receptor))
        ensure(fixed == 0, f"the receptor of {path} has moved by {fixed} Å")
        topologies = [Path(topology.path, topology.file_name) for topology in model.topology]
        ensure(len(topologies) == 2 and all(map(Path.is_file, topologies)), f"topologies of {path}: {topologies}")

    # CNS reads the models and finds every atom: but for a motion of the whole they hardly move, and clashes go.
    minimised = outputs(run / "3_emref")
    ensure(len(minimised) == SELECTED, f"{len(minimised)} minimised models instead of {SELECTED}")
    for model, before in zip(minimised, models):
        after = atoms(run / "3_emref" / model.file_name)
        names = [name for name in input_atoms if name[2] == "CA"]
        start = atoms(run / "1_knotdock" / before.file_name)
        superposed = SVDSuperimposer()
        superposed.set(np.array([start[name] for name in names]), np.array([after[name] for name in names]))
        superposed.run()
        rmsd = superposed.get_rms()
        ensure(rmsd < 1, f"CA atoms of {model.file_name} moved by {rmsd} Å in energy minimisation")
        ensure(model.unw_energies["vdw"] < 0, f"{model.file_name} has a van der Waals energy of {model.unw_energies}")
    return run


def restraints(topologies: Path, pair: list, unrestrained: Path) -> None:
    """Restraints of both parameters reach the program: CA atoms that were apart come within the bound."""
    bound = 10.0
    ends = [(245, 15), (125, 1)]
    files = [topologies.parent.parent / f"restraint_{one}_{two}.tbl" for one, two in ends]
    for file, (one, two) in zip(files, ends):
        selections = f"(segid A and resid {one} and name CA) (segid B and resid {two} and name CA)"
        file.write_text(f"assign {selections} {bound} {bound} 0.0\n")

    def distances(path: Path) -> list[float]:
        placed = atoms(path)
        return [float(np.linalg.norm(placed["A", str(one), "CA"] - placed["B", str(two), "CA"])) for one, two in ends]

    ensure(min(distances(unrestrained)) > 2 * bound, "the best pose satisfies a restraint without it")
    for name, params, held in (
        ("ambig", {"ambig_fname": files[0]}, lambda one, two: one <= bound),
        ("unambig", {"unambig_fname": files[1]}, lambda one, two: two <= bound),
        (
            "one_of_both",
            {"ambig_fname": files[0], "unambig_fname": files[1], "restraints_need": "1"},
            lambda one, two: min(one, two) <= bound < max(one, two),
        ),
    ):
        step = module(topologies, name, pair)
        step.run(**params)
        best = distances(step.path / outputs(step.path)[0].file_name)
        ensure(held(*best), f"restraints {name}: CA atoms at {best} Å, bound {bound} Å")
        # A restraint that is not needed costs nothing.
        with open(step.path / "run_1" / "poses.csv") as file:
            penalty = float(next(csv.DictReader(file))["restraints_penalty"])
        ensure(penalty == 0, f"restraints {name}: the best pose has a penalty of {penalty}")


def ensemble(topologies: Path, pair: list) -> None:
    """Models of all combinations are ranked together, each with its own coordinates."""
    receptor, ligand = (next(iter(each.values())) for each in pair)
    step = module(topologies, "ensemble", [{"0": receptor}, {"0": ligand, "1": ligand}])
    step.run()
    models = outputs(step.path)
    scores = [model.score for model in models]
    ensure(scores == sorted(scores), f"scores of an ensemble are not in order: {scores}")
    # Equal models have equal poses.
    ensure(scores[0::2][: MODELS // 2] == scores[1::2], f"scores of two equal models differ: {scores}")
    first, second = (Path(step.path, model.file_name).read_bytes() for model in models[:2])
    ensure(first == second, "two equal models are placed differently")


def errors(topologies: Path, pair: list) -> None:
    """Errors say what is wrong and what to do."""
    receptor, ligand = (next(iter(each.values())) for each in pair)
    wrong = topologies.parent.parent / "wrong.tbl"
    wrong.write_text("assign (segid A and resid 57) (segid B and resid 999) 8.0 8.0 0.0\n")
    archive = wrong.with_suffix(".tbl.tgz")
    archive.touch()
    for name, models, params, message in (
        ("same_chain", [{"0": receptor}, {"0": receptor}], {}, "share a chain ID"),
        ("one_molecule", [{"0": receptor}], {}, "docks two molecules"),
        ("complexes", [receptor], {}, "place [knotdock] directly after [topoaa]"),
        ("wrong_residue", pair, {"ambig_fname": wrong}, "999"),
        ("archive", pair, {"ambig_fname": archive}, "unpack wrong.tbl.tgz"),
        ("wrong_active", pair, {"active_ligand": "Q:1"}, "Remedy: "),
        ("wrong_site", pair, {"site_receptor": "Q:1"}, "Remedy: "),
    ):
        step = module(topologies, name, models)
        try:
            step.run(**params)
        except RuntimeError as error:
            ensure(message in str(error), f"{name}: {error}")
        else:
            ensure(False, f"{name}: there was no error")
    HaddockModule.confirm_installation()
    path, executable = os.environ["PATH"], sys.executable
    os.environ["PATH"], sys.executable = "", "/nowhere/python"
    try:
        HaddockModule.confirm_installation()
    except ThirdPartyIntallationError as error:
        ensure("Install knotdock" in str(error), f"a missing program is reported as: {error}")
    else:
        ensure(False, "a missing program is not reported")
    finally:
        os.environ["PATH"], sys.executable = path, executable


def main() -> None:
    receptor, ligand = (Path(argument).resolve() for argument in sys.argv[1:3])
    log.setLevel("CRITICAL")
    with tempfile.TemporaryDirectory() as folder:
        run = workflow(Path(folder), receptor, ligand)
        topologies = run / "0_topoaa"
        pair = outputs(topologies)
        restraints(topologies, pair, run / "1_knotdock" / "knotdock_1.pdb")
        ensemble(topologies, pair)
        errors(topologies, pair)
    print(f"HADDOCK3 module: {MODELS} models as knotdock has them, minimised by CNS; restraints, ensembles, errors.")


main()
