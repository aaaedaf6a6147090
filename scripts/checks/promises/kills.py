"""Commands killed at random: the files afterwards, and the result of the next call."""

import csv
import io
import json
import os
import shutil
import signal
import time

from promises.folders import (
    BESIDE,
    LOCK,
    Watch,
    below,
    comparable,
    differences,
    has_ended,
    leftovers,
    tree,
    with_older_runs,
    without,
)
from promises.scenes import SCENES, usual


def killer(trial, common):
    """A function that kills a process at a random time, or after a random number of events in its folder."""
    if trial.random.random() < 0.4:
        seconds = trial.random.uniform(0, 1.1 * common.seconds)

        def after_a_time(process):
            end = time.monotonic() + seconds
            while time.monotonic() < end and not has_ended(process):
                time.sleep(0.0005)
            os.kill(process.pid, signal.SIGKILL)

        return f"after {seconds:.3f} s", after_a_time
    events = trial.random.randint(1, max(common.events, 1))
    watch = Watch(trial.folder)

    def after_events(process):
        watch.follow(process, until=events)
        os.kill(process.pid, signal.SIGKILL)
        watch.close()

    return f"after {events} events of files", after_events


def check_units(trial, scene, common, found):
    """Checks that each unit is old or new as a whole. Other entries are not looked at."""
    for unit in scene.units:
        known = below(common.old, unit).keys() | below(common.new, unit).keys()
        there = {name: content for name, content in below(found, unit).items() if name in known and content is not None}
        states = [{name: content for name, content in below(state, unit).items() if content is not None}
                  for state in (common.old, common.new)]  # fmt: skip
        if there not in states:
            beside_old, beside_new = (differences(there, state) for state in states)
            trial.check(False, f"{unit} is neither old ({beside_old}) nor new ({beside_new})")


def check_table(trial, found):
    """Checks that a batch's table has whole rows. The next call cuts off a last one without its line end."""
    if (table := found.get("runs/results.csv")) is not None:
        rows = list(csv.reader(io.StringIO(table[: table.rfind(b"\n") + 1].decode())))
        trial.check(len({len(row) for row in rows}) <= 1, f"results.csv is not whole: {table[-200:]!r}")


def check_records(trial, found):
    """Checks that records and lists, where they are there, read as JSON."""
    for name, content in without(found, leftovers(found)).items():
        if name.endswith(".json"):
            try:
                json.loads(content)
            except (ValueError, TypeError):
                trial.check(False, f"{name} is no JSON")


def kills(trial):
    """A command that is killed leaves the old or the new result whole, and the next call ends well.

    Every command that writes files, with and without an older result, gets SIGKILL at a random time or at a random
    event in its folder; shards with and without --scratch, and merge, too. A third of the calls takes the system for
    one that cannot exchange folders (in debug builds). Each result is compared byte for byte with that of an
    undisturbed call, the older run in its place or aside as `.NAME.knotdock-old`; so is the whole folder after the
    next call. That call takes the lock over, names in a warning what the kill left beside its target, and leaves it.
    """
    scene = trial.random.choice(SCENES)
    common = usual(trial.knotdock, scene.name)
    scene.prepare(trial)
    environment = trial.random.choice([{}, {}, {"KNOTDOCK_NO_EXCHANGE": "1"}])
    what, kill = killer(trial, common)
    call = trial.finish(trial.start(*scene.words, environment=environment), watch=kill)
    trial.commands[-1] += f"   # killed {what}"
    trial.check(call.code in (0, -9), f"ended with {call.code} by itself: {call.err[-200:]}")
    left = tree(trial.folder)
    check_records(trial, left)
    found = with_older_runs(comparable(left, trial.folder))
    check_units(trial, scene, common, found)
    check_table(trial, found)
    if "run" not in left and "run" in found and trial.random.random() < 0.5:
        # A command that only reads the run puts it back, too.
        trial.run("export", "run", "--rank", "1", "-o", "aside", environment=environment, may_fail=False)
        trial.check((trial.folder / "run").is_dir(), "the older run is still aside")
        shutil.rmtree(trial.folder / "aside", ignore_errors=True)
    repeat(trial, scene, common, left, environment)


# Commands that replace a finished result with --force alone; others leave finished results unchanged.
REFUSED_AGAIN = ("dock", "tradeoff", "sample", "inspect", "evaluate")


def repeat(trial, scene, common, left, environment):
    """Calls the same command again, with --force where it finds its result there, and compares the folder."""
    call = trial.run(*scene.words, environment=environment)
    said = call.err
    if call.code == 2 and "--force" not in scene.words and scene.words[0] in REFUSED_AGAIN:
        call = trial.run(*scene.words, "--force", environment=environment)
        said += call.err
    trial.check(call.code == 0, f"the next call ends with {call.code}: {call.err.strip()[-300:]}")
    found = tree(trial.folder)
    after, beside = comparable(found, trial.folder), leftovers(comparable(left, trial.folder))
    wrong = differences(without(after, beside), common.new)
    trial.check(not wrong, f"after the next call: {wrong}")
    for path in beside:
        if not BESIDE.match(path) and path not in after:
            continue  # an older run that stood aside may go
        changed = differences(below(after, path), below(comparable(left, trial.folder), path))
        trial.check(not changed, f"what the kill left was touched: {changed}")
        # A batch names what is beside the tables and runs that it writes again; those that are done it leaves.
        is_named = os.path.basename(path) in said or scene.goes_on
        trial.check(call.code or is_named, f"no warning names {path}")
    # One in a folder that a kill left is left with it.
    locks = [name for name in found if LOCK.match(name) and not any(name.startswith(f"{path}/") for path in beside)]
    trial.check(not locks, f"locks that nobody holds: {locks}")
