"""Interface predictions of a stated quality, simulated from a known complex.

Imported by benchmark.py, whose option --predictions gives them to each docking.

A residue in contact in the known complex draws a value from N(d, 1), any other from N(0, 1), with d = sqrt(2) times
the quantile of the normal distribution at the area under the curve (AUC): a predictor that ranks a residue in contact
above another with that probability. Its probability is that of Bayes' theorem with the share of residues in contact,
so that the predictor is calibrated. Errors are independent from residue to residue, and those of real predictors are
not.
"""

import math
import random
from statistics import NormalDist

from known_residues import atoms, chains_by_number, order, residues_within


def prediction_options(auc, texts, name, seed, folder):
    """Options of `knotdock dock` for predictions of both sides, drawn by name, seed and AUC and written to `folder`.

    `texts` holds the PDB text of receptor_bound, ligand_bound, receptor_unbound and ligand_unbound. Residues are
    matched by number; all of the unbound files get a prediction.
    """
    bound = {side: list(atoms(texts[f"{side}_bound"])) for side in ("receptor", "ligand")}
    shift = math.sqrt(2) * NormalDist().inv_cdf(auc)
    source = random.Random(f"{name} {seed} predictions {auc}")
    options = []
    for side, other in (("receptor", "ligand"), ("ligand", "receptor")):
        touching = residues_within(bound[side], bound[other])
        unbound = chains_by_number(atoms(texts[f"{side}_unbound"]), f"{side}_unbound of {name}")
        share = len(touching & unbound.keys()) / len(unbound)
        prior = math.log(share / (1 - share))
        rows = ["chain,residue,probability"]
        for number in sorted(unbound, key=order):
            value = source.gauss(shift if number in touching else 0, 1)
            odds = shift * value - shift**2 / 2 + prior
            rows.append(f"{unbound[number] or '_'},{number},{1 / (1 + math.exp(-odds)):.4f}")
        path = folder / f"{side}_predictions.csv"
        path.write_text("\n".join([*rows, ""]))
        options += [f"--interface-{side}", str(path)]
    return options
