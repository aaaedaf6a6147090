#!/usr/bin/env python3
"""Docks pairs of solid parts that fit together, and says at which rank the right pose is.

    cargo run -p knotdock-structures --example make_docking_parts -- target/parts
    python scripts/benchmark/assemblies.py target/release/knotdock target/parts [--pairs NAME ...] [-- OPTION ...]

Needs manifold3d and numpy (scripts/checks/requirements_solids.txt). Eleven pairs are made here, in millimetres, with a
clearance of 1.5 but for two wavy blocks; five come from the example. Each ligand is rotated and moved away, then docked
with the program's defaults and the options given after `--`. A pose is right if it is within a tenth of the ligand's
longest edge and 10 degrees of the known one, modulo the symmetries of both parts. Columns: rank of the first right row
and how far off it is, the best wrong row's share of its score, rows, balls, gap, and CPU seconds of the run.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from manifold3d import CrossSection, JoinType, Manifold

CLEARANCE = 1.5


def rotation(quaternion):
    """The matrix of a quaternion (w, x, y, z)."""
    w, x, y, z = np.asarray(quaternion, float) / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def motion(matrix, shift=(0, 0, 0)):
    """A rigid motion as a matrix of 4 x 4."""
    whole = np.eye(4)
    whole[:3, :3], whole[:3, 3] = matrix, shift
    return whole


def half_turn(direction, point=(0, 0, 0)):
    """Half a turn about an axis."""
    turn = rotation([0, *direction])
    return motion(turn, np.asarray(point) - turn @ point)


@dataclass
class Pair:
    """Two parts where they fit: vertices and triangles of each, and the motions that map each onto itself."""

    name: str
    receptor: tuple
    ligand: tuple
    clearance: float = CLEARANCE
    receptor_symmetry: list = field(default_factory=list)
    ligand_symmetry: list = field(default_factory=list)
    away: np.ndarray = field(default_factory=lambda: motion(rotation([0.4, 0.5, -0.6, 0.35]), [80, -50, 40]))


def mesh(solid):
    made = solid.to_mesh()
    return np.asarray(made.vert_properties[:, :3], float), np.asarray(made.tri_verts)


def box(low, high):
    low, high = np.asarray(low, float), np.asarray(high, float)
    return Manifold.cube(high - low).translate(low)


def above(height, size, steps=64):
    """All points of a large block that are above a height over (x, y)."""
    sheet = Manifold.cube([2 * size, 2 * size, size], True).refine_to_length(2 * size / steps)

    def lift(points):
        points = np.array(points)
        points[:, 2] = np.where(points[:, 2] < 0, height(points[:, 0], points[:, 1]), size)
        return points

    # Only the lower face follows the height; the sides keep their corners.
    return sheet.warp_batch(lift)


def cut(body, height, clearance, size):
    """A body below and above a height over (x, y), with a gap."""

    def moved(by):
        def lifted(x, y, h=1e-3):
            slope = np.hypot(height(x + h, y) - height(x - h, y), height(x, y + h) - height(x, y - h)) / (2 * h)
            return height(x, y) + by * clearance * np.sqrt(1 + slope**2)

        return above(lifted, size)

    return mesh(body - moved(-0.5)), mesh(body ^ moved(0.5))


def wavy(name, size, height, clearance):
    half = np.asarray(size) / 2
    return Pair(name, *cut(box(-half, half), height, clearance, 1.5 * max(size)), clearance)


def box_and_lid():
    case = box([-20, -15, 0], [20, 15, 20]) - box([-16, -11, 4], [16, 11, 30])
    c = CLEARANCE
    lid = box([-20, -15, 20 + c], [20, 15, 24 + c]) + box([-16 + c, -11 + c, 10 + c], [16 - c, 11 - c, 22 + c])
    about_z = [half_turn([0, 0, 1])]
    return Pair("box_lid", mesh(case), mesh(lid), receptor_symmetry=about_z, ligand_symmetry=about_z)


def cross_peg():
    def cross(by, low, high):
        return box([-13 + by, -4 + by, low], [13 - by, 4 - by, high]) + box([-4 + by, -9 + by, low], [4 - by, 9 - by, high])

    block = box([-20, -20, -15], [20, 20, 15]) - cross(0, -6, 20)
    low, high = -6 + CLEARANCE, 26
    middle = [0, 0, 0.5 * (low + high)]
    turns = [half_turn(axis, middle) for axis in np.eye(3)]
    return Pair(
        "cross_peg",
        mesh(block),
        mesh(cross(CLEARANCE, low, high)),
        receptor_symmetry=[half_turn([0, 0, 1])],
        ligand_symmetry=turns,
    )


def jigsaw():
    left = CrossSection.square([25, 34]) + CrossSection.circle(5.5, 48).translate([31, 19])
    left = left + CrossSection.square([4, 6]).translate([24, 16]) - CrossSection.circle(4.5, 48).translate([0, 9])
    right = CrossSection.square([30, 34]).translate([24, 0]) - left.offset(CLEARANCE, JoinType.Round)
    right = right ^ CrossSection.square([60, 60]).translate([25 + CLEARANCE, -10])
    return Pair("jigsaw", mesh(left.extrude(22)), mesh(right.extrude(22)))


def ball_and_socket():
    def joint(by):
        ball = Manifold.sphere(12 + by, 64)
        pin = Manifold.cylinder(17 + by, 3.5 + by, -1, 48).rotate([0, 90, 0])
        fin = box([-2.5 - by, 0, -2.5 - by], [2.5 + by, 15 + by, 2.5 + by]).rotate([25, 0, 0])
        return ball + pin + fin

    socket = box([-22, -20, -18], [22, 20, 6]) - joint(CLEARANCE) - joint(CLEARANCE).translate([0, 0, 8])
    stem = Manifold.cylinder(26, 5, 5, 48) + box([-8, -6, 20], [10, 6, 28])
    return Pair("ball_socket", mesh(socket), mesh(joint(0) + stem))


def dovetail():
    tail = CrossSection([[[-9, -12], [3, -12], [7, 0], [-13, 0]]])
    lower = CrossSection.square([50, 14]).translate([-25, -26]) + tail
    upper = CrossSection.square([50, 24]).translate([-25, -12]) - lower.offset(CLEARANCE, JoinType.Round)
    return Pair("dovetail", mesh(lower.extrude(40)), mesh(upper.extrude(40)))


def vase():
    z = np.linspace(0, 60, 61)
    outer = 16 + 6 * np.sin(z / 11) - 3 * (z / 60) ** 2
    inner = (outer - 6.5)[z >= 6.5]
    profile = [[0, 0], *zip(outer, z), *reversed(list(zip(inner, z[z >= 6.5]))), [0, 6.5]]
    body = CrossSection([profile]).revolve(96).rotate([90, 0, 0])
    return Pair("vase", *cut(body, lambda x, y: 3 * np.sin(y / 5) + 2 * np.cos(x / 4), CLEARANCE, 100))


def gear():
    teeth = 12

    def outline(by):
        shape = CrossSection.circle(14 + by, 96)
        for i in range(1, teeth):
            tooth = CrossSection([[[12, -3.2 - by], [18 + by, -1.8 - by], [18 + by, 1.8 + by], [12, 3.2 + by]]])
            shape = shape + tooth.rotate(360 * i / teeth)
        return shape

    ring = (CrossSection.circle(26, 128) - outline(CLEARANCE)).extrude(12)
    wheel = (outline(0) - CrossSection.circle(4, 48)).extrude(12)
    flip = [half_turn([1, 0, 0], [0, 0, 6])]
    return Pair("gear", mesh(ring), mesh(wheel), receptor_symmetry=flip, ligand_symmetry=flip)


def bones():
    shaft = Manifold.cylinder(50, 12, 10, 64).translate([0, 0, -25])
    ends = Manifold.sphere(14, 64).scale([1, 0.8, 1]).translate([4, 0, 27]) + Manifold.sphere(15, 64).translate([-3, 2, -27])
    height = lambda x, y: 3 * np.sin(x / 3 + 0.5) + 2.5 * np.cos(y / 2.7) + 0.4 * x  # noqa: E731
    return Pair("bones", *cut(shaft + ends, height, CLEARANCE, 100))


def own_pairs():
    yield wavy("wavy", [60, 50, 40], lambda x, y: 4 * np.sin(x / 6 + 0.4) * np.cos(y / 8) + 3 * np.sin(y / 6), 3.4)
    yield wavy("wavy_close", [60, 50, 40], lambda x, y: 4 * np.sin(x / 6 + 0.4) * np.cos(y / 8) + 3 * np.sin(y / 6), 0.6)
    yield wavy("wavy_small", [40, 34, 30], lambda x, y: 5 * np.sin(x / 5) * np.cos(y / 6 + 0.5), CLEARANCE)
    yield box_and_lid()
    yield cross_peg()
    yield jigsaw()
    yield ball_and_socket()
    yield dovetail()
    yield vase()
    yield gear()
    yield bones()


def stl(path):
    """Vertices and triangles of a text STL file."""
    lines = (line.split() for line in path.read_text().splitlines())
    vertices = np.array([words[1:] for words in lines if words[:1] == ["vertex"]], float)
    return vertices, np.arange(len(vertices)).reshape(-1, 3)


def example_pairs(folder):
    """The pairs that the example wrote, whose ligands are away already."""
    for record in json.loads((folder / "parts.json").read_text()):
        name = record["name"]
        back = motion(rotation(record["pose"][:4]), record["pose"][4:])
        vertices, triangles = stl(folder / f"{name}_ligand.stl")
        vertices = vertices @ back[:3, :3].T + back[:3, 3]
        turns = {
            side: [half_turn(axis["direction"], axis["point"]) for axis in record[key]]
            for side, key in (("a", "receptor_half_turns"), ("b", "ligand_half_turns_before_the_move"))
        }
        yield Pair(
            name,
            stl(folder / f"{name}_receptor.stl"),
            (vertices, triangles),
            record["clearance"],
            turns["a"],
            turns["b"],
            np.linalg.inv(back),
        )


def write(path, part, by=np.eye(4)):
    vertices = part[0] @ by[:3, :3].T + by[:3, 3]
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in vertices]
    lines += [f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in part[1]]
    path.write_text("".join(lines))


def off(pair, pose):
    """Distance of the ligand's middle and angle from the nearest right pose."""
    middle = np.append(0.5 * (pair.ligand[0].min(0) + pair.ligand[0].max(0)), 1)
    together = pose @ pair.away
    best = (np.inf, np.inf)
    for a in [np.eye(4), *pair.receptor_symmetry]:
        for b in [np.eye(4), *pair.ligand_symmetry]:
            right = a @ b
            cosine = 0.5 * (np.trace(right[:3, :3].T @ together[:3, :3]) - 1)
            angle = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
            if angle < best[1]:
                best = (np.linalg.norm((together - right) @ middle), angle)
    return best


def dock(program, pair, folder, options):
    """The row of the table of one pair."""
    folder.mkdir(parents=True, exist_ok=True)
    write(folder / "a.obj", pair.receptor)
    write(folder / "b.obj", pair.ligand, pair.away)
    command = [program, "dock", folder / "a.obj", folder / "b.obj", "-o", folder / "run", "--force", "--write-top", 1]
    before = os.times()
    done = subprocess.run([*map(str, command), *options], capture_output=True, text=True)
    after = os.times()
    seconds = after.children_user + after.children_system - before.children_user - before.children_system
    if done.returncode:
        return f"| {pair.name} | failed: {done.stderr.strip()} |"
    with open(folder / "run" / "poses.csv", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    length = np.ptp(pair.ligand[0], axis=0).max()

    def errors(row):
        numbers = [float(row[name]) for name in ("qw", "qx", "qy", "qz", "tx", "ty", "tz")]
        return off(pair, motion(rotation(numbers[:4]), numbers[4:]))

    offs = [errors(row) for row in rows]
    right = [distance <= 0.1 * length and angle <= 10 for distance, angle in offs]
    found = "- | - | - | -"
    if any(right):
        at = right.index(True)
        wrong = [float(row["score"]) for row, is_right in zip(rows, right) if not is_right]
        share = max(wrong, default=0) / float(rows[at]["score"])
        found = f"{at + 1} | {offs[at][0] / length:.3f} | {offs[at][1]:.1f} | {share:.2f}"
    run = json.loads((folder / "run" / "run.json").read_text())
    sampling = [run["inputs"][side]["sampling"] for side in ("receptor", "ligand")]
    balls = " and ".join(f"{one['balls']:,}" for one in sampling)
    gap = run["options"]["kernel"]["offset"] / pair.clearance
    return f"| {pair.name} | {found} | {len(rows)} | {balls} | {gap:.2f} | {seconds:.0f} |"


def main():
    words = sys.argv[1:]
    own, more = (words[: words.index("--")], words[words.index("--") + 1 :]) if "--" in words else (words, [])
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("parts", type=Path, help="the folder that the example wrote; runs go into it")
    parser.add_argument("--pairs", nargs="*", help="only these")
    options = parser.parse_args(own)
    print("| pair | rank | off by, lengths | degrees | best wrong pose | rows | balls | gap / clearance | CPU s |")
    print("|---|---|---|---|---|---|---|---|---|")
    for pair in [*example_pairs(options.parts), *own_pairs()]:
        if not options.pairs or pair.name in options.pairs:
            print(dock(options.program.resolve(), pair, options.parts / pair.name, more), flush=True)


if __name__ == "__main__":
    main()
