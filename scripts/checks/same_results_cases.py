"""The cases of same_results.py, and the names that changed.

They are those of the change to schema 2 of poses.csv and run.json: from commit 2dbb827 on.
"""

import re
from dataclasses import dataclass

# Old name: new name; None for columns and keys that were dropped on purpose.
COMMANDS = {"complex": "export"}
OPTIONS = {
    "--from": "--rerun",
    "--attract-receptor": "--active-receptor",
    "--attract-ligand": "--active-ligand",
}
COLUMNS = {  # of poses.csv, of its rows in JSON, and of other tables
    "score": "search_score",
    "rank_score": "pose_score",
    "attraction": "active_residues",
    "missing": "unresolved",
    "chain_ends": "termini",
}
KEYS = {
    "attraction_weight": "active_weight",
    "missing_weight": "unresolved_weight",
    "chain_end_weight": "termini_weight",
    "attract_receptor": "active_receptor",
    "attract_ligand": "active_ligand",
    "every_pose": "no_cluster",
    "chance_acceptable_in_10": None,
    "missing_residues": "unresolved_residues",
    "chain_end_residues": "terminus_residues",
    "told_by": "source",
    "sample_grid": None,
}  # of JSON: a key, or keys in one another ("options.every_pose"); new groups of options need no entry
VALUES = {}  # words that are a whole value

ADDED_COLUMNS = set()  # new columns without an old one
ADDED_KEYS = {
    "diagnostics",
    "pose_terms",
    "acceptable",
    "near_native",
    "sample_grid",
}  # new keys without an old one, at any depth
DIAGNOSTICS = {  # columns that tables lack without --diagnostics
    "refined", "rotation", "score_grid", "score_unfiltered", "slice_0", "slice_r0", "slice_2r0", "cluster_score",
}  # fmt: skip

# Not compared: times, memory, the machine, dates, versions, paths, and checksums of inputs (some are complexes of an
# earlier command, whose remarks may change).
NOT_COMPARED = re.compile(
    r"(.*\.)?((timing|machine)\..*|schema|version|commit|path|sha256|\w*(seconds|bytes)(_\w+)?|steps\[.*)"
)
SENTENCES = re.compile(r"(.*\.)?(reason|warnings|reading_notes)")  # may be reworded


@dataclass
class Case:
    """Commands that run one after another in a folder of their own; with `plain` without --diagnostics."""

    name: str
    commands: list
    plain: bool = False

    @property
    def clustered(self):
        return not any("--no-cluster" in command for command in self.commands)


EXAMPLE = "{examples}/1ppe_receptor_unbound.pdb {examples}/1ppe_ligand_unbound.pdb"
BOUND = "--native-receptor {examples}/1ppe_receptor_bound.pdb --native-ligand {examples}/1ppe_ligand_bound.pdb"
POSE = "--pose 0.757546,0.039542,0.598151,-0.258411,10.492964,23.925832,10.881865"


def native(pair):
    bound = f"{{pairs}}/{pair}/%s_bound.pdb.gz"
    return f"--native-receptor {bound % 'receptor'} --native-ligand {bound % 'ligand'}"


def dock(pair, options="--rotations 600"):
    files = f"{{pairs}}/{pair}/receptor_unbound.pdb.gz {{pairs}}/{pair}/ligand_unbound.pdb.gz"
    return f"dock {files} {native(pair)} {options} -o run"


CASES = [
    Case(
        "example",
        [
            f"dock {EXAMPLE} {BOUND} -o run",
            "complex run --rank 37,40-42",
            "complex run --rank 11 -o more",
        ],
    ),
    Case("plain_table", [f"dock {EXAMPLE} {BOUND} --rotations 300 -o run"], plain=True),
    Case("peptidase_3SGQ", [dock("3SGQ")]),
    Case("nucleotide_1LFD", [dock("1LFD")]),
    Case("receptor_1KTZ", [dock("1KTZ")]),
    Case("enzyme_1UDI", [dock("1UDI")]),
    Case("gaps_1XD3", [dock("1XD3")]),
    Case("antibody_1VFB", [dock("1VFB")]),
    Case(
        "residues_1FFW",
        [
            dock("1FFW", "--rotations 300 --attract-receptor A:90,95-99 --attract-ligand B:20 --block-ligand B:1-10"),
            "dock --from run/run.json -o again",
        ],
    ),
    Case("refined_1FFW", [dock("1FFW", "--rotations 300 --refine 50")]),
    Case("finer_3SGQ", [dock("3SGQ", "--rotations 300 --fine-rotations 3600 --poses 500")]),
    Case(
        "every_pose_1KTZ",
        [
            dock("1KTZ", "--rotations 300 --no-cluster --write-top 3"),
            f"evaluate run {native('1KTZ')} -o measured.csv",
            "complex run --rank 5",
        ],
    ),
    Case("shape_1KTZ", [dock("1KTZ", "--rotations 120 --effects shape --precision double --tolerance 1e-3")]),
    Case(
        "mmcif",
        [
            "inspect {examples}/1ppe_ligand_unbound.pdb --write ligand.cif --atoms atoms.csv",
            "dock {examples}/1ppe_receptor_unbound.pdb ligand.cif --rotations 300 --write-top 2 -o run",
            f"evaluate run {BOUND} -o measured.csv",
        ],
    ),
    Case(
        "rings",
        [
            "dock {examples}/4e43_molecule.pdb --symmetry C2 --rotations 200 --poses 200 -o ring"
            " --native {examples}/4e43_dimer.pdb",
            "dock ring/top/rank_0001.pdb --symmetry D2 --rotations 20 --poses 60 --write-top 2 -o tetramer",
            "dock {examples}/1ppe_ligand_unbound.pdb --symmetry C4 --rotations 100 --poses 100 --write-top 2 -o four",
            "dock {examples}/1ppe_ligand_unbound.pdb --symmetry C3 --rotations 100 --poses 100 --write-top 2 -o three",
        ],
    ),
    Case(
        "meshes",
        [
            "dock block.obj key.obj --sample-grid 2^15 --rotations 600 --poses 200 --refine 10 --write-top 2 -o run",
            "complex run --rank 3",
        ],
    ),
    Case("batch", ["batch {examples}/pairs.csv -o runs -- --rotations 200 --poses 300 --write-top 1"]),
    Case(
        "score",
        [
            f"score {EXAMPLE} {POSE}",
            f"score {EXAMPLE} {POSE} --attract-receptor A:57,195 --block-ligand B:1-3 --order magnitude --spacing 3",
        ],
    ),
    Case(
        "sample",
        [
            "sample {examples}/bunny.obj --grid 2^12 --weights fitted --export balls.obj -o knots.csv",
            "sample {examples}/bunny.obj --grid 2^12 --level 20 --export balls.pdb -o level.csv",
            "sample block.obj --grid 2^12 --method octree -o octree.csv",
        ],
    ),
    Case(
        "inspect",
        [
            "inspect {examples}/4e43_molecule.pdb --atoms atoms.csv --write written.pdb",
            "inspect {pairs}/1VFB/receptor_unbound.pdb.gz --ph 6",
            "inspect {pairs}/1LFD/receptor_unbound.pdb.gz --hetatm drop",
            "inspect {pairs}/3SGQ/receptor_unbound.pdb.gz",
        ],
    ),
]


def write_prism(path, outline, height):
    """Writes the outline (corners counterclockwise) drawn up to a height as a closed OBJ mesh."""
    n = len(outline)
    lines = [f"v {x} {y} {z}" for z in (0, height) for x, y in outline]
    faces = [range(n, 0, -1), range(n + 1, 2 * n + 1)]
    faces += [(i + 1, (i + 1) % n + 1, n + (i + 1) % n + 1, n + i + 1) for i in range(n)]
    path.write_text("\n".join(lines + ["f " + " ".join(map(str, face)) for face in faces]) + "\n")


def write_meshes(folder):
    """Writes a block with a groove, and a key that fits into it and lies elsewhere."""
    write_prism(folder / "block.obj", [(0, 0), (6, 0), (6, 4), (4, 4), (3.4, 2), (2.2, 2), (2, 4), (0, 4)], 3)
    write_prism(folder / "key.obj", [(9, 1), (10, 1), (10.5, 2.8), (10.5, 4), (9, 4)], 2.8)
