"""Two commands on one folder at the same time."""

import shutil
import time

from promises.folders import BESIDE, LOCK, below, comparable, differences, tree
from promises.scenes import DOCK, FEW, write_inputs


def start_both(trial, calls):
    """Starts two calls within a tenth of a second and waits for both: one is refused, or follows the other."""
    first = trial.start(*calls[0])
    time.sleep(trial.random.choice([0.0, 0.0, trial.random.uniform(0, 0.1)]))
    second = trial.finish(trial.start(*calls[1]))
    both = [trial.finish(first), second]
    for call in both:
        trial.check_orderly(call, False)
        trial.check(call.code in (0, 2), f"ended with {call.code}: {call.err.strip()[-200:]}")
    trial.check(any(call.code == 0 for call in both), "neither of the two ended well")
    return both


def docks_at_once(trial):
    """After two runs into one folder at once the folder holds one whole, and nothing else.

    Two docks of different inputs, with --force or without, start within a tenth of a second of each other.
    """
    write_inputs(trial.folder)
    force = trial.random.choice([[], ["--force"]])
    calls = [[*DOCK, *force], ["dock", "ligand.pdb", "receptor.pdb", *FEW, "-o", "run", *force]]
    before = tree(trial.folder)
    codes = [call.code for call in start_both(trial, calls)]
    found = tree(trial.folder)
    whole = []
    for words in calls:
        shutil.rmtree(trial.folder / "run", ignore_errors=True)
        trial.run(*[word for word in words if word != "--force"], may_fail=False)
        whole.append(below(tree(trial.folder), "run"))
    wanted = [comparable(before | run, trial.folder) for run in whole]
    words = [differences(comparable(found, trial.folder), other) for other in wanted]
    trial.check("" in words, f"exit codes {codes}; beside the first run alone: {words[0]}; the second: {words[1]}")


def batches_at_once(trial):
    """If a batch is called twice at once, one call is refused or follows, and no row is lost or there twice.

    Two calls of a batch, or of a shard with separate scratch folders or without, start within a tenth of a second of
    each other; one that is refused is called again. The tables are compared with those of an undisturbed batch.
    """
    write_inputs(trial.folder)
    kind = trial.random.choice(["all", "table", "shard", "scratch", "scratch"])
    words = ["batch", "pairs.csv", "-o", "runs", "--keep", "all" if kind == "all" else "table"]
    if kind in ("shard", "scratch"):
        words += ["--shard", "1/1"]
    own = [["--scratch", "near"], ["--scratch", "far"]] if kind == "scratch" else [[], []]
    calls = [[*words, *scratch, "--", *FEW] for scratch in own]
    for again, call in zip(calls, start_both(trial, calls)):
        if call.code:
            trial.run(*again, may_fail=False)
    if "--shard" in words:
        trial.run("merge", "runs", may_fail=False)
    trial.run("batch", "pairs.csv", "-o", "whole", "--keep", "table", "--", *FEW, may_fail=False)
    found = tree(trial.folder)
    for name in ["results.csv"] if kind == "all" else ["results.csv", "poses.csv.gz"]:
        is_same = found.get(f"runs/{name}") == found.get(f"whole/{name}")
        trial.check(is_same and f"whole/{name}" in found, f"{name} is another than that of an undisturbed batch")
    left = [name for name in found if BESIDE.match(name) or LOCK.match(name)]
    trial.check(not left, f"left over: {left}")
