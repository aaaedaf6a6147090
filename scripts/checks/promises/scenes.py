"""Small inputs, and the calls that write files: the results of each, with and without an older result in its place."""

import functools
import shutil
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from promises.folders import Watch, comparable, tree
from promises.trial import ROOT, Trial

CASES = ROOT / "tests/scoring_table/cases"
EXAMPLES = ROOT / "structures/examples"

BLOCK = [(0, 0), (6, 0), (6, 4), (4, 4), (3.4, 2), (2.2, 2), (2, 4), (0, 4)]  # with a groove
KEY = [(9, 1), (10, 1), (10.5, 2.8), (10.5, 4), (9, 4)]


def prism(outline, height):
    """OBJ text of an outline (corners counterclockwise) drawn up to a height: a closed mesh."""
    n = len(outline)
    lines = [f"v {x} {y} {z}" for z in (0, height) for x, y in outline]
    faces = [range(n, 0, -1), range(n + 1, 2 * n + 1)]
    faces += [(i + 1, (i + 1) % n + 1, n + (i + 1) % n + 1, n + i + 1) for i in range(n)]
    return "\n".join(lines + ["f " + " ".join(map(str, face)) for face in faces]) + "\n"


PAIRS = "receptor,ligand,name\nreceptor.pdb,ligand.pdb,one\nligand.pdb,receptor.pdb,two\n"


def write_inputs(folder):
    """Writes two small proteins of helices, a copy, their complex, two meshes and a table of pairs into a folder."""
    for side in ("receptor", "ligand"):
        shutil.copy(CASES / f"helices_{side}.pdb", folder / f"{side}.pdb")
    shutil.copy(folder / "ligand.pdb", folder / "other.pdb")
    texts = [(folder / f"{side}.pdb").read_text().replace("END\n", "") for side in ("receptor", "ligand")]
    moved = texts[1].replace(" ALA A ", " ALA C ")
    (folder / "native.pdb").write_text(texts[0] + moved + "END\n")
    (folder / "block.obj").write_text(prism(BLOCK, 3))
    (folder / "key.obj").write_text(prism(KEY, 2.8))
    (folder / "pairs.csv").write_text(PAIRS)


FEW = ["--rotations", "4", "--poses", "20"]
FEWER = ["--rotations", "3", "--poses", "9"]
DOCK = ["dock", "receptor.pdb", "ligand.pdb", *FEW, "-o", "run"]
OLD = ["dock", "receptor.pdb", "ligand.pdb", *FEWER, "-o", "run"]
ALSO = [*DOCK, "--ligand-also", "other.pdb"]
OLD_ALSO = [*OLD, "--ligand-also", "other.pdb"]
SAMPLE = ["sample", "block.obj", "--grid", "2^10", "-o", "k.csv", "--export", "k.obj", "--picture", "k.svg"]
OLD_SAMPLE = ["sample", "key.obj", "--grid", "2^10", "-o", "k.csv", "--export", "k.obj", "--picture", "k.svg"]
BATCH = ["batch", "pairs.csv", "-o", "runs", "--", *FEW]
OLD_BATCH = ["batch", "pairs.csv", "-o", "runs", "--", *FEWER]
SWEEP = ["tradeoff", "receptor.pdb", "ligand.pdb", "--parameters", "per-rotation", *FEW, "-o", "sweep"]
INSPECT = ["inspect", "receptor.pdb", "--atoms", "atoms.csv", "--write", "kept.pdb"]
EVALUATE = ["evaluate", "run", "--native", "native.pdb", "-o", "measured.csv"]


def shard(part, output="many", few=FEW, scratch=()):
    """A call that docks a part of the table, such as 1/2."""
    return ["batch", "pairs.csv", "-o", output, "--keep", "table", "--shard", part, *scratch, "--", *few]


@dataclass
class Scene:
    """A call that writes files, calls that come before it, and units: entries that are old or new as a whole."""

    name: str
    words: list
    before: list = field(default_factory=list)
    units: tuple = ()
    outputs: tuple = ()  # entries in whose place a link or a special file may be

    @property
    def goes_on(self):
        """Whether it is done in parts that stay where a later one fails, and goes on when it is called again."""
        return self.words[0] == "batch" or self.name == "ensemble"

    def prepare(self, trial):
        write_inputs(trial.folder)
        for words in self.before:
            trial.run(words[0], "-q", *words[1:], may_fail=False)


RUN = ("run", "run/top", "run/poses.csv", "run/run.json", "run/top/rank_0001.pdb", "run/top/rank_0002.pdb")
BALLS = ("k.csv", "k.obj", "k.svg")
SWEPT = ("sweep", "sweep/tradeoff.csv", "sweep/tradeoff.json", "sweep/tradeoff.svg")
BATCHED = ("runs", "runs/batch.json", "runs/results.csv", "runs/attempts.csv", "runs/report.html", "runs/one",
           "runs/one/top", "runs/two/poses.csv")  # fmt: skip
MEMBERS = ("run/members/r1_l1", "run/members/r1_l2")
JOINT = ("run", "run/members", *MEMBERS, "run/poses.csv", "run/top", "run/ensemble.json")
SHARD = "many/shards/0001-of-0002"
SHARDED = ("many", "many/shards", SHARD, f"{SHARD}/batch.json", f"{SHARD}/results.csv", f"{SHARD}/poses.csv.gz",
           f"{SHARD}/attempts.csv")  # fmt: skip
MERGED = ("many/results.csv", "many/poses.csv.gz")
TABLES = ("tables/results.csv", "tables/poses.csv.gz")
MORE = ("more/rank_0002.pdb", "more/rank_0012.pdb")
ADDED = ("run/refined", "run/refined/rank_0001.pdb", "run/refined/refined.csv", "run/added.json")
REFINED = ("run/refined/rank_0001.pdb", "run/refined/rank_0002.pdb", "run/refined/refined.csv")
SCENES = [
    Scene("dock", DOCK, units=("run",), outputs=RUN),
    Scene("dock --force", [*DOCK, "--force"], [OLD], ("run",), RUN),
    Scene("ensemble", ALSO, units=MEMBERS, outputs=JOINT),
    Scene("ensemble --force", [*ALSO, "--force"], [OLD_ALSO], ("run",), JOINT),
    Scene("sample", SAMPLE, units=BALLS, outputs=BALLS),
    Scene("sample --force", [*SAMPLE, "--force"], [OLD_SAMPLE], BALLS, BALLS),
    Scene("batch", BATCH, units=("runs/one", "runs/two"), outputs=BATCHED),
    Scene("batch --force", [*BATCH, "--force"], [OLD_BATCH], ("runs/one", "runs/two"), BATCHED),
    Scene("shard", shard("1/2"), outputs=SHARDED),
    Scene("shard again", shard("1/2"), [shard("1/2")], outputs=SHARDED),
    Scene("shard --scratch", shard("1/2", scratch=("--scratch", "near")), outputs=SHARDED),
    Scene("merge", ["merge", "many"], [shard("1/2"), shard("2/2")], MERGED, (*MERGED, *SHARDED[2:6])),
    Scene("merge --force", ["merge", "many", "-o", "tables", "--force"],
          [shard("1/1", "old", FEWER), ["merge", "old", "-o", "tables"], shard("1/1")], TABLES, ("tables", *TABLES)),
    Scene("export", ["export", "run", "--rank", "11,12"], [DOCK], ("run/top/rank_0011.pdb", "run/top/rank_0012.pdb"),
          ("run/top/rank_0011.pdb", "run/top", "run/added.json")),
    Scene("export --force", ["export", "run", "--rank", "2,12", "-o", "more", "--force"],
          [DOCK, ["export", "run", "--rank", "2", "-o", "more"]], MORE, ("more", *MORE)),
    Scene("refine", ["refine", "run", "--ranks", "1,2"], [DOCK], REFINED, ADDED),
    Scene("refine --force", ["refine", "run", "--ranks", "1,2", "--force"],
          [DOCK, ["refine", "run", "--ranks", "2", "--no-move"]], REFINED, ADDED),
    Scene("tradeoff", SWEEP, units=("sweep",), outputs=SWEPT),
    Scene("tradeoff --force", [*SWEEP, "--force"], [SWEEP], ("sweep",), SWEPT),
    Scene("inspect", INSPECT, units=("atoms.csv", "kept.pdb"), outputs=("atoms.csv", "kept.pdb")),
    Scene("inspect --force", [*INSPECT, "--force"], [INSPECT], ("atoms.csv", "kept.pdb"), ("atoms.csv", "kept.pdb")),
    Scene("evaluate", EVALUATE, [DOCK], ("measured.csv",), ("measured.csv",)),
    Scene("evaluate --force", [*EVALUATE, "--force"], [DOCK, EVALUATE], ("measured.csv",), ("measured.csv",)),
]  # fmt: skip


@dataclass
class Usual:
    """What a scene's call does where nothing is in its way: files before and after, names on the way, duration."""

    old: dict
    new: dict
    passing: list
    seconds: float
    events: int


@functools.cache
def usual(knotdock, name):
    """Runs a scene undisturbed."""
    scene = next(scene for scene in SCENES if scene.name == name)
    with tempfile.TemporaryDirectory() as folder:
        trial = Trial(knotdock, name, 0, 0, Path(folder).resolve(), False)
        scene.prepare(trial)
        old = tree(trial.folder)
        watch = Watch(trial.folder)
        counted = []
        process = trial.start(scene.words[0], "-q", *scene.words[1:])
        call = trial.finish(process, watch=lambda process: counted.append(watch.follow(process)))
        watch.close()
        if call.code or trial.failures:
            raise RuntimeError(f"{trial.commands[-1]} fails undisturbed: {call.err} {trial.failures}")
        new = tree(trial.folder)
        passing = sorted(watch.names - set(old) - set(new))
        old, new = comparable(old, trial.folder), comparable(new, trial.folder)
        return Usual(old, new, passing, call.seconds, sum(counted))
