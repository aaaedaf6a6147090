"""Rigid-body docking of two molecules with knotdock, with or without restraints.

``[knotdock]`` searches all orientations and translations of the second molecule about the first by a grid search of
fixed extent, and ranks its poses. There is no random seed: the same models and parameters give the same models again.

Models are the input models, moved: every atom and name that the topology needs is kept. The receptor stays where it
is. Scores are knotdock's with the sign changed, so that lower is better. They have no unit and are comparable within a
run, not with HADDOCK scores.

Beyond HADDOCK3's own requirements the module needs the program ``knotdock`` on the PATH or beside the Python
interpreter.
"""

import csv
import json
import os
import shutil
import subprocess
import sys
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from haddock.core.defaults import MODULE_DEFAULT_YAML
from haddock.core.exceptions import ThirdPartyIntallationError
from haddock.core.typing import Any, FilePath, Optional
from haddock.libs.libcns import prepare_expected_pdb
from haddock.libs.libontology import PDBFile
from haddock.libs.libpdb import check_combination_chains, slc_chainid
from haddock.libs.libutil import parse_ncores
from haddock.modules import BaseHaddockModule


RECIPE_PATH = Path(__file__).resolve().parent
DEFAULT_CONFIG = Path(RECIPE_PATH, MODULE_DEFAULT_YAML)

Pose = dict[str, str]
"""A row of poses.csv: names of columns to their text."""


def find_program() -> Optional[str]:
    """Path of the program knotdock: on the PATH, else beside the Python interpreter."""
    return shutil.which("knotdock") or shutil.which("knotdock", path=os.path.dirname(sys.executable))


def rotation_matrix(pose: Pose) -> NDArray[np.float64]:
    """Rotation of a pose, shape (3, 3), of its unit quaternion (Hamilton's, active, right-handed)."""
    w, x, y, z = (float(pose[name]) for name in ("qw", "qx", "qy", "qz"))
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


class Molecule:
    """Atoms of a PDB file as its lines and their coordinates in Å, shape (atoms, 3)."""

    def __init__(self, path: Path) -> None:
        with open(path) as file:
            self.lines = [line.rstrip("\n").ljust(80) for line in file if line.startswith(("ATOM", "HETATM"))]
        self.coordinates = np.array([[float(line[at : at + 8]) for at in (30, 38, 46)] for line in self.lines])

    def placed(self, pose: Pose) -> "Molecule":
        """The molecule at a pose: a point x goes to R x + t."""
        placed = Molecule.__new__(Molecule)
        shift = np.array([float(pose[name]) for name in ("tx", "ty", "tz")])
        placed.lines, placed.coordinates = self.lines, self.coordinates @ rotation_matrix(pose).T + shift
        return placed


def write_complex(path: Path, molecules: list[Molecule]) -> None:
    """
    Write molecules to one PDB file.

    CNS finds atoms by segid, so it is the chain ID. Serial numbers increase, as its reader needs.

    Raises
    ------
    ValueError
        If a coordinate does not fit into the columns of a PDB file.
    """
    output: list[str] = []
    for molecule in molecules:
        for line, (x, y, z) in zip(molecule.lines, molecule.coordinates.tolist()):
            coordinates = f"{x:8.3f}{y:8.3f}{z:8.3f}"
            if len(coordinates) != 24:
                raise ValueError(f"{path.name} has no room for {x:.3f} {y:.3f} {z:.3f}: move the receptor nearer to 0")
            serial = (len(output) + 1) % 100_000
            chain = line[slc_chainid]
            output.append(f"{line[:6]}{serial:5d}{line[11:30]}{coordinates}{line[54:72]}{chain:<4}{line[76:]}\n")
    path.write_text("".join(output) + "END\n")


class HaddockModule(BaseHaddockModule):
    """HADDOCK3 module of rigid-body docking with knotdock."""

    name = RECIPE_PATH.name

    def __init__(
        self, order: int, path: Path, *ignore: Any, initial_params: FilePath = DEFAULT_CONFIG, **_: Any
    ) -> None:
        super().__init__(order, path, initial_params)

    @classmethod
    def confirm_installation(cls) -> None:
        """Check that the program can be found."""
        if find_program() is None:
            raise ThirdPartyIntallationError(
                "There is no program `knotdock` on the PATH. Install knotdock, and put the folder that has the program "
                "on the PATH."
            )

    def _checked(self, combination: Any) -> tuple[PDBFile, PDBFile]:
        """Receptor and ligand of a combination of models, in the order of `molecules`."""
        models = combination if isinstance(combination, tuple) else (combination,)
        if len(models) != 2:
            self.finish_with_error(
                f"[knotdock] docks two molecules, and the previous step has {len(models)}. Give two files as "
                "`molecules`, and place [knotdock] directly after [topoaa]."
            )
        if any(model.aa_topology is not None for model in models):
            self.finish_with_error("[knotdock] docks all atoms, not beads: leave out [topocg] before it.")
        try:
            check_combination_chains(list(models))
        except ValueError:
            self.finish_with_error(
                f"{models[0].file_name} and {models[1].file_name} share a chain ID. Give each molecule its own, such "
                "as with `pdb_chain -B`."
            )
        return models[0], models[1]

    def _restraints(self) -> Optional[Path]:
        """File of all restraints, in the folder of the step."""
        files = [Path(str(self.params[name])) for name in ("ambig_fname", "unambig_fname") if self.params[name]]
        for file in files:
            if file.suffix in (".tgz", ".gz"):
                self.finish_with_error(f"[knotdock] reads one file of restraints: unpack {file.name} and choose one.")
        if not files:
            return None
        together = Path("restraints.tbl")
        together.write_text("\n".join(file.read_text() for file in files))
        return together

    def _options(self) -> list[str]:
        """Options of `knotdock dock` that the parameters give."""
        params = self.params
        options = ["--preset", params["preset"]]
        # The search keeps 2000 poses by default; there are about half as many clusters.
        if params["sampling"] > 1000:
            options += ["--poses", str(2 * params["sampling"])]
        if params["rotations"]:
            options += ["--rotations", str(params["rotations"])]
        if not params["cluster"]:
            options += ["--no-cluster"]
        if restraints := self._restraints():
            options += ["--restraints", str(restraints), "--restraints-need", params["restraints_need"]]
        for side in ("receptor", "ligand"):
            for kind in ("active", "site"):
                if residues := params[f"{kind}_{side}"]:
                    options += [f"--{kind}-{side}", residues]
        if params["config_fname"]:
            options += ["--config", str(params["config_fname"])]
        threads = parse_ncores(params["ncores"], max_cpus=params["max_cpus"])
        return options + ["--threads", str(threads), "--write-top", "0", "--no-report"]

    def _dock(self, receptor: Path, ligand: Path, options: list[str], run: Path) -> list[Pose]:
        """Poses of a run of knotdock, best first. Its folder and its messages stay in the folder of the step."""
        command = [find_program() or "knotdock", "dock", str(receptor), str(ligand)]
        done = subprocess.run([*command, *options, "-o", str(run), "--force", "--json"], capture_output=True, text=True)
        run.with_suffix(".log").write_text(done.stderr)
        try:
            answer = json.loads(done.stdout)
        except ValueError:
            self.finish_with_error(f"knotdock ended with {done.returncode}: {done.stderr[-2000:].strip()}")
        if error := answer.get("error"):
            place = f"{error['file']}: " if error["file"] else ""
            line = f" (line {error['line']})" if error["line"] else ""
            remedy = f". Remedy: {error['remedy']}" if error["remedy"] else ""
            self.finish_with_error(f"knotdock: {place}{error['message']}{line}{remedy}")
        for line in done.stderr.splitlines():
            if line.startswith("warning: "):
                self.log(line.removeprefix("warning: "), level="warning")
        with open(answer["poses"]) as file:
            return list(csv.DictReader(file))

    def _run(self) -> None:
        """Dock every combination of the input models, and write the best poses of all."""
        try:
            combinations = self.previous_io.retrieve_models(crossdock=self.params["crossdock"])
        except Exception as error:
            self.finish_with_error(error)
        if not combinations:
            self.finish_with_error("The previous step has no models. Place [knotdock] directly after [topoaa].")
        sampling = self.params["sampling"]
        options = self._options()
        poses: list[tuple[float, tuple[PDBFile, PDBFile], Pose]] = []
        for number, combination in enumerate(combinations, start=1):
            pair = self._checked(combination)
            found = self._dock(pair[0].rel_path, pair[1].rel_path, options, Path(f"run_{number}"))
            self.log(f"{pair[0].file_name} and {pair[1].file_name}: {len(found)} poses")
            poses += [(-float(pose["score"]), pair, pose) for pose in found]
            # Sorting is stable: poses of equal score keep the order of the combinations and of their ranks.
            poses = sorted(poses, key=lambda row: row[0])[:sampling]
        if len(poses) < sampling:
            self.log(f"there are {len(poses)} models, fewer than sampling = {sampling}", level="warning")
        # A file is read once.
        molecule = lru_cache(Molecule)
        self.output_models = []
        for rank, (score, pair, pose) in enumerate(poses, start=1):
            receptor, ligand = (molecule(model.rel_path) for model in pair)
            model = prepare_expected_pdb(pair, rank, ".", self.name)
            model.score = score
            try:
                write_complex(Path(model.file_name), [receptor, ligand.placed(pose)])
            except ValueError as error:
                self.finish_with_error(error)
            self.output_models.append(model)
        self.export_io_models()
