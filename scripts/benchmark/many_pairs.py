#!/usr/bin/env python3
"""Times small pairs as single runs and as two shards of a batch, two processes each, and counts files and bytes.

usage: many_pairs.py FOLDER KNOTDOCK PLACE [--ligands 50] [--rounds 1] [-- options of knotdock dock]

The pairs are the four smallest receptors of FOLDER (see scripts/docked_pairs.py) with its smallest ligands, as unbound.
What is written goes to PLACE, a new folder.
"""

import argparse
import itertools
import pathlib
import resource
import subprocess
import sys
import time


def pairs(folder, ligands):
    """Names and files of the pairs."""
    names = [place.name for place in folder.iterdir() if (place / "receptor_unbound.pdb.gz").exists()]
    file = lambda name, side: folder / name / f"{side}_unbound.pdb.gz"  # noqa: E731
    smallest = lambda side, count: sorted(names, key=lambda name: file(name, side).stat().st_size)[:count]  # noqa: E731
    sides = itertools.product(smallest("receptor", 4), smallest("ligand", ligands))
    return [(f"{one}_{other}", file(one, "receptor"), file(other, "ligand")) for one, other in sides]


def timed(processes):
    """Seconds on the clock and of processors until processes end."""
    usage = lambda: sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])  # noqa: E731
    clock, before = time.monotonic(), usage()
    running = [subprocess.Popen(words) for words in processes]
    if any([process.wait() for process in running]):
        sys.exit("a run failed")
    return time.monotonic() - clock, usage() - before


def contents(folder):
    """Number and bytes of the files below a folder."""
    files = [path for path in folder.rglob("*") if path.is_file()]
    return len(files), sum(path.stat().st_size for path in files)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("knotdock")
    parser.add_argument("place", type=pathlib.Path)
    parser.add_argument("--ligands", type=int, default=50, help="ligands of each receptor; default: %(default)s")
    parser.add_argument("--rounds", type=int, default=1, help="default: %(default)s")
    words = sys.argv[1:]
    after = words.index("--") if "--" in words else len(words)
    options, dock = parser.parse_args(words[:after]), words[after + 1 :]
    options.place.mkdir()
    rows = pairs(options.folder.resolve(), options.ligands)
    table = options.place / "pairs.csv"
    table.write_text("name,receptor,ligand\n" + "".join(f"{n},{r},{x}\n" for n, r, x in rows))
    for number in range(options.rounds):
        single, shards = (options.place / f"{kind}_{number}" for kind in ("single", "shards"))
        single.mkdir()
        call = [options.knotdock, "dock", "-q", "-j", "1", *dock, "-o"]
        lines = [" ".join(map(str, [*call, single / name, one, other])) for name, one, other in rows]
        alone = timed([["bash", "-ec", "\n".join(lines[start::2])] for start in (0, 1)])
        batch = [options.knotdock, "batch", "-q", table, "-o", shards, "-j", "1", "--keep", "table"]
        parts = timed([[*batch, "--shard", f"{index}/2", "--", *dock] for index in (1, 2)])
        print(f"single runs {alone[0]:.1f} s, {alone[1]:.1f} CPU s; shards {parts[0]:.1f} s, {parts[1]:.1f} CPU s")
        for kind, (files, size) in (("single runs", contents(single)), ("shards", contents(shards))):
            print(f"{kind}: {files} files, {size / len(rows):.0f} bytes a pair")


if __name__ == "__main__":
    main()
