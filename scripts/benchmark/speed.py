#!/usr/bin/env python3
"""CPU seconds of builds of knotdock on one thread, beside each other and beside MEGADOCK.

    python3 scripts/benchmark/speed.py target/release/knotdock [OTHER_BUILD ...] [--pair NAME=RECEPTOR,LIGAND ...]
        [--rounds 3] [--megadock PATH] [-- OPTION ...]

Programs take turns, so that a machine that slows down slows all of them. Each figure is the median over the rounds.
Ratios are to the first build: above one it is faster. Without --pair it is the example pair, 1PPE.

MEGADOCK is not ours to give. Its source is at https://github.com/akiyamalab/MEGADOCK; `make USE_GPU=0 USE_MPI=0
OPTIMIZATION="-O3 -march=native"` builds it with FFTW 3. Without --megadock, ratios are to CPU seconds of version 4.1.3
that were measured elsewhere on one thread, which are marked with a star.

Needs Python 3.9 or later and nothing else.
"""

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parents[2] / "structures" / "examples"
EXAMPLE = f"1PPE={EXAMPLES}/1ppe_receptor_unbound.pdb,{EXAMPLES}/1ppe_ligand_unbound.pdb"
# CPU seconds of MEGADOCK 4.1.3 with 3,600 rotations.
ELSEWHERE = {"1PPE": 99.3, "1AHW": 435.0, "1N2C": 1250.0}


def main():
    options = parse_arguments()
    stages = {}
    print("| pair | program | CPU s | times the first | stages, CPU s |")
    print("|---|---|---|---|---|")
    for pair in options.pair or [EXAMPLE]:
        name, _, files = pair.partition("=")
        receptor, _, ligand = files.partition(",")
        if not (name and receptor and ligand):
            sys.exit(f"error: --pair takes NAME=RECEPTOR,LIGAND, not {pair}")
        times = {program: [] for program in options.programs}
        if options.megadock:
            times[options.megadock] = []
        for _ in range(options.rounds):
            for program, seconds in times.items():
                with tempfile.TemporaryDirectory() as folder:
                    if program == options.megadock:
                        command = [program, "-R", receptor, "-L", ligand, "-o", f"{folder}/out"]
                        seconds.append(cpu_seconds(command))
                        continue
                    command = [program, "dock", receptor, ligand, "-o", f"{folder}/run", "--threads", "1"]
                    seconds.append(cpu_seconds(command + options.rest))
                    timing = json.loads(Path(folder, "run", "run.json").read_text())["timing"]
                    parts = stages.setdefault((name, program), {})
                    for stage in timing["stages"]:
                        parts.setdefault(stage["name"], []).append(stage["cpu_seconds"])
        first = statistics.median(times[options.programs[0]])
        rows = {program: statistics.median(seconds) for program, seconds in times.items()}
        if not options.megadock and name in ELSEWHERE:
            rows["MEGADOCK *"] = ELSEWHERE[name]
        for program, seconds in rows.items():
            parts = stages.get((name, program), {})
            listed = ", ".join(f"{part} {statistics.median(values):.2f}" for part, values in parts.items())
            print(f"| {name} | {program} | {seconds:.2f} | {seconds / first:.2f} | {listed} |", flush=True)


def cpu_seconds(command):
    """CPU seconds of a command, its children included, on one thread."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        command, capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"}
    )
    if done.returncode != 0:
        sys.exit(f"error: {' '.join(command)}\n{done.stderr.strip()}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0], formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("programs", nargs="+", metavar="PROGRAM", help="builds of knotdock")
    parser.add_argument("--pair", action="append", metavar="NAME=RECEPTOR,LIGAND")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--megadock", metavar="PATH", help="MEGADOCK's program for CPUs")
    arguments = sys.argv[1:]
    rest = []
    if "--" in arguments:
        cut = arguments.index("--")
        arguments, rest = arguments[:cut], arguments[cut + 1 :]
    options = parser.parse_args(arguments)
    options.rest = rest
    return options


if __name__ == "__main__":
    main()
