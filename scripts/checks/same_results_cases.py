"""The cases of same_results.py: commands that run one after another in a folder of their own.

{pairs} is the folder of benchmark pairs, {examples} that of the repository, {inputs} what `write_inputs` writes.
"""

EXAMPLE = "{examples}/1ppe_receptor_unbound.pdb {examples}/1ppe_ligand_unbound.pdb"
BOUND = "--native-receptor {examples}/1ppe_receptor_bound.pdb --native-ligand {examples}/1ppe_ligand_bound.pdb"
POSE = "--pose 0.757546,0.039542,0.598151,-0.258411,10.492964,23.925832,10.881865"
SOLIDS = "{inputs}/block.obj {inputs}/key.obj --grid 2^9"


def native(pair):
    bound = f"{{pairs}}/{pair}/%s_bound.pdb.gz"
    return f"--native-receptor {bound % 'receptor'} --native-ligand {bound % 'ligand'}"


def dock(pair, options="--rotations 300"):
    files = f"{{pairs}}/{pair}/receptor_unbound.pdb.gz {{pairs}}/{pair}/ligand_unbound.pdb.gz"
    return f"dock {files} {native(pair)} {options} --diagnostics -o run"


CASES = {
    "example": [
        f"dock {EXAMPLE} {BOUND} --rotations 600 --diagnostics -o run",
        "export run --rank 37,40-42",
        "export run --rank 11 -o more",
        "export run --rank 1-3 --format ensemble",
        "refine run --ranks 1,4",
        "interface run/top/rank_0001.pdb run/top/rank_0002.pdb -o interface.csv --contacts contacts.csv",
    ],
    "plain_table": [f"dock {EXAMPLE} {BOUND} --rotations 120 -o run"],
    "peptidase_3SGQ": [dock("3SGQ")],
    "nucleotide_1LFD": [dock("1LFD")],
    "receptor_1KTZ": [dock("1KTZ")],
    "enzyme_1UDI": [dock("1UDI")],
    "gaps_1XD3": [dock("1XD3")],
    "antibody_1VFB": [dock("1VFB")],
    "residues_1FFW": [
        dock("1FFW", "--rotations 300 --active-receptor A:90,95-99 --active-ligand B:20 --block-ligand B:1-10"),
        "dock --rerun run/run.json -o again",
    ],
    "refined_1FFW": [dock("1FFW", "--rotations 120 --refine 50")],
    "finer_3SGQ": [dock("3SGQ", "--rotations 120 --fine-rotations 1200 --poses 300")],
    "every_pose_1KTZ": [
        dock("1KTZ", "--rotations 120 --no-cluster --write-top 3"),
        f"evaluate run {native('1KTZ')} -o measured.csv",
        "export run --rank 5",
    ],
    "shape_1KTZ": [dock("1KTZ", "--rotations 120 --effects shape --precision double --tolerance 1e-3")],
    "mmcif": [
        "inspect {examples}/1ppe_ligand_unbound.pdb --write ligand.cif --atoms atoms.csv",
        "dock {examples}/1ppe_receptor_unbound.pdb ligand.cif --rotations 120 --write-top 2 -o run",
        f"evaluate run {BOUND} -o measured.csv",
        f"evaluate run/top/rank_0001.cif run/top/rank_0002.cif {BOUND}",
    ],
    "rings": [
        "dock {examples}/4e43_molecule.pdb --symmetry C2 --rotations 100 --poses 100 -o ring"
        " --native {examples}/4e43_dimer.pdb",
        "dock ring/top/rank_0001.pdb --symmetry D2 --rotations 20 --poses 60 --write-top 2 -o tetramer",
        "dock {examples}/1ppe_ligand_unbound.pdb --symmetry C3 --rotations 60 --poses 60 --write-top 2 -o three",
        "dock {examples}/1ppe_ligand_unbound.pdb --symmetry C4 --rotations 60 --poses 60 --write-top 2 -o four",
    ],
    "meshes": [
        "dock {inputs}/block.obj {inputs}/key.obj --sample-grid 2^15 --rotations 120 --poses 100 --refine 10"
        " --write-top 2 -o run",
        "export run --rank 3",
    ],
    "ensemble": [
        f"dock {EXAMPLE} --ligand-also {{examples}}/1ppe_ligand_bound.pdb {BOUND} --rotations 120 --write-top 3 -o run",
        "export run --rank 5",
    ],
    "batch": ["batch {inputs}/pairs.csv -o runs -- --rotations 120 --poses 300 --write-top 1"],
    "table": ["batch {inputs}/pairs.csv -o runs -j 1 --keep top --rows 50 -- --rotations 60 --write-top 1"],
    "shards": [
        "batch {inputs}/pairs.csv -o runs -j 1 --keep table --rows 50 --shard 1/2 -- --rotations 60",
        "batch {inputs}/pairs.csv -o runs -j 1 --keep table --rows 50 --shard 2/2 -- --rotations 60",
        "merge runs",
    ],
    "score": [
        f"score {EXAMPLE} {POSE} --spacing 3",
        f"score {EXAMPLE} {POSE} --active-receptor A:57,195 --block-ligand B:1-3 --order magnitude --spacing 3",
    ],
    "interface": ["interface {examples}/4e43_dimer.pdb -o interface.csv --contacts contacts.csv"],
    "models": ["models {examples}/4e43_dimer.pdb -o models.csv"],
    "sample": [
        "sample {examples}/bunny.obj --grid 2^12 --weights fitted --export balls.obj -o knots.csv",
        "sample {examples}/bunny.obj --grid 2^12 --level 20 --export balls.pdb -o level.csv",
        "sample {inputs}/block.obj --grid 2^12 --method octree -o octree.csv",
    ],
    "collide": [
        f"collide {SOLIDS} --path {{inputs}}/path.csv -o path.csv",
        f"collide {SOLIDS} --poses {{inputs}}/path.csv --method modes",
        "collide {examples}/1ppe_receptor_bound.pdb {examples}/1ppe_ligand_bound.pdb",
    ],
    "obstacle": [f"obstacle {SOLIDS} --reduce --gap-grid 8 --cells 24 --surface obstacle.obj -o obstacle.csv"],
    "morph": [
        "morph offset {inputs}/block.obj --distance 0.5 --grid 2^9 --cells 24 --volume-grid grown.vtk -o grown.csv",
        "morph offset {inputs}/block.obj --distance -0.5 --grid 2^9 --complement-grid 2^9 -o shrunk.csv",
        f"morph sum {SOLIDS} -o sum.csv",
        f"morph difference {SOLIDS} --complement-grid 2^9 -o difference.csv",
        "morph sweep {inputs}/key.obj --path {inputs}/path.csv --step 2 --grid 2^9 -o sweep.csv",
        "se3 ball 1,0,0,0,0,0,0 --radius 0.2 --count 5 -o ball.csv",
        "morph product {inputs}/key.obj --poses ball.csv --grid 2^9 -o product.csv",
    ],
    "inspect": [
        "inspect {examples}/4e43_molecule.pdb --atoms atoms.csv --write written.pdb",
        "inspect {pairs}/1VFB/receptor_unbound.pdb.gz --ph 6",
        "inspect {pairs}/1LFD/receptor_unbound.pdb.gz --hetatm drop",
        "inspect {pairs}/3SGQ/receptor_unbound.pdb.gz",
    ],
}


def prism(outline, height):
    """OBJ mesh of an outline (corners counterclockwise) drawn up to a height."""
    n = len(outline)
    lines = [f"v {x} {y} {z}" for z in (0, height) for x, y in outline]
    faces = [range(n, 0, -1), range(n + 1, 2 * n + 1)]
    faces += [(i + 1, (i + 1) % n + 1, n + (i + 1) % n + 1, n + i + 1) for i in range(n)]
    return "\n".join(lines + ["f " + " ".join(map(str, face)) for face in faces]) + "\n"


def write_inputs(folder, pairs):
    """Writes a block with a groove, a key that fits into it and is elsewhere, its path, and a table of pairs."""
    folder.mkdir(parents=True, exist_ok=True)
    block = prism([(0, 0), (6, 0), (6, 4), (4, 4), (3.4, 2), (2.2, 2), (2, 4), (0, 4)], 3)
    key = prism([(9, 1), (10, 1), (10.5, 2.8), (10.5, 4), (9, 4)], 2.8)
    path = "qw,qx,qy,qz,tx,ty,tz\n1,0,0,0,-16,0,0\n1,0,0,0,-6,0,0\n0.8,0,0,0.6,-3,0,0\n"
    files = [f"{side}_{state}" for state in ("unbound", "bound") for side in ("receptor", "ligand")]
    table = "name,receptor,ligand,native_receptor,native_ligand\n"
    for pair in ("1FFW", "1KTZ", "3SGQ"):
        table += ",".join([pair, *(f"{pairs}/{pair}/{file}.pdb.gz" for file in files)]) + "\n"
    for name, text in {"block.obj": block, "key.obj": key, "path.csv": path, "pairs.csv": table}.items():
        (folder / name).write_text(text)
