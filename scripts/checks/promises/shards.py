"""Shards of a batch that are killed, damaged, or whose disk is full: their tables in the end."""

import gzip
import json
import os
import shutil
import signal
import subprocess
import time
import zlib

from promises.exact_scores import random_molecule
from promises.folders import differences, has_ended, tree
from promises.mutations import mutated, mutated_gzip, mutated_json
from promises.scenes import FEW, SHARD, shard, write_inputs
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


def check_merged(trial, folder, expected):
    trial.run("merge", folder, may_fail=False)
    for name, content in zip(TABLES, expected):
        path = trial.folder / folder / name
        trial.check(
            path.exists() and path.read_bytes() == content, f"{name} is another than that of an undisturbed batch"
        )


def plant_notes(trial):
    """Notes of the user's in folders of started shards, and beside them; their paths."""
    notes = []
    for record in [*trial.folder.glob("out/shards/*/batch.json"), *trial.folder.glob("*/knotdock-*/batch.json")]:
        folder = record.parent
        notes += [folder / "notes.txt", folder.parent / f".{folder.name}.old/notes.txt"]
        notes += [folder.parent / f".{folder.name}.new/notes.txt"]
    for note in notes:
        note.parent.mkdir(exist_ok=True)
        note.write_text("the user's notes\n")
    return notes


def killed_shards(trial):
    """A batch whose shards are killed again and again makes the table of an undisturbed batch.

    Up to twelve pairs, one of a damaged file, in one to three shards, on one or two threads, with scratch folders that
    change from call to call or without. Each shard is killed by SIGKILL at up to nine random moments, and goes on. The
    merged tables are compared byte for byte; the user's notes in folders of shards stay.
    """
    count = trial.random.randint(3, 12)
    expected = prepare(trial, count, trial.random.randrange(count))
    shards = trial.random.randint(1, 3)
    folders = trial.random.choice([[None], ["near"], ["near", "far", None]])
    notes = []
    for index in range(1, shards + 1):
        words = ["batch", "pairs.csv", "-o", "out", "--keep", "table", "--shard", f"{index}/{shards}", "--failures-ok"]
        words += ["-j", trial.random.choice("12")]

        def call(words=words):
            scratch = trial.random.choice(folders)
            return [*words, *(["--scratch", scratch] if scratch else []), *DOCK]

        for _ in range(trial.random.randint(1, 9)):
            began = time.monotonic()
            seconds = trial.random.uniform(0, 0.15)

            def kill(process, began=began, seconds=seconds):
                while time.monotonic() < began + seconds and not has_ended(process):
                    time.sleep(0.0005)
                os.kill(process.pid, signal.SIGKILL)

            trial.finish(trial.start(*call()), watch=kill)
            if trial.random.random() < 0.2:
                notes += plant_notes(trial)
        trial.run(*call(), may_fail=False)
    check_merged(trial, "out", expected)
    lost = [str(note.relative_to(trial.folder)) for note in notes if not note.exists()]
    trial.check(not lost, f"notes of the user's are gone: {lost[:3]}")


def shards_on_full_disks(trial):
    """A batch whose disk is full ends with exit code 1 or 2, and goes on where it was once there is room.

    The directory of the batch is on a file system with 0 to 64 kB of room, and then with more; its shard is written
    there, or in a scratch folder elsewhere first (needs root on Linux).
    """
    own_mounts()
    count = trial.random.randint(3, 8)
    expected = prepare(trial, count, trial.random.randrange(count))
    disk = trial.folder / "disk"
    disk.mkdir()
    room = trial.random.choice([4, 8, 12, 16, 24, 32, 48, 64])
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={room}k", "none", disk], capture_output=True)
    if done.returncode:
        raise Skipped("no mounting here")
    try:
        words = ["batch", "pairs.csv", "-o", "disk/out", "--keep", "table", "--shard", "1/1", "--failures-ok"]
        words += [*trial.random.choice([[], ["--scratch", "near"]]), *DOCK]
        trial.run(*words)
        trial.commands[-1] += f"   # {room} kB free"
        subprocess.run(["mount", "-o", "remount,size=16m", disk], check=True)
        trial.run(*words, may_fail=False)
        check_merged(trial, "disk/out", expected)
    finally:
        subprocess.run(["umount", "-l", disk], check=False)
        shutil.rmtree(disk, ignore_errors=True)


def hostile_record(trial, content):
    """A record of a shard that counts no shards, or very many."""
    record = json.loads(content)
    index, count = trial.random.choice([(0, 0), (1, 0), (0, 1), (3, 2), (1, 10**12), (2**64 - 1, 2**64 - 1)])
    shape = {"index": index, "count": count} if isinstance(record["shard"], dict) else f"{index}/{count}"
    return json.dumps({**record, "shard": shape, "pairs": trial.random.choice([record["pairs"], 10**15])}).encode()


def gzip_without_end(path, megabytes):
    """A gzip file that unpacks to the given number of megabytes without a line end."""
    packer = zlib.compressobj(1, zlib.DEFLATED, 31)
    with open(path, "wb") as file:
        for _ in range(megabytes):
            file.write(packer.compress(bytes(2**20)))
        file.write(packer.flush())


def damaged_shards(trial):
    """Damaged files of shards are read or refused, in bounded time and memory; a merge that fails changes nothing.

    Records, tables, poses and attempts of a shard are changed or cut short, records count no shards or 10^12, poses
    unpack to 256 MB without a line end. Then the shards are merged, and the shard is called again.
    """
    write_inputs(trial.folder)
    for part in ("1/2", "2/2"):
        trial.run(*shard(part), may_fail=False)
    names = ["batch.json", "batch.json", "results.csv", "poses.csv.gz", "poses.csv.gz", "attempts.csv"]
    name = trial.random.choice(names)
    path = trial.folder / SHARD / name
    content = path.read_bytes()
    if name == "batch.json":
        change = trial.random.choice([hostile_record, lambda trial, content: mutated_json(trial.random, content)])
        path.write_bytes(change(trial, content))
    elif name == "poses.csv.gz" and trial.random.random() < 0.3:
        gzip_without_end(path, 256 if trial.full else 128)
    else:
        is_packed = name.endswith(".gz") and trial.random.random() < 0.5
        unpacked = gzip.decompress(content) if is_packed else content
        path.write_bytes((mutated_gzip if is_packed else mutated)(trial.random, unpacked))
    before = tree(trial.folder)
    calls = [["merge", "--json", "many", *trial.random.choice([[], ["--partial"]])], shard("1/2")]
    for words in calls:
        call = trial.run(*words)
        trial.check(call.peak <= 400 * 2**20, f"{name} of a shard: {words[0]} took {call.peak / 2**20:.0f} MiB")
        if words[0] == "merge" and call.code:
            wrong = differences(tree(trial.folder), before)
            trial.check(not wrong, f"failed, and {wrong}")


def reserved_names(trial):
    """A pair with the name of a batch's own file is refused before anything is docked, with its line of the table.

    Names such as results.csv and Report.HTML, in small and capital letters, with any --keep and as a shard.
    """
    write_inputs(trial.folder)
    name = trial.random.choice(["results.csv", "poses.csv.gz", "report.html", "batch.json", "attempts.csv", "shards"])
    name = trial.random.choice([name, name.upper(), name.title()])
    rows = (trial.folder / "pairs.csv").read_text().splitlines()
    place = trial.random.randint(1, len(rows))
    rows.insert(place, f"receptor.pdb,ligand.pdb,{name}")
    trial.make("pairs.csv", "\n".join(rows) + "\n")
    before = tree(trial.folder)
    how = trial.random.choice([["--keep", "none"], ["--keep", "table"], ["--keep", "top"], [], ["--shard", "1/2"]])
    call = trial.run("batch", "--json", "pairs.csv", "-o", "runs", *how, "--", *FEW)
    error = call.error()
    trial.check(call.code == 2, f"a pair called {name}: ended with {call.code}")
    trial.check(error.get("line") == place + 1, f"the error is in line {error.get('line')}, not {place + 1}")
    wrong = differences(tree(trial.folder), before)
    trial.check(not wrong, f"refused, and {wrong}")
