"""The other commands as functions."""

from __future__ import annotations

import html
import io
import os
import pathlib
import tempfile
from collections.abc import Sequence
from typing import Any

import numpy as np

from knotdock.commands import run_command
from knotdock.inputs import given
from knotdock.tables import Frame, read_table
from knotdock.view import View, table_html

__all__ = [
    "Balls",
    "Models",
    "batch",
    "collide",
    "evaluate",
    "inspect",
    "interface",
    "merge",
    "models",
    "morph",
    "obstacle",
    "sample",
    "score",
]


def _with_files(command: str, *solids: Any, before: Sequence[str] = (), **options: Any) -> Any:
    with tempfile.TemporaryDirectory(prefix="knotdock-") as folder:
        place = pathlib.Path(folder)
        files = [given(solid, lambda: place, f"input_{number}") for number, solid in enumerate(solids, 1)]
        return run_command(command, *before, *files, **options)


def evaluate(models: Any, native: Any, **options: Any) -> list[dict[str, Any]]:
    """How near complexes of any program are to a known one.

    Args:
        models: a complex or a list of them, as inputs of `dock`.
        native: the known complex.
        options: options of `knotdock evaluate`; `chains=("H,L", "A")` names the two sides.

    Returns:
        A dict for each model with irmsd, lrmsd, fnat, dockq and capri.
    """
    chains = options.pop("chains", ())
    many = models if isinstance(models, list) else [models]
    with tempfile.TemporaryDirectory(prefix="knotdock-") as folder:
        place = pathlib.Path(folder)
        files = [given(model, lambda: place, f"model_{number}") for number, model in enumerate(many, 1)]
        known = given(native, lambda: place, "native")
        return run_command("evaluate", *files, *chains, native=known, **options)["complexes"]


class Models:
    """Predicted models of complexes, rated by their confidence and their coordinates.

    Attributes:
        models: a dict for each model with its `pairs` of chains.
        systems: a dict for each pair of chains in all models that have it, with `trust` and its `evidence`.
    """

    def __init__(self, report: dict[str, Any], table: str) -> None:
        self.models, self.systems = report["models"], report["systems"]
        self._table = table

    def __len__(self) -> int:
        return len(self.models)

    def __repr__(self) -> str:
        return f"<{len(self)} models>"

    def _repr_html_(self) -> str:
        """The main columns as a table, and the trust in each pair of chains."""
        table = self.table("numpy")
        names = [name for name in _MODELS_SHOWN if name in table]
        rows = list(zip(*(table[name].tolist() for name in names), strict=True))
        trust = [
            f"Chains {one['chain_1']} {one['chain_2']}: {one['trust']} ({one['evidence']})" for one in self.systems
        ]
        words = "".join(f"<p>{html.escape(text)}</p>\n" for text in trust)
        return table_html(f"{len(self)} models", names, rows) + words

    def table(self, frame: Frame = "pandas") -> Any:
        """One row for each pair of chains of each model; see docs/reference/models_csv.md for the columns.

        Args:
            frame: `"pandas"`, `"polars"` or `"numpy"`, a dict of arrays by column.
        """
        return read_table(io.StringIO(self._table), frame)


# Columns of the table in a notebook's cell.
_MODELS_SHOWN = (
    *("file", "chain_1", "chain_2", "trust", "iptm", "ipsae", "pdockq2", "agreement"),
    *("dockq", "capri"),
)


def models(
    paths: Any,
    *,
    confidence: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] | None = None,
    native: Any = None,
    **options: Any,
) -> Models:
    """Rate predicted models of complexes.

    Args:
        paths: a structure, a directory of models with their confidence files, or a list of these.
        confidence: confidence files of the one structure given, in place of those beside it.
        native: the known complex, as an input of `dock`; the table then has irmsd, lrmsd, fnat, dockq and capri.
        options: options of `knotdock models`, such as `pae_cutoff=15` and `report="models.html"`.
    """
    many = paths if isinstance(paths, list) else [paths]
    files = [confidence] if isinstance(confidence, (str, os.PathLike)) else confidence
    with tempfile.TemporaryDirectory(prefix="knotdock-") as folder:
        place = pathlib.Path(folder)
        table = place / "models.csv"
        found = [given(model, lambda: place, f"model_{number}") for number, model in enumerate(many, 1)]
        known = None if native is None else given(native, lambda: place, "native")
        report = run_command("models", *found, confidence=files, native=known, output=table, **options)
        return Models(report, table.read_text(encoding="utf-8"))


def score(receptor: Any, ligand: Any, pose: Sequence[float] | None = None, **options: Any) -> dict[str, Any]:
    """The exact score of a pose with its parts, gradient and buried surface.

    Args:
        receptor: as of `dock`.
        ligand: likewise.
        pose: quaternion and translation (w, x, y, z, tx, ty, tz); by default the ligand where its file has it.
        options: options of `knotdock score`.
    """
    pose = [1, 0, 0, 0, 0, 0, 0] if pose is None else [float(value) for value in pose]
    return _with_files("score", receptor, ligand, pose=pose, **options)


def inspect(structure: Any, **options: Any) -> dict[str, Any]:
    """What is read of a structure: chains, residues and atoms kept, dropped and altered, and charges assumed."""
    return _with_files("inspect", structure, **options)


def interface(structure: Any, *chains: str, **options: Any) -> dict[str, Any]:
    """Contacts, bonds, buried surface and shape complementarity of a complex; `chains` name its sides."""
    with tempfile.TemporaryDirectory(prefix="knotdock-") as folder:
        path = given(structure, lambda: pathlib.Path(folder), "complex")
        (found,) = run_command("interface", path, *chains, **options)["complexes"]
        return found


def collide(a: Any, b: Any, pose: Sequence[float] | None = None, **options: Any) -> dict[str, Any]:
    """Whether two solids meet at a pose of the second: verdict, bounds of the distance, shared volume and force.

    Solids are meshes, molecules or balls; options are those of `knotdock collide`, such as `poses="poses.csv"`.
    """
    if pose is not None:
        options["pose"] = [float(value) for value in pose]
    return _with_files("collide", a, b, **options)


def obstacle(a: Any, b: Any, **options: Any) -> dict[str, Any]:
    """The translations at which two solids meet; options are those of `knotdock obstacle`."""
    return _with_files("obstacle", a, b, **options)


def morph(operation: str, *solids: Any, **options: Any) -> dict[str, Any]:
    """A morphological operation on solids (`sum`, `difference`, `offset`, `open`, `close`, `sweep` ...)."""
    return _with_files("morph", *solids, before=(operation,), **options)


class Balls:
    """Balls that stand for a solid.

    Attributes:
        centers: centres in the solid's unit, (n, 3).
        radii: radii, (n,).
        weights: weights, (n,).
        report: what `knotdock sample` says of them: errors on both sides, volumes, warnings.
    """

    def __init__(self, table: dict[str, np.ndarray], report: dict[str, Any]) -> None:
        self.centers = np.stack([table[axis] for axis in "xyz"], axis=1)
        self.radii, self.weights = table["r"], table["weight"]
        self.report = report

    def __len__(self) -> int:
        return len(self.radii)

    def __repr__(self) -> str:
        return f"<{len(self)} balls>"

    def _repr_html_(self) -> str:
        """Size and place as a table, and the view."""
        low, high = (self.centers - self.radii[:, None]).min(0), (self.centers + self.radii[:, None]).max(0)
        rows = [(axis, *ends) for axis, *ends in zip("xyz", low.tolist(), high.tolist(), strict=True)]
        return table_html(f"{len(self)} balls", ("axis", "from", "to"), rows) + self.view()._repr_html_()

    def view(self, *, viewer: str | os.PathLike[str] | None = None) -> View:
        """A three-dimensional view of the largest 2,000 balls; `viewer` as of `Run.view`."""
        largest = np.argsort(-self.radii, kind="stable")[:2000]
        caption = f"{len(self)} balls" if len(largest) == len(self) else f"The largest 2,000 of {len(self)} balls"
        return View({"balls": np.asarray(self)[largest].tolist()}, caption, viewer)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return np.column_stack([self.centers, self.radii]).astype(dtype or float)


def sample(mesh: Any, **options: Any) -> Balls:
    """A mesh as balls; options are those of `knotdock sample`, such as `grid="2^15"`."""
    with tempfile.TemporaryDirectory(prefix="knotdock-") as folder:
        place = pathlib.Path(folder)
        table = place / "knots.csv"
        path = given(mesh, lambda: place, "mesh")
        report = run_command("sample", path, output=table, **options)
        return Balls(read_table(table, "numpy"), report)


def batch(
    pairs: str | os.PathLike[str],
    output: str | os.PathLike[str],
    *,
    dock: dict[str, Any] | None = None,
    **options: Any,
) -> dict[str, Any]:
    """Dock the pairs of a table; see `knotdock batch --help`.

    Args:
        pairs: the table, with columns `receptor` and `ligand`.
        output: the directory of the batch.
        dock: options of `knotdock.dock` for all pairs.
        options: options of `knotdock batch`, such as `keep="table"` and `shard="3/100"`. A failure of pairs is no
            error: the table of results has it.
    """
    from knotdock.commands import words_of

    after = words_of(dock or {})
    return run_command("batch", pairs, output=output, failures_ok=True, after=after, **options)


def merge(*directories: str | os.PathLike[str], **options: Any) -> dict[str, Any]:
    """Put the shards of a batch together; see `knotdock merge --help`."""
    return run_command("merge", *directories, **options)
