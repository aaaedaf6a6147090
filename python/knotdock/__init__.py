"""knotdock: protein docking and shape complementarity by spherical decomposition.

    import knotdock

    run = knotdock.dock("receptor.pdb", "ligand.pdb", native="complex.pdb")
    run.poses.plot.scatter("irmsd", "score")

`dock` docks two structures; `Run` opens what a run left. `batch`, `merge` and `screen` are for many pairs. `score`,
`evaluate`, `interface`, `models`, `inspect`, `sample`, `collide`, `obstacle` and `morph` are the other commands. `Molecule` reads
structures into arrays, and `Correlator` correlates balls with weights of one's own. `run_command` runs any command by
its name. In a notebook, runs, molecules and balls show a table and a `View`.
"""

from knotdock._knotdock import Correlator, options, version
from knotdock.commands import KnotdockWarning, run_command
from knotdock.docking import dock
from knotdock.errors import InputError, KnotdockError
from knotdock.functions import (
    Balls,
    Models,
    batch,
    collide,
    evaluate,
    inspect,
    interface,
    merge,
    models,
    morph,
    obstacle,
    sample,
    score,
)
from knotdock.molecule import Molecule
from knotdock.run import Run
from knotdock.screening import screen
from knotdock.tables import iterate_poses, read_poses, read_results, read_table
from knotdock.view import View

__version__ = version().split()[0]

__all__ = [
    "Balls",
    "Correlator",
    "InputError",
    "KnotdockError",
    "KnotdockWarning",
    "Models",
    "Molecule",
    "Run",
    "View",
    "batch",
    "collide",
    "dock",
    "evaluate",
    "inspect",
    "interface",
    "iterate_poses",
    "merge",
    "models",
    "morph",
    "obstacle",
    "options",
    "read_poses",
    "read_results",
    "read_table",
    "run_command",
    "sample",
    "score",
    "screen",
    "version",
]
