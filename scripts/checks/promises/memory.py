"""`--memory` is a promise: the limit that a refusal names suffices."""

import re
import time

from promises.folders import has_ended
from promises.scenes import EXAMPLES, write_inputs

UNITS = {"bytes": 1, "B": 1, "kB": 1e3, "K": 1e3, "KiB": 2**10, "MB": 1e6, "M": 1e6, "MiB": 2**20,
         "GB": 1e9, "G": 1e9, "GiB": 2**30}  # fmt: skip
EXAMPLE = [EXAMPLES / f"1ppe_{side}_unbound.pdb" for side in ("receptor", "ligand")]
CALLS = [
    ["receptor.pdb", "ligand.pdb", "--rotations", "8"],
    ["receptor.pdb", "ligand.pdb", "--rotations", "200", "--per-rotation", "60", "--poses", "12000", "--no-cluster"],
    [*EXAMPLE, "--rotations", "8"],
    [*EXAMPLE, "--rotations", "60", "--refine", "40", "--effects", "shape"],
    [*EXAMPLE, "--rotations", "40", "--per-rotation", "200", "--poses", "8000"],
    [*EXAMPLE, "--rotations", "8", "--precision", "double", "--tolerance", "1e-4"],
    ["block.obj", "key.obj", "--sample-grid", "2^15", "--rotations", "30"],
    [EXAMPLES / "4e43_molecule.pdb", "--symmetry", "C2", "--rotations", "6"],
    ["ligand.pdb", "--symmetry", "C4", "--rotations", "20"],
]


def sizes(words):
    """Sizes in bytes that a sentence names."""
    found = re.findall(r"([\d.]+) ?(bytes|[kKMG]i?B?|B)\b", words)
    return [float(number.strip(".")) * UNITS[unit] for number, unit in found if unit in UNITS]


def follow_peak(process, peaks):
    """Notes the system's figure of a program's peak (VmHWM) until it ends."""
    while not has_ended(process):
        try:
            with open(f"/proc/{process.pid}/status") as file:
                peaks += [int(line.split()[1]) * 1024 for line in file if line.startswith("VmHWM")]
        except OSError:
            return
        time.sleep(0.005)


def refusals(trial):
    """The limit that a refusal by --memory names suffices: the peak of resident memory is at most 5% above it.

    Dockings of molecules, meshes and rings that keep many poses or refine them are refused at 1 MB; then they run
    with the limit that the refusal names, with one thread or two. The peak is the system's figure, or that of run.json.
    """
    write_inputs(trial.folder)
    words = ["dock", *CALLS[trial.number % len(CALLS)], "--threads", trial.random.choice([1, 2]), "-o", "run"]
    refused = trial.run(*words, "--memory", "1M", "--json")
    error = refused.error()
    named = sizes(f"{error.get('message', '')} {error.get('remedy', '')}")
    if not trial.check(refused.code == 2 and named, f"no refusal that names a size: {refused.out[:300]}"):
        return
    limit = int(max(named))
    peaks = [0]
    process = trial.start(*words, "--memory", limit, "--json")
    call = trial.finish(process, watch=lambda process: follow_peak(process, peaks))
    trial.check_orderly(call, True)
    said = call.error().get("message")
    if not trial.check(call.code == 0, f"a limit of {limit} bytes, as the refusal names it: {said}"):
        return
    peak = max(*peaks, call.object()["run"]["timing"]["peak_memory_bytes"] or 0)
    over = peak / limit - 1
    trial.check(over <= 0.05, f"the peak is {peak} bytes, {over:.0%} over the limit of {limit}")
