"""Nothing of the user's is lost: files, folders, links and pipes that lie where the program writes."""

import os
import select
import stat

from promises.folders import BESIDE, below, differences, has_ended, tree
from promises.scenes import ALSO, DOCK, FEW, OLD, OLD_ALSO, OLD_BATCH, SCENES, SWEEP, shard, usual, write_inputs

# Names that this or an earlier version writes under, and that others may come to use.
GUESSES = [f"{{parent}}/.{{name}}.{end}" for end in ("partial", "old", "new", "knotdock-lock", "knotdock-old",
                                                   "knotdock-abcdefghijkl")]  # fmt: skip
GUESSES += ["{parent}/.partial", "{parent}/{name}.partial", "{parent}/{name}.tmp", "{parent}/.knotdock-lock"]
KINDS = ["file", "folder", "link to a file", "link to a folder", "dangling link", "hard link"]


def write_thesis(trial):
    """A user's folder whose files have the names of a run's files."""
    for name in ("chapter.txt", "poses.csv", "run.json", "batch.json", "results.csv", "k.csv", "lock", "top/notes.txt"):
        trial.make(f"thesis/{name}", f"the user's {name}\n" * 3)
    for rank in range(1, 13):
        trial.make(f"thesis/rank_{rank:04}.pdb", f"the user's own pose {rank}\n")


def plant(folder, name, kind):
    """Puts an entry of the user's at a path; does nothing where one is or the path cannot be."""
    path = folder / name
    up = os.path.relpath(folder / "thesis", path.parent)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if kind == "file":
            with open(path, "x") as file:
                file.write(f"the user's {name}\n")
        elif kind == "folder":
            (path / "new").mkdir(parents=True)
            for inside in ("poses.csv", "mine.txt", "lock", "new/poses.csv"):
                (path / inside).write_text(f"the user's {name}/{inside}\n")
        elif kind == "hard link":
            os.link(folder / "thesis/chapter.txt", path)
        else:
            ends = {"link to a file": f"{up}/chapter.txt", "link to a folder": up, "dangling link": f"{up}/later.txt"}
            os.symlink(ends[kind], path)
    except OSError:
        return


def names_to_take(trial, scene):
    """Names that the scene's call passes through, and guesses beside its outputs."""
    names = set(usual(trial.knotdock, scene.name).passing)
    for output in scene.outputs:
        parent, _, name = output.rpartition("/")
        names |= {guess.format(parent=parent or ".", name=name).removeprefix("./") for guess in GUESSES}
    return sorted(names - set(scene.outputs))


def check_refused(trial, scene, call, before):
    """Checks that a call which was refused has changed nothing, but for one that is done in parts."""
    if call.code == 2 and not scene.goes_on:
        wrong = differences(tree(trial.folder), before)
        trial.check(not wrong, f"refused, and {wrong}")


def names_on_the_way(trial):
    """No user's file, folder or link at a name that the program writes is lost or followed.

    Names that each command passes through are recorded by inotify. Then files, folders and links to a user's folder are
    put there, and at similar names, before the command runs. One that is refused changes nothing.
    """
    scene = trial.random.choice(SCENES)
    scene.prepare(trial)
    write_thesis(trial)
    names = names_to_take(trial, scene)
    # Those above first, so that a link to a folder comes before what would lie in it.
    chosen = sorted(trial.random.sample(names, min(len(names), trial.random.randint(1, 8))))
    plan = [(name, trial.random.choice(KINDS)) for name in chosen]
    plan = [(name, kind) for name, kind in plan if not any(name.startswith(f"{other}/") for other, _ in plan)]
    for name, kind in plan:
        plant(trial.folder, name, kind)
    before = tree(trial.folder)
    call = trial.run(*scene.words)
    check_refused(trial, scene, call, before)
    users = {name: content for name, content in before.items() if not is_output(name, scene, plan)}
    lost = differences({name: content for name, content in tree(trial.folder).items() if name in users}, users)
    trial.check(not lost, f"of the user's: {lost} (there were {', '.join(f'{name}: {kind}' for name, kind in plan)})")


def is_output(name, scene, plan):
    """Whether an entry is one that the scene's call may replace: all below its outputs but the planted ones."""
    if any(name == planted or name.startswith(f"{planted}/") for planted, _ in plan):
        return False
    return any(name == output or name.startswith(f"{output}/") for output in scene.outputs)


def room_for(trial, name):
    """The path of an entry, free for another; the old entry is moved away."""
    path = trial.folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.exists():
        path.rename(trial.folder / "moved_away")
    return path


def links_for_outputs(trial):
    """A link at a name that is written is refused, with and without --force, and what it leads to stays.

    A link to a user's file or folder is in the place of one of the command's outputs. The error names it.
    (Links among the folders above are followed, as by other programs.)
    """
    scene = trial.random.choice(SCENES)
    scene.prepare(trial)
    write_thesis(trial)
    output = trial.random.choice(scene.outputs)
    path = room_for(trial, output)
    is_folder = usual(trial.knotdock, scene.name).new.get(output, b"") is None
    up = os.path.relpath(trial.folder / "thesis", path.parent)
    path.symlink_to(up if is_folder else f"{up}/{trial.random.choice(['chapter.txt', 'poses.csv', 'later.txt'])}")
    before = tree(trial.folder)
    force = trial.random.choice([[], ["--force"]]) if "--force" not in scene.words else []
    call = trial.run(*scene.words, *force)
    check_refused(trial, scene, call, before)
    if scene.goes_on:
        trial.check(call.code != 0, f"{output} is a link, and the call ends well")
        users = [output, "thesis"]
        kept = [{name: entries[name] for unit in users for name in below(entries, unit)}
                for entries in (tree(trial.folder), before)]  # fmt: skip
        trial.check(not (lost := differences(*kept)), f"{output} was a link: {lost}")
    else:
        trial.check(call.code == 2, f"{output} is a link, and the call ends with {call.code}")
        # Of a folder that holds nothing but the link the folder is named.
        is_named = any(part in call.err for part in output.split("/"))
        trial.check(is_named, f"the error does not name {output}: {call.err.strip()[-300:]}")


def drain(path):
    """A function that reads a pipe until a process ends, for one that is named to be written to."""

    def watch(process):
        try:
            pipe = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        except OSError:
            return  # it is gone, which is found afterwards
        while not has_ended(process):
            if select.select([pipe], [], [], 0.01)[0] and not os.read(pipe, 65536):
                select.select([], [], [], 0.01)  # nobody writes to it yet, or any more
        os.close(pipe)

    return watch


def make_special(path, kind):
    """Makes a pipe, a device, a socket or a folder of the user's; one who may make no device makes a pipe."""
    if kind == "folder":
        path.mkdir()
        (path / "notes.txt").write_text("the user's notes\n")
    elif kind == "device" and os.geteuid() == 0:
        os.mknod(path, 0o666 | stat.S_IFCHR, os.makedev(1, 5))  # as /dev/zero, which has no end
    elif kind == "socket":
        os.mknod(path, 0o666 | stat.S_IFSOCK)
    else:
        os.mkfifo(path)


def special_files(trial):
    """A pipe, device, socket or folder at a name that is written stays, and no command waits for it.

    One of these is in the place of an output, a lock, or a file of a shard that is read again. A command is refused or
    ends well within a minute. (A pipe or device that is named after -o is written to, and pipes are read here.)
    """
    scene = trial.random.choice(SCENES)
    scene.prepare(trial)
    passing = [name for name in usual(trial.knotdock, scene.name).passing if not BESIDE.match(name)]
    name = trial.random.choice([*scene.outputs, *scene.outputs, *passing])
    path = room_for(trial, name)
    kind = trial.random.choice(["pipe", "pipe", "device", "socket", "folder"])
    make_special(path, kind)
    made, before = path.lstat(), tree(trial.folder)
    is_read = name in scene.words and stat.S_ISFIFO(made.st_mode)
    call = trial.run(*scene.words, watch=drain(path) if is_read else None, clock=60)
    trial.commands[-1] += f"   # {name} is a {kind}"
    if name not in scene.words:
        check_refused(trial, scene, call, before)
    there = path.lstat() if os.path.lexists(path) else None
    is_same = there and (there.st_ino, there.st_mode, there.st_rdev) == (made.st_ino, made.st_mode, made.st_rdev)
    trial.check(is_same, f"{name} was a {kind}, and is another now")
    if kind == "folder":
        trial.check((path / "notes.txt").is_file(), f"the user's notes in {name} are gone")


FOREIGN = ["notes.txt", ".hidden", "top/notes.txt", "top/rank_0001.png", "top/mine/rank_0001.pdb",
           "poses.csv.bak", "top/rank_0003.pdb.partial", "poses.csv.partial"]  # fmt: skip
EDITED = ["poses.csv", "report.html", "top/rank_0001.pdb", "top/rank_0002.pdb"]


def foreign_files(trial):
    """A run with the user's files in its folder, or with edited ones, is not replaced, and --force names them.

    Notes, pictures, links and folders are in the folder of a run, an ensemble or a batch's pair; files of the run are
    edited, or its record is torn. Then it shall be replaced with --force: the call is refused and the run unchanged.
    """
    write_inputs(trial.folder)
    write_thesis(trial)
    kind = trial.random.choice(["dock", "dock", "ensemble", "batch"])
    folder, older, words = {
        "dock": ("run", OLD, [*DOCK, "--force"]),
        "ensemble": ("run", OLD_ALSO, [*ALSO, "--force"]),
        "batch": ("runs/one", OLD_BATCH, ["batch", "pairs.csv", "-o", "runs", "--", *FEW, "--force"]),
    }[kind]
    trial.run(*older, may_fail=False)
    changed = trial.random.sample(FOREIGN, trial.random.choice([0, 1, 1, 2, 3, 5]))
    if kind == "ensemble" and changed and trial.random.random() < 0.5:
        changed[0] = f"members/r1_l2/{changed[0]}"
    for name in changed:
        trial.make(f"{folder}/{name}", f"the user's {name}\n")
    if not changed or trial.random.random() < 0.3:
        changed.append(trial.random.choice(EDITED))
        path = trial.folder / folder / changed[-1]
        path.write_bytes(path.read_bytes() + b"REMARK edited by the user\n")
    if trial.random.random() < 0.2:
        changed.append("mine.csv")
        (trial.folder / folder / "mine.csv").symlink_to(trial.folder / "thesis/chapter.txt")
    is_torn = kind != "ensemble" and trial.random.random() < 0.2
    if is_torn:
        record = trial.folder / folder / "run.json"
        record.write_bytes(record.read_bytes()[: trial.random.choice([0, 1, 200])])
    trial.make("runs/notes.txt" if kind == "batch" else "notes.txt", "the user's notes\n")
    before = tree(trial.folder)
    call = trial.run(*words)
    users = [folder, "thesis", "runs/notes.txt"] if kind == "batch" else list(before)
    kept = [{name: entries[name] for unit in users for name in below(entries, unit)}
            for entries in (tree(trial.folder), before)]  # fmt: skip
    trial.check(not (lost := differences(*kept)), f"with {changed} in {folder}: {lost}")
    if kind == "batch":
        trial.check(call.code != 0, f"{changed} in {folder}, and the batch ends well")
        return
    trial.check(call.code == 2, f"{changed} in {folder}, and the call ends with {call.code}")
    named = [name for name in changed if name in call.err]
    is_named = len(named) == len(changed) if len(changed) <= 3 else named
    trial.check(is_torn or is_named, f"of {changed} the error names {named}: {call.err.strip()[-300:]}")


def other_folders(trial):
    """A folder that holds anything but an older result of the command is refused, and nothing in it changes.

    dock, tradeoff, batches and shards, with and without --force, into a user's folder, the current one, the results of
    another command, and a batch of another table. For the latter the error names the pairs that differ.
    """
    write_inputs(trial.folder)
    write_thesis(trial)
    trial.run(*DOCK, may_fail=False)
    trial.run(*OLD_BATCH, may_fail=False)
    target = trial.random.choice(["thesis", ".", f"../{trial.folder.name}", "run", "runs", "top", "another table"])
    words = {"dock": [*DOCK], "tradeoff": [*SWEEP], "batch": [*OLD_BATCH], "shard": shard("1/2")}
    if target == "top":
        target = "run/top"
    elif target in ("run", "runs"):
        del words["dock" if target == "run" else "batch"]
    if target == "another table":
        target, words = "runs", {"batch": [*OLD_BATCH]}
        words["batch"][1] = "others.csv"
        table = (trial.folder / "pairs.csv").read_text()
        trial.make("others.csv", table.replace("ligand.pdb,receptor.pdb,two", "ligand.pdb,other.pdb,two"))
    kind = trial.random.choice(list(words))
    call = words[kind]
    call[call.index("-o") + 1] = target
    before = tree(trial.folder)
    call = trial.run(*call, *trial.random.choice([[], ["--force"]]))
    trial.check(call.code == 2, f"{kind} into {target} ends with {call.code}")
    trial.check("others.csv" not in before or "two" in call.err, f"no word of the pair: {call.err.strip()[-300:]}")
    wrong = differences(tree(trial.folder), before)
    trial.check(not wrong, f"{kind} into {target}: {wrong}")


def edited_files(trial):
    """`export`, `refine`, `report` and `merge` without --force replace no file that was edited, nor another one.

    Files that these commands have written or would write are edited, or replaced by the user's files or links; then the
    command is called again. One that is refused changes nothing.
    """
    write_inputs(trial.folder)
    write_thesis(trial)
    first = trial.random.randint(1, 12)
    ranks = f"{first}-{trial.random.randint(first, 12)}"
    complexes = [f"rank_{rank:04}.pdb" for rank in range(1, 13)]
    before, words, names = trial.random.choice([
        ([DOCK], ["export", "run", "--rank", ranks], [f"run/top/{name}" for name in complexes]),
        ([DOCK], ["export", "run", "--rank", ranks, "-o", "thesis"], [f"thesis/{name}" for name in complexes]),
        ([DOCK], ["refine", "run", "--ranks", "1,2"],
         [f"run/refined/{name}" for name in [*complexes[:2], "refined.csv"]]),
        ([DOCK], ["report", "run"], ["run/report.html"]),
        ([shard("1/1")], ["merge", "many"], ["many/results.csv", "many/poses.csv.gz"]),
    ])  # fmt: skip
    for call in before:
        trial.run(*call, may_fail=False)
    if trial.random.random() < 0.7:
        trial.run(*words)
    users = {}
    for name in names:
        path = trial.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        change = trial.random.choice(["edit", "replace", "link", None, None])
        if change == "edit" and path.exists():
            path.write_bytes(path.read_bytes() + b"REMARK edited by the user\n")
        elif change == "replace":
            path.write_text("a file of the user's\n")
        elif change == "link":
            path.unlink(missing_ok=True)
            path.symlink_to(trial.folder / f"thesis/mine_{path.name}")
        else:
            continue
        users[name] = tree(trial.folder)[name]
    there = tree(trial.folder)
    users |= below(there, "thesis")
    call = trial.run(*words)
    found = tree(trial.folder)
    lost = differences({name: found[name] for name in users if name in found}, users)
    trial.check(not lost, f"of the user's: {lost}")
    wrong = differences(found, there) if call.code == 2 else ""
    trial.check(not wrong, f"refused, and {wrong}")
