"""Distance restraints drawn from a known complex, as experiments might give them.

Imported by benchmark.py, whose option --restraints gives them to each docking. Distances are between CA atoms of the
bound structures, which are superposed as in the complex:

- `pair`: one residue pair that is within 10 Å.
- `loose_pair`: the same pair, given as 12 Å.
- `group`: one ambiguous restraint, of all contact residues of the receptor to all of the ligand: 3 Å.
- `crosslinks`: five cross-links of DSS, of which a pose has to satisfy three. Three are true (10 to 25 Å), two are
  false (35 Å or more; the farthest pairs where none is so far).
"""

import math
import random

from known_residues import atoms, chains_by_number, order, residues_within

KINDS = ("pair", "loose_pair", "group", "crosslinks")
TRUE_LINK, FALSE_LINK = (10, 25), 35  # Å


def restraint_options(kind, texts, name, seed, path):
    """Options of `knotdock dock` for restraints of a kind, drawn by name and seed alone and written to `path`.

    `texts` holds the PDB text of receptor_bound, ligand_bound, receptor_unbound and ligand_unbound. Residues are
    matched by number; those that an unbound file lacks are not drawn.
    """
    alphas = [known_alphas(texts, side, name) for side in ("receptor", "ligand")]
    source = random.Random(f"{name} {seed} {kind.removeprefix('loose_')}")
    if kind == "group":
        rows = group_rows(texts, alphas)
    elif kind in ("pair", "loose_pair"):
        bound = 10 if kind == "pair" else 12
        near = [pair for pair, distance in pairs(*alphas) if distance <= 10]
        rows = [f"{atom(a)},{atom(b)},{bound}," for a, b in [source.choice(near)]]
    else:
        rows = [f"{atom(a)},{atom(b)},," for a, b in crosslinks(alphas, source)]
    path.write_text("\n".join(["receptor,ligand,upper,group", *rows, ""]))
    options = ["--restraints", str(path)]
    return options + (["--crosslink", "DSS", "--restraints-need", "3"] if kind == "crosslinks" else [])


def known_alphas(texts, side, name):
    """(chain in the unbound file, number, bound position) of the CA atoms that both files have."""
    unbound = chains_by_number(alphas_of(texts[f"{side}_unbound"]), f"{side}_unbound of {name}")
    bound = alphas_of(texts[f"{side}_bound"])
    return [(unbound[number], number, position) for _, number, position in bound if number in unbound]


def alphas_of(text):
    """Chain, number and position of the CA atoms."""
    lines = (line for line in text.splitlines() if line[12:16] == " CA ")
    return list(atoms("\n".join(lines)))


def pairs(receptor, ligand):
    """Every residue pair across the interface with its distance."""
    for own in receptor:
        for other in ligand:
            yield (own, other), math.dist(own[2], other[2])


def crosslinks(alphas, source):
    """Three true residue pairs and two false ones."""
    apart = sorted(pairs(*alphas), key=lambda pair: pair[1])
    true = [pair for pair, distance in apart if TRUE_LINK[0] <= distance <= TRUE_LINK[1]]
    false = [pair for pair, distance in apart if distance >= FALSE_LINK] or [pair for pair, _ in apart[-20:]]
    return source.sample(true, 3) + source.sample(false, 2)


def group_rows(texts, alphas):
    """All contact residues of one side to all of the other, as one group."""
    bound = [list(atoms(texts[f"{side}_bound"])) for side in ("receptor", "ligand")]
    touching = [residues_within(bound[0], bound[1]), residues_within(bound[1], bound[0])]
    known = [
        [f"{chain}:{number}" for chain, number, _ in sorted(own, key=lambda row: order(row[1])) if number in near]
        for own, near in zip(alphas, touching)
    ]
    return [f"{own},{other},3,interface" for own in known[0] for other in known[1]]


def atom(residue):
    """The CA atom of a residue as restraints name it."""
    chain, number, _ = residue
    return f"{chain}:{number}.CA"
