"""Nothing of the user's is lost: files, folders and links that lie where the program writes."""

import os

from promises.folders import differences, tree
from promises.scenes import DOCK, FEW, SCENES, usual, write_inputs

# Fixed names that earlier versions wrote under, and that others may come to use.
GUESSES = ["{parent}/.partial", "{parent}/.{name}.partial", "{parent}/{name}.partial", "{parent}/{name}.tmp"]
KINDS = ["file", "folder", "link to a file", "link to a folder", "dangling link", "hard link"]


def write_thesis(trial):
    """A folder of the user's whose files have the names of a run's."""
    for name in ("chapter.txt", "poses.csv", "run.json", "k.csv", "lock", "top/notes.txt"):
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


def names_on_the_way(trial):
    """No file, folder or link of the user's is lost or followed that has a name the program writes under.

    Names that each command passes through are recorded by inotify. Then files, folders and links to a folder of the
    user's lie there (with the number of the process, where a name has one) before the command runs.
    """
    scene = trial.random.choice(SCENES)
    scene.prepare(trial)
    write_thesis(trial)
    names = names_to_take(trial, scene)
    chosen = [name for name in names if trial.random.random() < 0.5] or names[:1]
    # Those above first, so that a link to a folder comes before what would lie in it.
    plan = [(name, trial.random.choice(KINDS)) for name in chosen]
    plan = [(name, kind) for name, kind in plan if not any(name.startswith(f"{other}/") for other, _ in plan)]
    for name, kind in plan:
        if "PID" not in name:
            plant(trial.folder, name, kind)
    before = tree(trial.folder)

    def with_number():
        for name, kind in plan:
            if "PID" in name:
                plant(trial.folder, name.replace("PID", str(os.getpid())), kind)

    call = trial.run(*scene.words, before=with_number)
    users = {name: content for name, content in before.items() if not is_output(name, scene, plan)}
    for name, kind in plan:
        own = name.replace("PID", str(call.pid))
        if "PID" in name and kind == "file":
            users[own] = f"the user's {own}\n".encode()
    lost = differences({name: content for name, content in tree(trial.folder).items() if name in users}, users)
    trial.check(not lost, f"of the user's: {lost} (there were {', '.join(f'{name}: {kind}' for name, kind in plan)})")


def is_output(name, scene, plan):
    """Whether an entry is one that the scene's call may replace: all below its outputs but what was planted."""
    if any(name == planted or name.startswith(f"{planted}/") for planted, _ in plan):
        return False
    return any(name == output or name.startswith(f"{output}/") for output in scene.outputs)


def links_for_outputs(trial):
    """No command writes through a link that the user did not name, nor removes what one leads to, --force or not.

    A link to a file or folder of the user's stands in the place of one of the command's outputs. (A link that is
    named after -o is followed with --force, as by other programs; without it the command is refused.)
    """
    scene = trial.random.choice(SCENES)
    scene.prepare(trial)
    write_thesis(trial)
    output = trial.random.choice(scene.outputs)
    words = scene.words if output not in scene.words else [word for word in scene.words if word != "--force"]
    path = trial.folder / output
    path.parent.mkdir(parents=True, exist_ok=True)
    is_folder = output in ("run", "run/top", "runs", "runs/one", "runs/one/top", "more", "sweep")
    if path.exists():
        path.rename(trial.folder / "set_aside")
    up = os.path.relpath(trial.folder / "thesis", path.parent)
    path.symlink_to(up if is_folder else f"{up}/{trial.random.choice(['chapter.txt', 'poses.csv', 'later.txt'])}")
    before = tree(trial.folder, "thesis")
    trial.run(*words)
    after = tree(trial.folder, "thesis")
    if output in ("run", "runs", "more", "sweep"):
        # The user gave a folder by a link: the command may add to it.
        after = {name: content for name, content in after.items() if name in before}
    lost = differences(after, before)
    trial.check(not lost, f"{output} was a link to the user's {path.readlink() if path.is_symlink() else up}: {lost}")


FOREIGN = ["notes.txt", ".hidden", "top/notes.txt", "top/rank_0001.png", "top/mine/rank_0001.pdb",
           "poses.csv.bak", "top/rank_0003.pdb.partial", "poses.csv.partial"]  # fmt: skip


def foreign_files(trial):
    """Files of the user's in a run's folder and in its top/ survive --force, batch and export.

    Notes, pictures and folders of the user's lie in the folder of an older run, and files of the run are edited; then
    it is replaced or added to. The user's files stay where they are, edited ones there or under another name.
    """
    write_inputs(trial.folder)
    is_batch = trial.random.random() < 0.3
    folder = "runs/one" if is_batch else "run"
    first = ["--rotations", "3", "--poses", "9"]
    calls = {
        "dock": (["dock", "receptor.pdb", "ligand.pdb", *first, "-o", "run"], [*DOCK, "--force"]),
        "export": (DOCK, ["export", "run", "--rank", "1-12", "--force"]),
        "batch": (["batch", "pairs.csv", "-o", "runs", "--", *first],
                  ["batch", "pairs.csv", "-o", "runs", "--", *FEW, "--force"]),
    }  # fmt: skip
    before, words = calls["batch" if is_batch else trial.random.choice(["dock", "export"])]
    trial.run(*before, may_fail=False)
    users = {}
    for name in FOREIGN:
        if trial.random.random() < 0.6:
            name = f"{folder}/{name}"
            users[name] = trial.make(name, f"the user's {name}\n").read_bytes()
    edited = []
    if "export" not in words and trial.random.random() < 0.5:
        path = trial.folder / folder / trial.random.choice(["poses.csv", "top/rank_0001.pdb", "top/rank_0002.pdb"])
        edited.append(path.read_bytes() + b"REMARK edited by the user\n")
        path.write_bytes(edited[0])
    for _ in range(trial.random.choice([1, 1, 2])):
        trial.run(*words)
    found = tree(trial.folder)
    trial.check(all(content in found.values() for content in edited), "a file of the run that was edited is nowhere")
    lost = differences({name: found[name] for name in users if name in found}, users)
    trial.check(not lost, f"of the user's: {lost}")


def edited_complexes(trial):
    """`export` without --force overwrites no complex that was edited, nor another file of that name.

    Complexes of a run are edited, or replaced by files or links of the user's; then ranks are exported again.
    """
    write_inputs(trial.folder)
    write_thesis(trial)
    trial.run(*DOCK, may_fail=False)
    users = {}
    for rank in range(1, 13):
        name = f"run/top/rank_{rank:04}.pdb"
        path = trial.folder / name
        change = trial.random.choice(["edit", "replace", "link", None, None])
        if change == "edit" and path.exists():
            path.write_bytes(path.read_bytes() + b"REMARK edited by the user\n")
        elif change == "replace":
            path.write_text("a file of the user's\n")
        elif change == "link":
            path.unlink(missing_ok=True)
            path.symlink_to(f"../../thesis/rank_{rank:04}.pdb")
        else:
            continue
        users[name] = tree(trial.folder)[name]
    users |= {f"thesis/{name}": content for name, content in tree(trial.folder / "thesis").items()}
    first = trial.random.randint(1, 12)
    trial.run("export", "run", "--rank", f"{first}-{trial.random.randint(first, 12)}")
    found = tree(trial.folder)
    lost = differences({name: found[name] for name in users if name in found}, users)
    trial.check(not lost, f"of the user's: {lost}")
