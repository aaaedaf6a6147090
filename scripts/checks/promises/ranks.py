"""Ranks and scores do not hang on rounding, on the frame of a file, or on which partner is called the receptor."""

import csv
import itertools
import json
import math

from promises.scenes import CASES, EXAMPLES

# All 24 rotations by right angles: they move coordinates of three decimals without rounding.
RIGHT_ANGLES = [
    [[sign[row] if order[row] == column else 0 for column in range(3)] for row in range(3)]
    for order in itertools.permutations(range(3))
    for sign in itertools.product((1, -1), repeat=3)
    if sign[0] * sign[1] * sign[2] * (1 if order in ((0, 1, 2), (1, 2, 0), (2, 0, 1)) else -1) == 1
]


def times(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def transposed(a):
    return [list(column) for column in zip(*a)]


def applied(a, x):
    return [sum(a[i][k] * x[k] for k in range(3)) for i in range(3)]


def moved_text(text, change):
    """PDB text with each position changed."""
    lines = []
    for line in text.splitlines(keepends=True):
        if line.startswith(("ATOM", "HETATM")):
            x = change([float(line[at : at + 8]) for at in (30, 38, 46)])
            line = line[:30] + "".join(f"{part:8.3f}" for part in x) + line[54:]
        lines.append(line)
    return "".join(lines)


def rows_and_tie(trial, folder):
    """Rows of a run, and how close scores tie: the worst error of the fast path that the run reports."""
    with open(trial.folder / folder / "poses.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    record = json.loads((trial.folder / folder / "run.json").read_bytes())
    return rows, record["error"]["worst"] * max(float(row["score"]) for row in rows)


def is_same_pose(one, other):
    """Whether two rows come from the same rotation and the same point of the grid."""
    places = [[float(row[axis]) for axis in ("tx", "ty", "tz")] for row in (one, other)]
    return one["rotation"] == other["rotation"] and math.dist(*places) < 0.5


def noise(trial):
    """Noise of 0.001 Å on all atoms leaves the first ten rows of a run in place, but for ties.

    The example pair (1PPE), its ligand turned by right angles, with and without noise on the last digit of each
    coordinate. Two scores tie if they are closer than the worst error of the fast path that the run reports (0.3 to
    0.5% of the best score). No score of the first ten moves by more than 0.5% of the best.
    """
    turn = trial.random.choice(RIGHT_ANGLES)
    texts = [(EXAMPLES / f"1ppe_{side}_unbound.pdb").read_text() for side in ("receptor", "ligand")]
    texts[1] = moved_text(texts[1], lambda x: applied(turn, x))
    options = ["--rotations", trial.random.choice([100, 150]), "--diagnostics", "--write-top", "1"]
    options += trial.random.choice([[], ["--no-cluster"]])
    for name, size in (("exact", 0), ("noisy", 1)):
        for side, text in zip("ab", texts):
            change = (lambda x: [part + trial.random.choice([-0.001, 0, 0.001]) for part in x]) if size else list
            trial.make(f"{side}_{name}.pdb", moved_text(text, change))
        call = trial.run("dock", f"a_{name}.pdb", f"b_{name}.pdb", *options, "-o", name, may_fail=False)
        if call.code:
            return
    (before, tie), (after, _) = rows_and_tie(trial, "exact"), rows_and_tie(trial, "noisy")
    compare_ranks(trial, before, after, tie)


MOVE = 0.005  # share of the best score by which noise may move one


def compare_ranks(trial, before, after, tie):
    """Compares the first ten rows of two runs."""
    best, tenth = float(before[0]["score"]), float(after[min(9, len(after) - 1)]["score"])
    matched = []
    for row in before[:10]:
        score = float(row["score"])
        place = next((place for place, other in enumerate(after) if is_same_pose(row, other)), None)
        if place is None:
            # Another pose of the cluster may take its place if the two tie.
            near = min(abs(float(other["score"]) - score) for other in after)
            trial.check(near <= tie, f"rank {row['rank']} ({score:.1f}) is gone; a tie is {tie:.1f}")
            continue
        found = float(after[place]["score"])
        share = abs(found - score) / best
        trial.check(share <= MOVE, f"rank {row['rank']}: {score:.1f} became {found:.1f} ({share:.2%} of the best)")
        fell = place >= 10 and tenth - found > tie
        trial.check(not fell, f"rank {row['rank']} ({score:.1f}) is rank {place + 1} of {found:.1f} with noise")
        matched.append((score, place))
    for (one, first), (other, second) in itertools.combinations(matched, 2):
        is_kept = first < second or abs(one - other) <= tie
        trial.check(is_kept, f"{one:.1f} and {other:.1f} changed places; a tie is {tie:.1f}")


def matrix(quaternion):
    w, x, y, z = quaternion
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]


def quaternion(m):
    """The unit quaternion of a rotation matrix, by its largest part (Shepperd)."""
    squares = [1 + m[0][0] + m[1][1] + m[2][2], 1 + m[0][0] - m[1][1] - m[2][2],
               1 - m[0][0] + m[1][1] - m[2][2], 1 - m[0][0] - m[1][1] + m[2][2]]  # fmt: skip
    products = [
        [None, m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]],
        [m[2][1] - m[1][2], None, m[1][0] + m[0][1], m[0][2] + m[2][0]],
        [m[0][2] - m[2][0], m[1][0] + m[0][1], None, m[2][1] + m[1][2]],
        [m[1][0] - m[0][1], m[0][2] + m[2][0], m[2][1] + m[1][2], None],
    ]
    best = squares.index(max(squares))
    parts = [squares[best] if part is None else part for part in products[best]]
    length = math.hypot(*parts)
    return [part / length for part in parts]


def scores(trial, receptor, ligand, rotation, translation):
    """Terms of a pose, as `knotdock score` gives them."""
    pose = ",".join(repr(number) for number in (*quaternion(rotation), *translation))
    words = ["score", "--json", receptor, ligand, f"--pose={pose}", *COARSE]
    found = trial.run(*words, may_fail=False).object()
    if not found or "terms" not in found:
        return {}
    names = ("fine_contact", "atom_pair", "relaxed", "active_residues", "unresolved", "termini", "pose_score")
    return {**found["terms"], **{name: found[name] for name in names if found[name] is not None}}


# Shares of the largest term: of plain sums, and of the pose's energy at rest, which is found by descent.
PLAIN, AT_REST = 1e-9, 1e-3
COARSE = ["--resolution", "12", "--pass-length", "24"]  # `score` then times fewer modes


def frames(trial):
    """Terms of a pose do not depend on the frames of the files, nor on which partner is called the receptor.

    A pose of a run of small proteins is scored again with both files turned by right angles and shifted, and with
    receptor and ligand exchanged. Plain terms agree to 1e-9 of the largest, relaxed to 1e-3.
    """
    case = trial.random.choice(["helices", "charged_helices"])
    texts = [(CASES / f"{case}_{side}.pdb").read_text() for side in ("receptor", "ligand")]
    for name, text in zip(("a.pdb", "b.pdb"), texts):
        trial.make(name, text)
    words = ["dock", "a.pdb", "b.pdb", "--rotations", "12", "--no-cluster", "--write-top", "0", "-o", "run"]
    trial.run(*words, *COARSE, may_fail=False)
    with open(trial.folder / "run/poses.csv", newline="") as file:
        row = trial.random.choice(list(csv.DictReader(file))[:12])
    rotation = matrix([float(row[name]) for name in ("qw", "qx", "qy", "qz")])
    translation = [float(row[name]) for name in ("tx", "ty", "tz")]
    turns = [trial.random.choice(RIGHT_ANGLES) for _ in range(2)]
    shifts = [[float(trial.random.randint(-40, 40)) for _ in range(3)] for _ in range(2)]
    for name, text, turn, shift in zip(("c.pdb", "d.pdb"), texts, turns, shifts):
        trial.make(name, moved_text(text, lambda x, m=turn, t=shift: [a + b for a, b in zip(applied(m, x), t)]))
    # A ligand atom x goes to y = R x + t. Moved files: x' = M x + s, y' = N y + u.
    turned = times(times(turns[0], rotation), transposed(turns[1]))
    away = [a + b - c for a, b, c in zip(applied(turns[0], translation), shifts[0], applied(turned, shifts[1]))]
    back = transposed(rotation)
    here = scores(trial, "a.pdb", "b.pdb", rotation, translation)
    others = {
        "moved": scores(trial, "c.pdb", "d.pdb", turned, away),
        "exchanged": scores(trial, "b.pdb", "a.pdb", back, [-part for part in applied(back, translation)]),
    }
    size = max(map(abs, here.values()), default=1.0)
    for what, there in others.items():
        for name, value in here.items():
            allowed = AT_REST if name in ("relaxed", "pose_score") else PLAIN
            error = abs(there.get(name, math.inf) - value) / size
            trial.check(error <= allowed, f"{what}: {name} {value} became {there.get(name)} ({error:.1e})")
