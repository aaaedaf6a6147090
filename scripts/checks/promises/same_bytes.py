"""The same input and options give the same bytes: for any number of threads, again, and from the record of a run."""

import json

from promises.folders import comparable, differences, tree
from promises.scenes import write_inputs

COUNTS = ["1", "2", "3", "7"]
GLOBAL = [None, "0", "1", "100000"]  # RAYON_NUM_THREADS, which no result depends on


def random_dock(trial):
    """A docking of molecules, meshes or a ring, with options at random; without the folder of its run."""
    pick = trial.random.choice
    kind = pick(["molecules", "molecules", "meshes", "ring"])
    options = ["--rotations", pick([3, 5, 8]), "--poses", pick([7, 20, 60]), "--per-rotation", pick([1, 3, 6])]
    options += pick([[], ["--no-cluster"]]) + pick([[], ["--diagnostics"]])
    if kind == "meshes":
        return ["dock", "block.obj", "key.obj", "--sample-grid", "2^14", *options, "--refine", pick([0, 4])]
    if kind == "ring":
        return ["dock", "ligand.pdb", "--symmetry", pick(["C2", "C3"]), *options]
    options += pick([[], ["--effects", "shape", "--refine", "6"], ["--active-receptor", "A:3,B:105"]])
    options += pick([[], ["--fine-rotations", "100"], ["--precision", "double", "--tolerance", "1e-3"]])
    options += pick([[], ["--native", "native.pdb"]])
    return ["dock", "receptor.pdb", "ligand.pdb", *options]


def random_sample(trial):
    """A sampling of a mesh, with options at random."""
    pick = trial.random.choice
    options = ["--grid", pick(["2^9", "2^11"]), "--method", pick(["bi", "octree", "voxels"])]
    options += pick([[], ["--weights", "fitted"], ["--level", "9"]])
    return ["sample", pick(["block.obj", "key.obj"]), *options]


def results(trial, folder):
    """Files of a folder, less times, the machine and the folder's name."""
    return comparable(tree(trial.folder / folder), trial.folder)


def run_into(trial, words, folder, environment=None):
    """Runs a docking or sampling whose results all go into a folder."""
    (trial.folder / folder).mkdir()
    if words[0] == "sample":
        output = ["-o", f"{folder}/k.csv", "--export", f"{folder}/k.obj", "--picture", f"{folder}/k.svg"]
    else:
        output = ["-o", f"{folder}/run"]
    environment = {key: value for key, value in (environment or {}).items() if value is not None}
    trial.run(*words, *output, environment=environment, may_fail=False)
    return results(trial, folder)


def compare(trial, one, other, words):
    wrong = differences(one, other)
    trial.check(bool(other) and not wrong, f"{words}: {wrong}")


def any_threads(trial):
    """Results are the same bytes for any number of threads, whatever RAYON_NUM_THREADS says.

    Molecules, meshes and rings are docked and meshes sampled with random options, with --threads 1, 2, 3, 7 or none
    and RAYON_NUM_THREADS of 0, 1, 100000 or none; all files but for times and the machine are compared.
    """
    write_inputs(trial.folder)
    words = random_dock(trial) if trial.random.random() < 0.75 else random_sample(trial)
    of_all = trial.random.choice(GLOBAL)
    if words[0] == "sample":
        settings = [([], "1"), ([], of_all)]
    else:
        few, many = trial.random.sample(COUNTS, 2)
        settings = [(["--threads", few], None), (["--threads", many], of_all)]
    one, other = [run_into(trial, [*words, *threads], f"run{place}", {"RAYON_NUM_THREADS": count})
                  for place, (threads, count) in enumerate(settings)]  # fmt: skip
    compare(trial, other, one, f"{settings}")


def again(trial):
    """A run gives the same bytes again, and --rerun repeats it from its record.

    Docking with random options, twice and by --rerun, with another number of threads; all files are compared.
    """
    write_inputs(trial.folder)
    words = random_dock(trial)
    first = run_into(trial, words, "first")
    compare(trial, run_into(trial, words, "second"), first, "again")
    rerun = ["dock", "--rerun", "first/run/run.json", "--threads", trial.random.choice(COUNTS)]
    compare(trial, run_into(trial, rerun, "third"), first, "--rerun")
    record = trial.folder / "first/run/run.json"
    if record.is_file():
        said = json.loads(record.read_bytes())
        rows = (trial.folder / "first/run/poses.csv").read_text().count("\n") - 1
        trial.check(said["results"]["rows"] == rows, f"run.json has {said['results']['rows']} rows, poses.csv {rows}")
