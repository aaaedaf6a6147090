"""Writes that fail: a file-size limit, a full disk, and folders that may not be written to."""

import ctypes
import os
import subprocess

from promises.folders import comparable, differences, tree
from promises.kills import check_records, check_table, check_units
from promises.scenes import SCENES, usual, write_inputs
from promises.trial import Skipped, limited, unprivileged


def with_json(words):
    return [words[0], "--json", *words[1:]]


def check_failed_cleanly(trial, scene, call, before):
    """Checks a call whose writes may have failed: an error and all as it was, or success and a whole result."""
    common = usual(trial.knotdock, scene.name)
    found = tree(trial.folder)
    if call.code == 0:
        wrong = differences(comparable(found, trial.folder), comparable(common.new, trial.folder))
        trial.check(not wrong, f"ended well, but {wrong}")
    elif scene.goes_on or scene.words[0] in ("merge", "export", "refine", "sample", "inspect"):
        # Each file, and each pair of a batch, is a result by itself: those before the failure may stay.
        there = comparable(found, trial.folder)
        check_units(trial, scene, common, there)
        check_table(trial, there)
        check_records(trial, found)
        # A shard that failed may still be in its scratch folder.
        left = {name for name in there if not name.startswith("near")} - set(common.old) - set(common.new)
        trial.check(not left, f"left over: {sorted(left)[:5]}")
    else:
        wrong = differences(found, before)
        trial.check(not wrong, f"failed with {call.code}, and {wrong}")


def file_size_limit(trial):
    """Past the system's limit on a file's size a command ends with exit code 1 or 2, an error, and all as it was.

    Commands run with RLIMIT_FSIZE from 1 byte to 300 kB, with --json, with and without an older result.
    """
    scene = trial.random.choice(SCENES)
    scene.prepare(trial)
    before = tree(trial.folder)
    limit = int(10 ** trial.random.uniform(0, 5.5))
    call = trial.run(*with_json(scene.words), before=limited(FSIZE=limit))
    trial.commands[-1] += f"   # ulimit -f: {limit} bytes"
    check_failed_cleanly(trial, scene, call, before)


def own_mounts():
    """Gives this process a separate view of mounted file systems, so that its mounts end with it."""
    if os.geteuid() != 0:
        raise Skipped("only root may mount a small disk")
    if not own_mounts.done:
        if ctypes.CDLL(None, use_errno=True).unshare(0x00020000) != 0:
            raise Skipped("no view of mounts of its own here")
        done = subprocess.run(["mount", "--make-rprivate", "/"], capture_output=True)
        if done.returncode:
            raise Skipped("no mounting here")
        own_mounts.done = True


own_mounts.done = False


def full_disk(trial):
    """On a full disk a command ends with exit code 1 or 2, an error, and all as it was.

    The folder is a file system of 0 to 200 kB beyond the files already there (needs root on Linux).
    """
    own_mounts()
    scene = trial.random.choice(SCENES)
    disk = trial.folder / "disk"
    disk.mkdir()
    room = trial.random.choice([0, 4, 8, 16, 32, 64, 128, 200])
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=8m", "none", disk], capture_output=True)
    if done.returncode:
        raise Skipped("no mounting here")
    whole, trial.folder = trial.folder, disk
    try:
        scene.prepare(trial)
        used = os.statvfs(disk)
        kilobytes = (used.f_blocks - used.f_bfree) * used.f_frsize // 1024 + room
        subprocess.run(["mount", "-o", f"remount,size={kilobytes}k", disk], check=True)
        before = tree(disk)
        call = trial.run(*with_json(scene.words))
        trial.commands[-1] += f"   # {room} kB free"
        check_failed_cleanly(trial, scene, call, before)
    finally:
        trial.folder = whole
        subprocess.run(["umount", "-l", disk], check=False)


def no_permission(trial):
    """If a folder cannot be made or written to, a command ends with an error that names it, and all as it was.

    Any command where all folders are read-only; a folder without write permission, a file in the place of a folder,
    and a name that is too long. In a writable folder of a read-only one batch and sample work; a run, which is made
    beside its directory, is refused (root runs the program as another user for this).
    """
    place = trial.random.choice(["all", "all", "closed", "file", "long", "inner", "open"])
    names = ("dock", "sample", "batch", "tradeoff")
    scene = trial.random.choice([scene for scene in SCENES if place == "all" or scene.name in names])
    trial.make("notes.txt", "the user's\n")
    (trial.folder / "closed").mkdir()
    words, target = list(scene.words), ""
    if place == "all":
        scene.prepare(trial)
    else:
        write_inputs(trial.folder)
        target = {"file": "notes.txt/out", "long": "n" * 300, "inner": "closed", "open": "closed/open"}
        target = target.get(place, "closed/out")
        if words[0] == "sample":
            target += "/out.csv" if place in ("inner", "open") else ".csv"
            words = [word for word in words if word not in ("--export", "--picture", "k.obj", "k.svg")]
        words[words.index("-o") + 1] = target
    trial.folder.chmod(0o755)
    if place == "open":
        (trial.folder / "closed/open").mkdir()
        (trial.folder / "closed/open").chmod(0o777)
    (trial.folder / "closed").chmod(0o555)
    before = tree(trial.folder)
    call = trial.run(*with_json(words), before=unprivileged())
    if place == "open" and words[0] in ("batch", "sample"):
        trial.check(call.code == 0, f"{target} is writable, and the call ends with {call.code}: {call.out[:200]}")
        return
    trial.check(call.code in (1, 2), f"ended with {call.code}")
    named = call.error().get("file") or ""
    trial.check(target.split("/")[0][:20] in named + call.out, f"the error names {named!r}")
    wrong = differences(tree(trial.folder), before)
    trial.check(not wrong, wrong)
