"""Commands killed at random: what stands then, and what the next call makes of it."""

import csv
import io
import json
import os
import shutil
import signal
import time

from promises.folders import Watch, below, comparable, differences, has_ended, tree
from promises.scenes import SCENES, usual

KILLED = [scene for scene in SCENES if scene.name.split()[0] in ("dock", "sample", "batch", "export", "tradeoff")]
NOTES = {"dock --force": ["run/notes.txt", "run/top/notes.txt"], "tradeoff --force": ["sweep/notes.txt"]}


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
    old = comparable(common.old, trial.folder)
    new = comparable(common.new, trial.folder)
    for unit in scene.units:
        known = below(old, unit).keys() | below(new, unit).keys()
        there = {name: content for name, content in below(found, unit).items() if name in known and content is not None}
        states = [{name: content for name, content in below(state, unit).items() if content is not None}
                  for state in (old, new)]  # fmt: skip
        if there not in states:
            beside_old, beside_new = (differences(there, state) for state in states)
            trial.check(False, f"{unit} is neither old ({beside_old}) nor new ({beside_new})")


def check_table(trial, found):
    """Checks that the table of a batch is whole where there is one."""
    if (table := found.get("runs/results.csv")) is not None:
        rows = list(csv.reader(io.StringIO(table.decode())))
        is_whole = table.endswith(b"\n") and len(rows) > 1 and len({len(row) for row in rows}) == 1
        trial.check(is_whole, f"results.csv is not whole: {table[-200:]!r}")


def check_records(trial):
    """Checks that records can be read as JSON."""
    for name in ("run/run.json", "sweep/tradeoff.json", "runs/one/run.json", "runs/two/run.json"):
        path = trial.folder / name
        if path.is_file():
            try:
                json.loads(path.read_bytes())
            except ValueError:
                trial.check(False, f"{name} is no JSON")


def kills(trial):
    """A command that is killed leaves the old or the new result whole; the next call ends well and tidies up.

    dock, batch, sample, export and tradeoff, with and without an older result and files of the user's beside it, get
    SIGKILL at a random time or at a random event in their folder. Each result is compared byte for byte with that of
    an undisturbed call; so is the whole folder after the next call. Where files of the user's lie beside a run the
    comparison comes after a command that reads the run, which finishes what was cut.
    """
    scene = trial.random.choice(KILLED)
    common = usual(trial.knotdock, scene.name)
    scene.prepare(trial)
    users = {}
    for name in NOTES.get(scene.name, []):
        if trial.random.random() < 0.5:
            users[name] = trial.make(name, f"the user's {name}\n").read_bytes()
    what, kill = killer(trial, common)
    call = trial.finish(trial.start(*scene.words), watch=kill)
    trial.commands[-1] += f"   # killed {what}"
    trial.check(call.code in (0, -9), f"ended with {call.code} by itself: {call.err[-200:]}")
    found = comparable(tree(trial.folder), trial.folder)
    if users and scene.name == "dock --force":
        # Beside files of the user's a journal stands for the new run; whatever reads the run finishes that first.
        trial.run("export", "run", "--rank", "1", "-o", "aside")
        shutil.rmtree(trial.folder / "aside", ignore_errors=True)
        found = comparable(tree(trial.folder), trial.folder)
    if not users or scene.name == "dock --force":
        check_units(trial, scene, common, found)
    check_table(trial, found)
    check_records(trial)
    missing = [name for name, content in users.items() if content not in found.values()]
    trial.check(not missing, f"killed {what}: of the user's {', '.join(missing)} is nowhere")
    repeat(trial, scene, common, users)


def repeat(trial, scene, common, users):
    """Calls the same command again, with --force where it finds its result there, and compares the folder."""
    call = trial.run(*scene.words)
    if call.code == 2 and "--force" not in scene.words:
        call = trial.run(*scene.words, "--force")
    trial.check(call.code == 0, f"the next call ends with {call.code}: {call.err.strip()[-300:]}")
    wrong = differences(comparable(tree(trial.folder), trial.folder), comparable(common.new | users, trial.folder))
    trial.check(not wrong, f"after the next call: {wrong}")
