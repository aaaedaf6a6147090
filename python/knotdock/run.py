"""A docking run and what came of it."""

from __future__ import annotations

import html
import io
import json
import os
import pathlib
import shutil
import tempfile
from typing import Any, Literal

import numpy as np

from knotdock import _knotdock
from knotdock.commands import run_command
from knotdock.errors import InputError, KnotdockError
from knotdock.inputs import given
from knotdock.tables import Frame, read_table
from knotdock.view import View, complex_view, table_html

__all__ = ["MemoryRun", "Run"]

# Columns of the table in a notebook's cell.
_SHOWN = ("rank", "score", "cluster_size", "z_score", "pose_score", "irmsd", "lrmsd", "dockq", "capri")


class Run:
    """A docking run: its table of poses, complexes and record.

    `knotdock.dock` returns one; `Run("example")` opens the directory of a run that is there, by whichever program it
    was started. A run without a directory of its own lives in a temporary one, which goes with the object: `save` keeps
    it.
    """

    def __init__(
        self,
        directory: str | os.PathLike[str],
        *,
        _temporary: tempfile.TemporaryDirectory[str] | None = None,
    ) -> None:
        self.directory = pathlib.Path(directory)
        self._temporary = _temporary
        if not (self.directory / "poses.csv").is_file():
            message = "this is no directory of a run: it has no poses.csv"
            raise InputError(message, str(directory), None, "name the directory that `knotdock dock` wrote with -o")

    def _place(self) -> str:
        return f"in {self.directory}"

    def _names(self) -> list[str]:
        """Names of receptor and ligand; of a ring, of its molecule."""
        record = self.record
        inputs = record.get("inputs", record)
        names = []
        for side in ("receptor", "ligand"):
            # A list has a file for each conformation.
            file, *others = inputs[side] if isinstance(inputs[side], list) else [inputs[side]]
            chains = f":{','.join(file['chains'])}" if file.get("chains") else ""
            count = f" ({1 + len(others)} conformations)" if others else ""
            names.append(pathlib.PurePath(file["path"]).name + chains + count)
        return names[:1] if record["options"]["search"]["symmetry"] else names

    def _summary(self) -> str:
        scores = self.scores
        best = f", best score {scores[0]:.1f}" if len(scores) else ""
        return f"Run of {' and '.join(self._names())}: {len(scores)} poses{best}"

    def __repr__(self) -> str:
        return f"<{self._summary()}, {self._place()}>"

    def _repr_html_(self) -> str:
        """The best poses as a table, and the view of rank 1."""
        table = self.table("numpy")
        names = [name for name in _SHOWN if name in table]
        rows = list(zip(*(table[name][:10].tolist() for name in names), strict=True))
        caption = f"{self._summary()}. The first {len(rows)}:"
        return table_html(caption, names, rows) + (self._view_html() if rows else "")

    def _view_html(self) -> str:
        try:
            return self.view(1)._repr_html_()
        except KnotdockError as error:
            # Such as inputs that are gone.
            return f"<p>{html.escape(str(error))}</p>\n"

    def view(self, rank: int = 1, *, viewer: str | os.PathLike[str] | None = None) -> View:
        """A three-dimensional view of the complex of a rank, from 1, as `complex` gives it.

        Args:
            rank: the rank.
            viewer: folder of npm's package 3dmol; by default the library that the package was built with.
        """
        return complex_view(self.complex(rank), self._names(), viewer, f"Rank {rank}")

    def plot_scores(self, axes: Any = None) -> Any:
        """Score by rank; poses are coloured by i-RMSD if the run has a known complex.

        Args:
            axes: Axes of Matplotlib to draw into; by default new ones.

        Returns:
            The Axes.
        """
        try:
            from matplotlib import pyplot
        except ImportError as error:
            message = "plot_scores needs Matplotlib: pip install 'knotdock[plot]'"
            raise ImportError(message) from error

        axes = pyplot.subplots()[1] if axes is None else axes
        table = self.table("numpy")
        if "irmsd" in table:
            points = axes.scatter(table["rank"], table["score"], s=12, c=table["irmsd"], vmin=0, vmax=20)
            axes.figure.colorbar(points, ax=axes, label="i-RMSD (Å)", extend="max")
        else:
            axes.scatter(table["rank"], table["score"], s=12)
        axes.set(xlabel="rank", ylabel="score", title=" and ".join(self._names()))
        return axes

    def table(self, frame: Frame = "pandas") -> Any:
        """The table of poses, best first: one row per cluster, or one row per pose with `no_cluster`.

        Args:
            frame: `"pandas"`, `"polars"` or `"numpy"`, a dict of arrays by column.
        """
        return read_table(self.directory / "poses.csv", frame)

    @property
    def poses(self) -> Any:
        """The table of poses as a pandas DataFrame; see docs/reference/poses_csv.md for the columns."""
        return self.table("pandas")

    def _columns(self, names: str) -> np.ndarray:
        table = self.table("numpy")
        return np.stack([np.asarray(table[name], dtype=float) for name in names.split()], axis=1)

    @property
    def scores(self) -> np.ndarray:
        """Scores that order the poses, (n,)."""
        return self._columns("score")[:, 0]

    @property
    def quaternions(self) -> np.ndarray:
        """Rotations as unit quaternions w, x, y, z, (n, 4)."""
        return self._columns("qw qx qy qz")

    @property
    def rotations(self) -> np.ndarray:
        """Rotations as matrices, (n, 3, 3). A ligand atom at x in its own file goes to R x + t."""
        w, x, y, z = self.quaternions.T
        rows = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
        return np.moveaxis(np.array(rows), 2, 0)

    @property
    def translations(self) -> np.ndarray:
        """Translations in Å, (n, 3)."""
        return self._columns("tx ty tz")

    @property
    def record(self) -> dict[str, Any]:
        """run.json: inputs, options, effects, errors and times. Of conformations ensemble.json."""
        names = (self.directory / name for name in ("run.json", "ensemble.json"))
        path = next((path for path in names if path.exists()), self.directory / "run.json")
        return json.loads(path.read_text())

    def complex(self, rank: int, format: Literal["pdb", "cif"] | None = None) -> str:
        """The complex of a rank, from 1, as the text of a PDB or mmCIF file (of meshes as OBJ)."""
        with tempfile.TemporaryDirectory() as folder:
            run_command("export", self.directory, rank=rank, output=folder, format=format)
            (file,) = pathlib.Path(folder).iterdir()
            return file.read_text()

    def evaluate(self, native: Any, frame: Frame = "pandas", **options: Any) -> Any:
        """How near each pose is to a known complex: the table with irmsd, lrmsd, fnat, dockq and capri.

        Args:
            native: the complex, as inputs of `dock`.
            frame: as of `table`.
            options: further options of `knotdock evaluate`, such as `native_chains`.
        """
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder)
            path = given(native, lambda: place, "native")
            table = place / "evaluated.csv"
            run_command("evaluate", self.directory, native=path, output=table, **options)
            return read_table(table, frame)

    def save(self, directory: str | os.PathLike[str]) -> Run:
        """Copy the run to a directory that is not there yet; the run there."""
        if os.path.exists(directory):
            message = "there is something in the way"
            raise InputError(message, os.fspath(directory), None, "name a directory that is not there yet")
        shutil.copytree(self.directory, directory)
        return Run(directory)


class MemoryRun(Run):
    """A docking of two molecules in memory, as `knotdock.dock(Molecule, Molecule)` returns it. `save` writes it."""

    def __init__(self, inner: _knotdock.Run) -> None:
        self._inner = inner
        self._table = inner.table()

    def _place(self) -> str:
        return "in memory"

    def table(self, frame: Frame = "pandas") -> Any:
        """The table of poses, best first; see `Run.table`."""
        return read_table(io.StringIO(self._table), frame)

    @property
    def record(self) -> dict[str, Any]:
        """Inputs, options, effects, errors and times, as in run.json."""
        return json.loads(self._inner.record())

    def complex(self, rank: int, format: Literal["pdb", "cif"] | None = None) -> str:
        """The complex of a rank, from 1, as the text of a PDB file, or mmCIF where PDB cannot hold it."""
        if format is not None:
            message = "a run in memory chooses the format of its complexes"
            raise InputError(message, None, None, "leave out the format, or save the run first")
        return self._inner.complex(rank)

    def evaluate(self, native: Any, frame: Frame = "pandas", **options: Any) -> Any:
        """How near each pose is to a known complex; see `Run.evaluate`."""
        with tempfile.TemporaryDirectory(prefix="knotdock-") as folder:
            return self.save(pathlib.Path(folder, "run")).evaluate(native, frame, **options)

    def save(self, directory: str | os.PathLike[str]) -> Run:
        """Write the run into a directory that holds no other; the run there."""
        self._inner.write(directory)
        return Run(directory)
