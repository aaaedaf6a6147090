"""Two commands on one folder at the same time."""

import shutil
import time

from promises.folders import below, comparable, differences, tree
from promises.scenes import DOCK, FEW, write_inputs


def start_both(trial, calls):
    """Starts two calls within a tenth of a second and waits for both."""
    first = trial.start(*calls[0])
    time.sleep(trial.random.choice([0.0, 0.0, trial.random.uniform(0, 0.1)]))
    second = trial.finish(trial.start(*calls[1]))
    both = [trial.finish(first), second]
    for call in both:
        trial.check_orderly(call, False)
    trial.check(any(call.code == 0 for call in both), "neither of the two ended well")
    return both


def docks_at_once(trial):
    """Of two runs into one folder at once the folder holds one whole, and nothing else.

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
    """Of two batches into one folder at once none loses rows or runs of the other.

    Batches of two tables start within a tenth of a second; one that is refused is called again.
    """
    write_inputs(trial.folder)
    trial.make("others.csv", "receptor,ligand,name\nreceptor.pdb,ligand.pdb,three\n")
    calls = [["batch", table, "-o", "runs", "--", *FEW] for table in ("pairs.csv", "others.csv")]
    for words, call in zip(calls, start_both(trial, calls)):
        if call.code:
            trial.run(*words, may_fail=False)
    found = below(tree(trial.folder), "runs")
    rows = found.get("runs/results.csv", b"").decode().splitlines()[1:]
    trial.check(sorted(row.split(",")[0] for row in rows) == ["one", "three", "two"], f"results.csv has rows {rows}")
    expected = {"runs", "runs/results.csv", "runs/report.html", "runs/one", "runs/two", "runs/three"}
    there = {name for name in found if name.count("/") < 2}
    trial.check(expected <= there, f"missing: {expected - there}")
    # A file that batches lock may stay.
    left = {name for name in there - expected if found[name]}
    trial.check(not left, f"left over: {sorted(left)}")
