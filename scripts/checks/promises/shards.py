"""Shards of a batch that are killed, or whose disk is full: what they come to in the end."""

import os
import shutil
import signal
import subprocess
import time

from promises.exact_scores import random_molecule
from promises.folders import has_ended
from promises.trial import Skipped
from promises.write_failures import own_mounts

DOCK = ["--", "--rotations", "2", "--poses", "8", "--effects", "shape", "--threads", "1"]
TABLES = ("results.csv", "poses.csv.gz")


def prepare(trial, count, damaged):
    """A table of pairs, one of which has a file that is none, and the tables of the batch that nothing disturbs."""
    for name in ("a", "b", "c"):
        random_molecule(trial, f"{name}.pdb")
    trial.make("damaged.pdb", "ATOM      1  CA  ALA A   1      nonsense\n")
    rows = ["name,receptor,ligand"]
    for number in range(count):
        receptor = "damaged.pdb" if number == damaged else f"{trial.random.choice('abc')}.pdb"
        rows.append(f"pair_{number},{receptor},{trial.random.choice('abc')}.pdb")
    trial.make("pairs.csv", "\n".join(rows) + "\n")
    trial.run("batch", "pairs.csv", "-o", "whole", "--keep", "table", "--failures-ok", *DOCK, may_fail=False)
    return [(trial.folder / "whole" / name).read_bytes() for name in TABLES]


def check_merged(trial, expected):
    trial.run("merge", "out", may_fail=False)
    for name, content in zip(TABLES, expected):
        path = trial.folder / "out" / name
        trial.check(
            path.exists() and path.read_bytes() == content, f"{name} is another than that of an undisturbed batch"
        )


def killed_shards(trial):
    """A batch whose shards are killed again and again makes the table of one that nothing disturbs.

    Up to twelve pairs, one of a damaged file, in one to three shards, on one or two threads. Each shard is killed by
    SIGKILL at up to nine random moments, and goes on; the merged tables are compared byte for byte.
    """
    count = trial.random.randint(3, 12)
    expected = prepare(trial, count, trial.random.randrange(count))
    shards = trial.random.randint(1, 3)
    for index in range(1, shards + 1):
        words = ["batch", "pairs.csv", "-o", "out", "--keep", "table", "--shard", f"{index}/{shards}", "--failures-ok"]
        words += ["-j", trial.random.choice("12")] + trial.random.choice([[], ["--scratch", "near"]])
        for _ in range(trial.random.randint(1, 9)):
            began = time.monotonic()
            seconds = trial.random.uniform(0, 0.15)

            def kill(process, began=began, seconds=seconds):
                while time.monotonic() < began + seconds and not has_ended(process):
                    time.sleep(0.0005)
                os.kill(process.pid, signal.SIGKILL)

            trial.finish(trial.start(*words, *DOCK), watch=kill)
        trial.run(*words, *DOCK, may_fail=False)
    check_merged(trial, expected)


def shards_on_full_disks(trial):
    """A batch whose disk is full ends with exit code 1 or 2, and goes on where it was once there is room.

    The directory of the batch is a file system with 0 to 64 kB of room, and then with more (needs root on Linux).
    """
    own_mounts()
    count = trial.random.randint(3, 8)
    expected = prepare(trial, count, trial.random.randrange(count))
    disk = trial.folder / "out"
    disk.mkdir()
    room = trial.random.choice([4, 8, 12, 16, 24, 32, 48, 64])
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={room}k", "none", disk], capture_output=True)
    if done.returncode:
        raise Skipped("no mounting here")
    try:
        words = ["batch", "pairs.csv", "-o", "out", "--keep", "table", "--shard", "1/1", "--failures-ok", *DOCK]
        trial.run(*words)
        trial.commands[-1] += f"   # {room} kB free"
        subprocess.run(["mount", "-o", "remount,size=16m", disk], check=True)
        trial.run(*words, may_fail=False)
        check_merged(trial, expected)
    finally:
        subprocess.run(["umount", "-l", disk], check=False)
        shutil.rmtree(disk, ignore_errors=True)
