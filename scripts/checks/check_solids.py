#!/usr/bin/env python3
"""Checks `knotdock collide` against exact mesh libraries: coal and Manifold (PyPI coal, manifold3d, trimesh).

    python scripts/checks/check_solids.py target/release/knotdock structures/examples/bunny.obj --poses 1000

Needs coal, manifold3d, numpy and trimesh (requirements_solids.txt) in the running Python. Four pairs of meshes are
asked about at random poses (fixed seeds), half of them near contact, within holes too: box and ball, bunny and bracket,
torus and rod, hollow box and cross (exact_solids.py). First both libraries are held to closed forms of boxes and balls,
knotdock apart. What is compared:

    verdict     a hit shares volume with the other or its surface meets it, containment included; a free pose does not;
                no pose is undecided, since triangles decide
    distance    of solids that are apart is distance_low and distance_high; distance_low is no more than zero where they
                meet
    volume      that both share is within overlap_volume_bound of overlap_volume
    force       at every fifth pose, is minus the slope of the shared volume

At the end each comparison is made again with a figure spoilt on purpose, which must fail.
Exit code 0: nothing contradicts; 1: something does; 2: the check could not be made.
"""

import argparse
import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from exact_solids import pairs, prove, quaternion

# coal's distances of triangles and Manifold's volumes are good to this share of the size.
TOLERANCE = 1e-6
# Slopes by differences are good to this share of the square of the size.
SLOPES = 2e-4


class Failure(Exception):
    """The check could not be made."""


def answers(program, pair, poses, folder, options):
    """knotdock's rows at the poses."""
    files = [folder / "a.obj", folder / "b.obj"]
    for file, mesh in zip(files, pair.meshes):
        lines = [f"v {x!r} {y!r} {z!r}\n" for x, y, z in mesh.vertices.tolist()]
        lines += [f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in mesh.faces.tolist()]
        file.write_text("".join(lines))
    with open(folder / "poses.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["qw", "qx", "qy", "qz", "tx", "ty", "tz"])
        table.writerows([*map(repr, map(float, [*quaternion(turn), *move]))] for turn, move in poses)
    command = [
        program,
        "collide",
        *files,
        "--poses",
        folder / "poses.csv",
        "-o",
        folder / "rows.csv",
        "--force",
        "--json",
    ]
    done = subprocess.run([*map(str, command), *options], capture_output=True, text=True)
    if done.returncode:
        raise Failure(f"knotdock collide failed: {done.stdout}{done.stderr}")
    with open(folder / "rows.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    if len(rows) != len(poses):
        raise Failure(f"{len(rows)} rows of {len(poses)} poses")
    band = json.loads(done.stdout)["undecided_band"]
    if band != 0:
        raise Failure(f"triangles do not decide: the undecided band is {band}")
    return rows


def contradictions(row, exact, force, size):
    """Entries of a row that the exact answer contradicts."""
    near = TOLERANCE * size
    verdict, low, high = row["verdict"], float(row["distance_low"]), float(row["distance_high"])
    # What touches by less than rounding is nobody's fault.
    grazing = exact.distance < near and exact.volume < 1e-12 * size**3
    if verdict not in ("hit", "free", "undecided"):
        raise Failure(f"an unknown verdict: {verdict}")
    found = []
    if not grazing and verdict != ("hit" if exact.hit else "free"):
        found.append("verdict")
    if exact.hit:
        if low > near:
            found.append("distance")
    elif not low - near <= exact.distance <= high + near or high - low > near:
        found.append("distance")
    volume, bound = float(row["overlap_volume"]), float(row["overlap_volume_bound"])
    if abs(volume - exact.volume) > bound + TOLERANCE * size**3:
        found.append("volume")
    if force is not None:
        off = np.linalg.norm([float(row[f"force_{axis}"]) for axis in "xyz"] - force)
        if off > SLOPES * size**2:
            found.append("force")
    return found


def spoilt(rows, exacts, forces, size):
    """The comparisons again, each with a figure moved; those that stay unnoticed."""
    wrong = {"verdict": {"hit": "free", "free": "hit"}}
    noticed = set()
    for row, exact, force in zip(rows, exacts, forces):
        for kind, changed in (
            ("verdict", row | {"verdict": wrong["verdict"].get(row["verdict"], row["verdict"])}),
            ("distance", row | {name: str(float(row[name]) + size) for name in ("distance_low", "distance_high")}),
            ("volume", row | {"overlap_volume": str(float(row["overlap_volume"]) + size**3)}),
            ("force", row | {"force_y": str(float(row["force_y"]) + 0.01 * size**2)}),
        ):
            if kind in contradictions(changed, exact, force, size):
                noticed.add(kind)
    return {"verdict", "distance", "volume", "force"} - noticed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("bunny", type=Path)
    parser.add_argument("--poses", type=int, default=1000, help="poses of each pair")
    parser.add_argument("--option", action="append", default=[], help="a further option of knotdock collide")
    options = parser.parse_args()
    prove(np.random.default_rng(20160100))
    print("coal and Manifold agree with closed forms of boxes and balls")
    failed = 0
    for pair in pairs(options.bunny):
        poses = pair.poses(options.poses, np.random.default_rng(20160115))
        exacts = [pair.exact(*pose) for pose in poses]
        forces = [None if number % 5 else pair.force(*pose) for number, pose in enumerate(poses)]
        with tempfile.TemporaryDirectory() as folder:
            rows = answers(options.program, pair, poses, Path(folder), options.option)
        wrong = [contradictions(*each, pair.size) for each in zip(rows, exacts, forces)]
        for number, (kinds, row, exact) in enumerate(zip(wrong, rows, exacts), 1):
            if kinds:
                print(f"{pair.name}, pose {number}: {', '.join(kinds)} contradicted: {row} but {exact}")
        failed += sum(map(bool, wrong))
        verdicts = [row["verdict"] for row in rows]
        inside = sum(exact.hit and exact.distance > 0 for exact in exacts)
        print(
            f"{pair.name}: {len(rows)} poses, {sum(exact.hit for exact in exacts)} meet ({inside} by containment); "
            + "knotdock: "
            + ", ".join(f"{verdicts.count(verdict)} {verdict}" for verdict in ("hit", "free", "undecided"))
        )
        unnoticed = spoilt(rows, exacts, forces, pair.size)
        if unnoticed:
            raise Failure(f"{pair.name}: spoilt figures passed: {', '.join(sorted(unnoticed))}")
    return 1 if failed else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (Failure, OSError, AssertionError) as error:
        print(f"the check could not be made: {error}", file=sys.stderr)
        sys.exit(2)
