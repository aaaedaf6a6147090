"""Numbers that a run reports, beside plain sums: scores, gradients, sums of terms, and distances between poses."""

import csv
import math

from promises.plain_sums import placed, rotated, sums
from promises.scenes import write_inputs

ATOMS = ["N", "CA", "C", "O", "CB"]
DIGITS = 1e-8  # of the magnitudes that are added up


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def atom_line(serial, atom, residue, position, name="ALA", chain="A"):
    x, y, z = position
    return (f"ATOM  {serial:>5}  {atom:<3} {name:>3} {chain}{residue:>4}    {x:8.3f}{y:8.3f}{z:8.3f}"
            f"  1.00 10.00          {atom[0]:>2}\n")  # fmt: skip


def random_molecule(trial, name):
    """Writes some residues as a random walk of atoms in steps of 1.5 Å: radii like a molecule's, else at random."""
    place, text = [trial.random.uniform(-20, 20) for _ in range(3)], ""
    for number in range(trial.random.randint(1, 4) * 5):
        step = [trial.random.gauss(0, 1) for _ in range(3)]
        length = math.hypot(*step)
        place = [at + 1.5 * part / length for at, part in zip(place, step)]
        text += atom_line(number + 1, ATOMS[number % 5], number // 5 + 1, place)
    trial.make(name, text + "END\n")


def balls(trial, name):
    """The balls (x, y, z, radius) that the program makes of a structure."""
    table = name.replace(".pdb", ".csv")
    trial.run("inspect", name, "--atoms", table, may_fail=False)
    kept = [row for row in rows_of(trial.folder / table) if not row["dropped"]]
    return [tuple(float(row[column]) for column in ("x", "y", "z", "radius")) for row in kept]


def pose_of(row):
    numbers = [float(row[column]) for column in ("qw", "qx", "qy", "qz", "tx", "ty", "tz")]
    return numbers[:4], numbers[4:]


def docked_scores(trial):
    """Scores of poses.csv are the exact sum over pairs of balls, and its columns add up.

    Random small molecules are docked. Shape, its three slices and the unfiltered score of each row are summed again in
    Python and agree to 1e-8 of the magnitudes that are added up; search_score and pose_score are the sums of their
    terms, rows are in the order of score, and quaternions have length 1.
    """
    random_molecule(trial, "a.pdb")
    random_molecule(trial, "b.pdb")
    receptor, ligand = balls(trial, "a.pdb"), balls(trial, "b.pdb")
    options = ["--rotations", trial.random.choice([2, 4]), "--poses", "12", "--diagnostics"]
    options += trial.random.choice([["--no-cluster"], []]) + trial.random.choice([["--refine", "4"], []])
    call = trial.run("dock", "a.pdb", "b.pdb", *options, "-o", "run", may_fail=False)
    if call.code:
        return
    table, last = rows_of(trial.folder / "run/poses.csv"), math.inf
    trial.check(table, "no rows")
    for row in table:
        quaternion, translation = pose_of(row)
        trial.check(abs(math.hypot(*quaternion) - 1) < 1e-12, f"rank {row['rank']}: quaternion {quaternion}")
        expected, size = sums(receptor, placed(ligand, quaternion, translation))
        for column, value in expected.items():
            error = abs(float(row[column]) - value) / size
            trial.check(error < DIGITS, f"rank {row['rank']}, {column}: {row[column]}, summed {value} ({error:.1e})")
        add_up(trial, row)
        trial.check(float(row["score"]) <= last, f"rank {row['rank']} is above a better score")
        last = float(row["score"])


def add_up(trial, row):
    """Checks that the terms of a row add up to its scores, and that none is NaN or infinite."""
    value = {column: float(text) for column, text in row.items() if text not in ("", "true", "false")}
    trial.check(all(map(math.isfinite, value.values())), f"rank {row['rank']}: a number that is none")
    effects = ("shape", "electrostatics", "contact", "restraint")
    terms = (
        "fine_contact",
        "atom_pair",
        "relaxed",
        "active_residues",
        "unresolved",
        "termini",
        "other_copies",
        "sharp",
    )
    for total, parts in (("search_score", effects), ("pose_score", ("search_score", *terms))):
        added = [value.get(part, 0.0) for part in parts]
        size = max(1.0, *map(abs, added))
        is_sum = abs(value[total] - sum(added)) < 1e-9 * size
        trial.check(is_sum, f"rank {row['rank']}: {total} is {value[total]}, its parts add up to {sum(added)}")


def random_pose(trial, far):
    quaternion = [trial.random.gauss(0, 1) for _ in range(4)]
    length = math.copysign(math.hypot(*quaternion), quaternion[0])
    return [part / length for part in quaternion], [trial.random.uniform(-far, far) for _ in range(3)]


def gradients(trial):
    """`knotdock score` gives the exact score of a pose, and its force is the score's derivative.

    Random poses of random small molecules near contact; shape and the force (by central differences of the sum in
    Python) agree to 1e-8 and 1e-5 of the magnitudes that are added up.
    """
    random_molecule(trial, "a.pdb")
    random_molecule(trial, "b.pdb")
    receptor, ligand = balls(trial, "a.pdb"), balls(trial, "b.pdb")
    quaternion, _ = random_pose(trial, 0)
    turned = placed(ligand, quaternion, [0, 0, 0])
    # Two atoms at random are brought near each other.
    one, other = trial.random.choice(receptor), trial.random.choice(turned)
    translation = [one[k] - other[k] + trial.random.uniform(-4, 4) for k in range(3)]
    pose = ",".join(repr(number) for number in (*quaternion, *translation))
    words = ["score", "--json", "a.pdb", "b.pdb", f"--pose={pose}", "--effects", "shape", "--modes", "64"]
    found = trial.run(*words, may_fail=False).object()
    if not found or "exact" not in found:
        return
    expected, size = sums(receptor, placed(ligand, quaternion, translation))
    error = abs(found["exact"] - expected["shape"]) / size
    trial.check(error < DIGITS, f"exact: {found['exact']}, summed {expected['shape']} ({error:.1e})")
    step = 1e-4
    for axis in range(3):
        near = []
        for sign in (1, -1):
            moved = [at + sign * step * (k == axis) for k, at in enumerate(translation)]
            near.append(sums(receptor, placed(ligand, quaternion, moved))[0]["shape"])
        slope = (near[0] - near[1]) / (2 * step)
        error = abs(found["gradient"]["force"][axis] - slope) / size
        trial.check(error < 1e-5, f"force {found['gradient']['force']}, along {axis} {slope} ({error:.1e})")


def distances(trial):
    """The ligand RMSD of `evaluate` is that of its definition, and other measures keep within their bounds.

    Random poses beside a known complex in which the ligand is the smaller partner and is placed as in its file: the
    RMSD of its backbone is computed in Python. fnat, DockQ and the CAPRI class keep within their ranges.
    """
    write_inputs(trial.folder)
    poses = [([1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0])]
    poses += [random_pose(trial, trial.random.choice([0.5, 5, 50])) for _ in range(20)]
    rows = [",".join(map(repr, (rank, *q, *t))) for rank, (q, t) in enumerate(poses, 1)]
    trial.make("table.csv", "rank,qw,qx,qy,qz,tx,ty,tz\n" + "\n".join(rows) + "\n")
    words = ["evaluate", "table.csv", "--receptor", "receptor.pdb", "--ligand", "ligand.pdb"]
    found = trial.run(*words, "--native", "native.pdb", "--json", may_fail=False).object()
    if not found or "poses" not in found:
        return
    lines = (trial.folder / "ligand.pdb").read_text().splitlines()
    backbone = [[float(line[at : at + 8]) for at in (30, 38, 46)] for line in lines
                if line[12:16].strip() in ("N", "CA", "C", "O")]  # fmt: skip
    trial.check(len(found["poses"]) == len(poses), "not as many poses as rows")
    for (quaternion, translation), pose in zip(poses, found["poses"]):
        squares = 0.0
        for x in backbone:
            y = rotated(quaternion, x)
            squares += sum((y[k] + translation[k] - x[k]) ** 2 for k in range(3))
        rmsd = math.sqrt(squares / len(backbone))
        is_near = abs(pose["lrmsd"] - rmsd) < 1e-6 * (1 + rmsd)
        trial.check(is_near, f"rank {pose['rank']}: lrmsd {pose['lrmsd']}, by its definition {rmsd}")
        within = 0 <= pose["fnat"] <= 1 and 0 <= pose["dockq"] <= 1 and pose["irmsd"] >= 0
        trial.check(within and pose["irmsd"] <= 2 * rmsd + 1e-6 or rmsd > 0.5, f"rank {pose['rank']}: {pose}")
    trial.check(found["poses"][0]["capri"] == "high" and found["poses"][0]["dockq"] > 0.999, "the native is not high")
