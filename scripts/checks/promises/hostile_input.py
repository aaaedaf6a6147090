"""Inputs that are damaged or made to harm."""

import csv
import functools
import io
import re
import struct
import tempfile
from pathlib import Path

from promises.folders import tree
from promises.mutations import mutated, mutated_gzip, mutated_json
from promises.scenes import BLOCK, CASES, DOCK, FEW, INSPECT, PAIRS, prism, write_inputs
from promises.trial import ROOT, Trial

OPTIONS = """[search]
rotations = 4
per_rotation = 2

[terms]
contact_weight = 1.5
ph = 6.5

[restraints]
active_receptor = "A:3,B:105"

[ranking]
cluster_radius = 4.0
no_cluster = true

[machine]
threads = 1
memory = "1GiB"
"""
TABLE = "rank,qw,qx,qy,qz,tx,ty,tz\n1,1,0,0,0,0,0,0\n2,0.5,0.5,-0.5,0.5,1.5,-2,30\n"


def solid():
    """Vertices and faces (numbers from 0) of a block with a groove."""
    lines = [line.split() for line in prism(BLOCK, 3).splitlines()]
    vertices = [[float(word) for word in line[1:]] for line in lines if line[0] == "v"]
    faces = [[int(word) - 1 for word in line[1:]] for line in lines if line[0] == "f"]
    return vertices, faces


def triangles(faces):
    return [(face[0], face[k], face[k + 1]) for face in faces for k in range(1, len(face) - 1)]


def text_stl():
    vertices, faces = solid()
    text = "solid block\n"
    for corners in triangles(faces):
        text += "facet normal 0 0 0\nouter loop\n"
        text += "".join(f"vertex {' '.join(map(str, vertices[corner]))}\n" for corner in corners)
        text += "endloop\nendfacet\n"
    return (text + "endsolid block\n").encode()


def binary_stl():
    vertices, faces = solid()
    records = [struct.pack("<12fH", 0, 0, 0, *(x for corner in corners for x in vertices[corner]), 0)
               for corners in triangles(faces)]  # fmt: skip
    return b"block".ljust(80) + struct.pack("<I", len(records)) + b"".join(records)


def ply():
    vertices, faces = solid()
    axes = "".join(f"property float {axis}\n" for axis in "xyz")
    head = f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\n{axes}element face {len(faces)}\n"
    head += "property list uchar int vertex_indices\nend_header\n"
    rows = [" ".join(map(str, vertex)) for vertex in vertices] + [" ".join(map(str, [len(f), *f])) for f in faces]
    return (head + "\n".join(rows) + "\n").encode()


def off():
    vertices, faces = solid()
    rows = [" ".join(map(str, vertex)) for vertex in vertices] + [" ".join(map(str, [len(f), *f])) for f in faces]
    return (f"OFF\n{len(vertices)} {len(faces)} 0\n" + "\n".join(rows) + "\n").encode()


@functools.cache
def written(knotdock):
    """A structure as mmCIF and the record of a run, as the program writes them."""
    with tempfile.TemporaryDirectory() as folder:
        trial = Trial(knotdock, "seeds", 0, 0, Path(folder).resolve(), False)
        write_inputs(trial.folder)
        trial.run(*INSPECT[:2], "--write", "seed.cif", may_fail=False)
        trial.run(*DOCK, may_fail=False)
        record = (trial.folder / "run/run.json").read_text().replace(f"{trial.folder}/", "")
        return (trial.folder / "seed.cif").read_bytes(), record.encode()


POTENTIALS = {
    "contact_potential": ROOT / "scoring/src/terms/effect/contact_potential.csv",
    "fine_contact_potential": ROOT / "scoring/src/terms/pose/fine_contact_potential.csv",
    "atom_pair_potential": ROOT / "scoring/src/terms/pose/atom_pair_potential.csv",
}
PDB = ["inspect", "--json"]
MESH = ["sample", "--json", "--grid", "2^9", "-o", "k.csv"]
SCORED = ["dock", "receptor.pdb", "ligand.pdb", "--json", "--rotations", "2", "--poses", "5", "-o", "run"]
MEASURED = ["--receptor", "receptor.pdb", "--ligand", "ligand.pdb", "--native", "native.pdb", "--json"]


def random_input(trial):
    """A damaged file and the call that reads it: name, content and words; the name stands for `FILE` in them."""
    kinds = ["a.pdb", "a.cif", "a.pdb.gz", "a.stl", "b.stl", "a.obj", "a.ply", "a.off", "a.csv", "pairs.csv",
             "a.toml", "run.json", "potential.csv"]  # fmt: skip
    name, random = trial.random.choice(kinds), trial.random
    cif, record = written(trial.knotdock)
    pdb = (CASES / "charged_helices_ligand.pdb").read_bytes()
    seeds = {"a.pdb": pdb, "a.cif": cif, "a.stl": text_stl(), "b.stl": binary_stl(), "a.ply": ply(), "a.off": off(),
             "a.obj": prism(BLOCK, 3).encode(), "a.csv": TABLE.encode(), "pairs.csv": PAIRS.encode(),
             "a.toml": OPTIONS.encode()}  # fmt: skip
    if name == "a.pdb.gz":
        return name, mutated_gzip(random, pdb), [*PDB, "FILE"]
    if name == "run.json":
        return name, mutated_json(random, record), ["dock", "--rerun", "FILE", "--json", "-o", "again"]
    if name == "potential.csv":
        option, path = random.choice(list(POTENTIALS.items()))
        return name, mutated(random, path.read_bytes()), [*SCORED, f"--config=terms.{option}='FILE'"]
    content = mutated(random, seeds[name])
    if name in ("a.pdb", "a.cif"):
        docked = ["dock", "--json", "receptor.pdb", "FILE", *FEW, "-o", "run"]
        return name, content, random.choice([[*PDB, "FILE"], [*PDB, "FILE", "--atoms", "atoms.csv"], docked])
    if name == "a.csv":
        return name, content, ["evaluate", "FILE", *MEASURED, "-o", "measured.csv"]
    if name == "pairs.csv":
        return name, content, ["batch", "--json", "FILE", "-o", "runs", "--", "--rotations", "2", "--poses", "5"]
    if name == "a.toml":
        return name, content, [*SCORED, "--config", "FILE"]
    return name, content, [*MESH, "FILE"]


def no_numbers(table):
    """The cells of a table that are NaN or infinite; not those of names, as a file may be called `inf`."""
    names = ("name", "receptor", "ligand", "error")
    cells = [cell for row in csv.DictReader(io.StringIO(table)) for cell in row.items() if cell[0] not in names]
    return [cell for cell in cells if re.fullmatch(r"-?(nan|inf)\w*", str(cell[1]), re.IGNORECASE)]


def damaged_files(trial):
    """Damaged input is read or refused: exit code 0, 1 or 2, no panic, JSON, the file named, in a bounded time.

    PDB, mmCIF, gzip, STL, OBJ, PLY, OFF, tables of poses, pairs and potentials, options in TOML and run.json, with
    bytes, lines, columns and values changed, cut short, or with numbers such as NaN and 1e308. No table that is
    written holds NaN, and a call that fails leaves nothing.
    """
    write_inputs(trial.folder)
    name, content, words = random_input(trial)
    trial.make(name, content)
    before = tree(trial.folder)
    call = trial.run(*[word.replace("FILE", name) for word in words])
    error = call.error()
    if call.code == 2 and error and name != "run.json":
        trial.check(name in f"{error['file']} {error['message']}", f"the error does not name {name}: {error}")
    after = tree(trial.folder)
    if call.code and words[0] != "batch":
        left = sorted(set(after) - set(before))
        trial.check(not left, f"failed and left {left[:5]}")
    for path, text in after.items():
        # Attempts of a batch are names, and a pair may be called `inf`.
        is_table = path.endswith(".csv") and not path.endswith("attempts.csv")
        if is_table and path not in before and isinstance(text, bytes):
            found = no_numbers(text.decode(errors="replace"))
            trial.check(not found or name == "a.csv", f"{path} holds {found}")
