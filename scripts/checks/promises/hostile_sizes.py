"""Inputs of a hostile size, which end in a bounded time or are refused."""

import gzip
import math
import os

from promises.exact_scores import atom_line
from promises.scenes import DOCK, prism, write_inputs
from promises.trial import limited

ROOM = 16 * 2**30  # bytes of address space: an input without end shall not take the machine's memory
LIGAND = ["dock", "--json", "receptor.pdb", "a.pdb", "--rotations", "2", "-o", "run"]


def many_atoms(count, place):
    """PDB text of alanines whose atoms lie at `place` of their number."""
    names = ["N", "CA", "C", "O", "CB"]
    return "".join(atom_line(n % 99999 + 1, names[n % 5], n // 5 % 9999 + 1, place(n), chain="ABCDEFGH"[n // 49995 % 8])
                   for n in range(count))  # fmt: skip


def coincident(trial):
    count = 100_000 if trial.full else 30_000
    trial.make("a.pdb", many_atoms(count, lambda n: (1.0, 2.0, 3.0)))
    return ["inspect", "--json", "a.pdb"]


def crowded(trial):
    count = 10_000 if trial.full else 2_000
    random = trial.random
    trial.make("a.pdb", many_atoms(count, lambda n: [random.uniform(0, 3) for _ in range(3)]))
    return ["inspect", "--json", "a.pdb"]


def cif(rows):
    columns = "group_PDB id type_symbol label_atom_id label_alt_id label_comp_id label_asym_id label_seq_id auth_seq_id"
    columns += " auth_asym_id Cartn_x Cartn_y Cartn_z occupancy B_iso_or_equiv pdbx_PDB_model_num"
    return "data_x\nloop_\n" + "".join(f"_atom_site.{name}\n" for name in columns.split()) + "".join(rows)


def many_chains(trial):
    count = 100_000 if trial.full else 5_000
    trial.make("a.cif", cif(
        f"ATOM {n} C CA . ALA C{n} 1 1 C{n} {n % 300 * 4} {n // 300 % 300 * 4} {n // 90000 * 4} 1 10 1\n"
        for n in range(count)))  # fmt: skip
    return ["inspect", "--json", "a.cif"]


def gzip_of_atoms(trial):
    """A small gzip file, of many members, that unpacks to a million atoms."""

    def member(k):
        return gzip.compress(many_atoms(20_000, lambda n: (n % 30 * 4, n // 30 % 30 * 4, n // 900 * 4)).encode(), 6)

    trial.make("a.pdb.gz", member(0) * (50 if trial.full else 2))
    return ["inspect", "--json", "a.pdb.gz"]


def gzip_of_nothing(trial):
    """A gzip file that unpacks to 128 MB of blank lines, or of one line."""
    text = trial.random.choice([b"\n", b" "]) * 2**24
    trial.make("a.pdb.gz", gzip.compress(text) * (8 if trial.full else 1))
    return ["inspect", "--json", "a.pdb.gz"]


def many_corners(trial):
    """A prism whose ends are polygons of many corners."""
    count = 100_000 if trial.full else 5_000
    points = [(math.cos(2 * math.pi * n / count), math.sin(2 * math.pi * n / count)) for n in range(count)]
    text = "".join(f"v {x:.9f} {y:.9f} {z}\n" for z in (0, 1) for x, y in points)
    text += "f " + " ".join(str(n) for n in range(count, 0, -1)) + "\n"
    text += "f " + " ".join(str(n) for n in range(count + 1, 2 * count + 1)) + "\n"
    text += "".join(f"f {n + 1} {(n + 1) % count + 1} {count + (n + 1) % count + 1} {count + n + 1}\n"
                    for n in range(count))  # fmt: skip
    trial.make("a.obj", text)
    return ["sample", "--json", "a.obj", "--grid", "2^9"]


def comb(trial):
    """A polygon with many teeth, which a cutter of ears meets at their worst."""
    count = 100_000 if trial.full else 2_000
    teeth = [(n, 0.5 + n % 2) for n in range(count, -1, -1)]
    trial.make("a.obj", prism([(0, 0), (count, 0), *teeth], 1))
    return ["sample", "--json", "a.obj", "--grid", "2^9"]


def distant_atoms(trial):
    x = f"{trial.random.choice([900.0, 9000.0]):8.3f}"
    line = atom_line(1, "CA", 1, (0.0, 0.0, 0.0))
    trial.make("a.pdb", line + line[:24] + " 2" + line[26:30] + x * 3 + line[54:])
    return LIGAND


def nested(trial):
    """Brackets in brackets, in each file that may hold them."""
    deep = trial.random.choice(["[", '{"a":', "[["]) * 200_000
    kind = trial.random.choice(["toml", "json", "record"])
    if kind == "toml":
        trial.make("a.toml", "x = " + "[" * 200_000)
        return [*LIGAND[:3], "ligand.pdb", "-o", "run", "--config", "a.toml"]
    trial.make("run.json", deep if kind == "json" else '{"program":"knotdock","schema":3,"options":' + deep)
    return ["dock", "--json", "--rerun", "run.json", "-o", "run"]


def lying_counts(trial):
    """Mesh files whose heads count far more than they hold."""
    huge = trial.random.choice([4294967295, 10**12, 10**18])
    ply = f"ply\nformat ascii 1.0\nelement vertex {huge}\nproperty float x\nproperty float y\nproperty float z\n"
    ply += f"element face {huge}\nproperty list uint int vertex_indices\nend_header\n0 0 0\n"
    files = {
        "a.stl": b"x".ljust(80) + b"\xff\xff\xff\xff" + b"\0" * 200,
        "a.ply": ply.encode(),
        "b.ply": ply.replace("ascii", "binary_little_endian").encode() + b"\xff" * 40,
        "a.off": f"OFF\n{huge} {huge} 0\n0 0 0\n".encode(),
    }
    name = trial.random.choice(list(files))
    trial.make(name, files[name])
    return ["sample", "--json", name, "--grid", "2^9"]


def endless(trial):
    """Devices and pipes without end in the place of files, also those that a record names."""
    os.mkfifo(trial.folder / "pipe.pdb")
    source = trial.random.choice(["/dev/zero", "pipe.pdb"])
    kind = trial.random.choice(["record", "input", "table"])
    if kind == "input":
        return ["dock", "--json", "--rerun", "/dev/zero", "-o", "again"]
    if kind == "table":
        return ["evaluate", "/dev/zero", "--receptor", "receptor.pdb", "--ligand", "ligand.pdb", "--json",
                "--native", "native.pdb"]  # fmt: skip
    trial.run(*DOCK, may_fail=False)
    record = trial.folder / "run/run.json"
    path = str(trial.folder / source) if source == "pipe.pdb" else source
    record.write_text(record.read_text().replace(str(trial.folder / "ligand.pdb"), path))
    (trial.folder / "ligand.pdb").unlink()
    return ["dock", "--json", "--rerun", "run/run.json", "-o", "again"]


GIB = 2**30
CASES = {  # and the peak of resident memory that they may take
    coincident: 4 * GIB, crowded: 4 * GIB, many_chains: 4 * GIB, gzip_of_atoms: 4 * GIB, gzip_of_nothing: 4 * GIB,
    many_corners: 4 * GIB, comb: 4 * GIB, distant_atoms: GIB, nested: GIB, lying_counts: GIB, endless: GIB,
}  # fmt: skip


def bounded_time(trial):
    """Inputs of a hostile size end within two minutes or are refused, and no memory is taken without bounds.

    100,000 atoms in one place and 10,000 within 3 Å, 100,000 chains, gzip files that unpack to a million atoms or to
    128 million blank lines, polygons of 100,000 corners and with 100,000 teeth, atoms at 9,000 Å, brackets 200,000
    deep, heads that count 10^18 vertices, pipes and devices. The time is processor time. Input without an end may take
    1 GiB, a million atoms 4 GiB.
    """
    write_inputs(trial.folder)
    case = list(CASES)[trial.number % len(CASES)]
    words = case(trial)
    call = trial.run(*words, before=limited(AS=ROOM))
    trial.commands[-1] += f"   # {case.__name__}"
    trial.check(call.peak <= CASES[case], f"{case.__name__} took {call.peak / GIB:.1f} GiB")
