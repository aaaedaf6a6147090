"""How the benchmark scripts dock: options after `--`, a random start orientation, and the cost of a run.

Imported by benchmark.py and rings.py.
"""

import hashlib
import math
import os
import random
import shutil
import statistics
import subprocess
import sys
import time


def split_arguments():
    """The script's own arguments, and those after `--` for `knotdock dock`."""
    arguments = sys.argv[1:]
    cut = arguments.index("--") if "--" in arguments else len(arguments)
    return arguments[:cut], arguments[cut + 1 :]


def seeds(text):
    """Numbers separated by commas."""
    return [int(part) for part in text.split(",")]


def find_program(parser, name):
    """The program's path; a usage error where there is none."""
    found = shutil.which(name)
    if found is None:
        parser.error(f"no program {name}; build it and name it with --knotdock target/release/knotdock")
    return found


def start_orientation(text, name, seed):
    """PDB text with its atoms centred on the origin and rotated uniformly at random, fixed by name and seed."""
    lines = [line for line in text.splitlines() if line.startswith(("ATOM  ", "HETATM"))]
    points = [tuple(float(line[start : start + 8]) for start in (30, 38, 46)) for line in lines]
    center = [statistics.fmean(point[axis] for point in points) for axis in range(3)]
    rotation = random_rotation(name, seed)
    rotated = []
    for line, point in zip(lines, points):
        moved = [sum(row[axis] * (point[axis] - center[axis]) for axis in range(3)) for row in rotation]
        rotated.append(line[:30] + "".join(f"{value:8.3f}" for value in moved) + line[54:])
    return "\n".join(rotated) + "\nEND\n"


def random_rotation(name, seed):
    """A rotation matrix uniform over SO(3) (Shoemake, Graphics Gems III, 1992, p. 124), fixed by name and seed."""
    digest = hashlib.sha256(f"{name} {seed}".encode()).digest()
    source = random.Random(int.from_bytes(digest, "big"))
    share, first, second = source.random(), 2 * math.pi * source.random(), 2 * math.pi * source.random()
    low, high = math.sqrt(1 - share), math.sqrt(share)
    x, y, z, w = low * math.sin(first), low * math.cos(first), high * math.sin(second), high * math.cos(second)
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def measured(command, log):
    """Runs a command, its output in a log, and returns its cost; raises when it fails."""
    start = time.monotonic()
    with open(log, "w") as file:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=file, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        last = log.read_text(errors="replace").strip()[-500:]
        raise RuntimeError(f"dock ended with {process.returncode}: {last}")
    unit = 1 if sys.platform == "darwin" else 1024
    return {
        "cpu_seconds": usage.ru_utime + usage.ru_stime,
        "wall_seconds": time.monotonic() - start,
        "peak_memory_bytes": usage.ru_maxrss * unit,
    }
