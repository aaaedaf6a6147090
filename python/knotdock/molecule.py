"""Molecules as knotdock reads them."""

from __future__ import annotations

import os
import pathlib
import tempfile
from typing import Any

import numpy as np

from knotdock import _knotdock
from knotdock.commands import words_of
from knotdock.inputs import given
from knotdock.view import View, table_html

__all__ = ["Molecule"]


class Molecule:
    """The atoms of a structure that are docked, after waters, hydrogens and the like were dropped.

    Attributes:
        positions: coordinates in Å, (n, 3).
        radii: united-atom radii in Å, (n,).
        labels: arrays (n,) by name: name, element, residue_name, chain, residue_number, insertion_code, occupancy,
            b_factor and hetero.
        report: what was read, dropped and altered, in words.
    """

    def __init__(self, inner: _knotdock.Molecule) -> None:
        self._inner = inner
        self.positions: np.ndarray = inner.positions
        self.radii: np.ndarray = inner.radii
        self.labels: dict[str, np.ndarray] = {name: np.asarray(values) for name, values in inner.labels.items()}
        self.report: str = inner.report

    @classmethod
    def read(cls, structure: Any, **options: Any) -> Molecule:
        """Read a structure, as inputs of `dock`; options are those of reading, such as `waters="keep"`."""
        with tempfile.TemporaryDirectory(prefix="knotdock-") as folder:
            path = given(structure, lambda: pathlib.Path(folder), "structure")
            return cls(_knotdock.Molecule.from_words(path, words_of(options)))

    def __len__(self) -> int:
        return len(self.radii)

    def __repr__(self) -> str:
        return f"<Molecule of {len(self)} atoms>"

    def _repr_html_(self) -> str:
        """The chains as a table, and the view."""
        residues = np.stack([self.labels[name].astype(str) for name in ("residue_number", "insertion_code")], axis=1)
        rows = []
        for chain in dict.fromkeys(self.labels["chain"].tolist()):
            of_chain = self.labels["chain"] == chain
            rows.append((chain, len(np.unique(residues[of_chain], axis=0)), int(of_chain.sum())))
        table = table_html(f"Molecule of {len(self)} atoms", ("chain", "residues", "atoms"), rows)
        return table + self.view()._repr_html_()

    def view(self, *, viewer: str | os.PathLike[str] | None = None) -> View:
        """A three-dimensional view, each chain in its own colour; `viewer` as of `Run.view`."""
        return View({"text": self._inner.text}, f"{len(self)} atoms, coloured by chain", viewer)

    @property
    def atoms(self) -> np.ndarray:
        """The atoms as a structured array (n,): x, y, z and r in Å, and the labels."""
        columns = {"x": self.positions[:, 0], "y": self.positions[:, 1], "z": self.positions[:, 2], "r": self.radii}
        columns |= self.labels
        atoms = np.empty(len(self), dtype=[(name, values.dtype) for name, values in columns.items()])
        for name, values in columns.items():
            atoms[name] = values
        return atoms

    @property
    def balls(self) -> np.ndarray:
        """Centres and radii in Å, (n, 4), as `Correlator` takes them."""
        return np.column_stack([self.positions, self.radii])
