#!/usr/bin/env python3
"""Times coal (PyPI) on the poses of a CSV file, as `cargo bench --bench collide` asks for.

    python scripts/benchmark/collide_peers.py A.obj B.obj PATH.csv TABLE.csv --stride 10

Needs coal, numpy and trimesh (scripts/checks/requirements_solids.txt). Columns of PATH.csv: qw, qx, qy, qz, tx, ty, tz.
The table has a row for every pose taken: its number, whether the surfaces meet, their distance, and the microseconds of
a collision, of a distance, and of a collision with all contacts; each the least of a few runs.

A call from Python adds about a microsecond, which is in the times; the time of the empty call is printed.
"""

import argparse
import csv
import time

import coal
import numpy as np
import trimesh

MOST_CONTACTS = 10_000


def tree(path):
    """coal's tree of a mesh file."""
    mesh = trimesh.load(path, process=False)
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(mesh.faces), len(mesh.vertices))
    model.addVertices(np.asarray(mesh.vertices, dtype=float))
    model.addTriangles(np.asarray(mesh.faces, dtype=np.int64))
    model.endModel()
    return model


def least(runs, task):
    """Microseconds of the fastest run, and the result of the last one."""
    best = float("inf")
    for _ in range(runs):
        start = time.perf_counter_ns()
        result = task()
        best = min(best, time.perf_counter_ns() - start)
    return best / 1e3, result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("first", "second", "path", "table"):
        parser.add_argument(name)
    parser.add_argument("--stride", type=int, default=1, help="every how manieth pose is taken")
    parser.add_argument("--runs", type=int, default=3, help="runs of each question")
    options = parser.parse_args()
    first, second = tree(options.first), tree(options.second)
    still = coal.Transform3s.Identity()
    verdict, everything = coal.CollisionRequest(), coal.CollisionRequest()
    everything.num_max_contacts, everything.enable_contact = MOST_CONTACTS, True
    gap = coal.DistanceRequest()

    def collide(moved, request):
        result = coal.CollisionResult()
        coal.collide(first, still, second, moved, request, result)
        return result

    def distance(moved):
        result = coal.DistanceResult()
        coal.distance(first, still, second, moved, gap, result)
        return result

    with open(options.path, newline="") as file:
        poses = [
            [float(row[name]) for name in ("qw", "qx", "qy", "qz", "tx", "ty", "tz")] for row in csv.DictReader(file)
        ]
    print(f"an empty call: {least(1000, still.getTranslation)[0]:.2f} us")
    with open(options.table, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["pose", "meet", "distance", "collide_us", "distance_us", "contacts_us"])
        for number in range(0, len(poses), options.stride):
            turn = trimesh.transformations.quaternion_matrix(poses[number][:4])[:3, :3]
            moved = coal.Transform3s(turn, np.array(poses[number][4:]))
            hit_us, hit = least(options.runs, lambda: collide(moved, verdict))
            gap_us, found = least(options.runs, lambda: distance(moved))
            all_us, _ = least(options.runs, lambda: collide(moved, everything))
            row = [number, int(hit.isCollision()), max(0.0, found.min_distance), hit_us, gap_us, all_us]
            table.writerow(row)


if __name__ == "__main__":
    main()
