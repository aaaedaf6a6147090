"""Tables and three-dimensional views in the cells of a notebook, without a network."""

from __future__ import annotations

import html
import json
import os
import pathlib
import re
from collections.abc import Iterable
from typing import Any

import numpy as np

from knotdock import _knotdock
from knotdock.errors import InputError, KnotdockError

__all__ = ["View", "complex_view", "table_html"]

_MAX_TRIANGLES = 200_000
_MISSING = "This build of knotdock has no three-dimensional view"
_REMEDY = "build with the feature `viewer`, or name a folder of npm's package 3dmol: `view(..., viewer=FOLDER)`"


class View:
    """A three-dimensional view: shown in the cell of a notebook, or saved as a page.

    Attributes:
        page: the page as HTML text, which loads nothing from outside; None in a build without the view.
    """

    def __init__(self, data: dict[str, Any], caption: str, viewer: str | os.PathLike[str] | None = None) -> None:
        self._caption = caption
        self.page = _knotdock.view_page(json.dumps(data), viewer)

    def __repr__(self) -> str:
        return f"<View: {self._caption}>"

    def _repr_html_(self) -> str:
        caption = html.escape(self._caption)
        if self.page is None:
            return f"<p>{caption}</p>\n<p>{html.escape(f'{_MISSING}; {_REMEDY}')}.</p>\n"
        # Sandboxed: the page cannot reach the notebook.
        return (
            f'<iframe sandbox="allow-scripts" title="{caption}" srcdoc="{html.escape(self.page)}" '
            f'style="width: 100%; height: 420px; border: 1px solid #c8cdd3"></iframe>\n<p>{caption}</p>\n'
        )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the page, which any browser opens."""
        if self.page is None:
            raise KnotdockError(_MISSING, None, None, _REMEDY)
        pathlib.Path(path).write_text(self.page, encoding="utf-8")


def table_html(caption: str, header: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """A table as HTML; floats have two decimals, and cells without a value are empty."""

    def cell(value: Any) -> str:
        if isinstance(value, float):
            value = "" if np.isnan(value) else f"{value:.0f}" if value.is_integer() else f"{value:.2f}"
        return f"<td{space}>{html.escape(str(value))}</td>"

    # marimo sets no space between columns.
    space = ' style="padding: 0 0.5em"'
    head = "".join(f"<th{space}>{html.escape(name)}</th>" for name in header)
    body = "\n".join(f"<tr>{''.join(cell(value) for value in row)}</tr>" for row in rows)
    return f"<p>{html.escape(caption)}</p>\n<table>\n<tr>{head}</tr>\n{body}\n</table>\n"


def complex_view(text: str, names: list[str], viewer: str | os.PathLike[str] | None, title: str) -> View:
    """The view of a complex.

    Args:
        text: the file as `knotdock export` writes it.
        names: names of receptor and ligand; of a ring, of its molecule.
        viewer: as of `View`.
        title: beginning of the caption.
    """
    colours = f"{names[1]} in orange" if len(names) > 1 else "its copies in other colours"
    caption = f"{title}: {names[0]} in grey, {colours}"
    triangles = text.count("\nf ")
    if triangles > _MAX_TRIANGLES:
        message = f"the meshes have {triangles} triangles, and a view shows {_MAX_TRIANGLES} at most"
        raise InputError(message, None, None, "open the file of `knotdock export` in a program for meshes")
    if triangles > 0:
        return View({"bodies": _meshes(text), "placed": [[[1, 0, 0, 0, 0, 0, 0]]]}, caption, viewer)
    sides: dict[str, list[str]] = {}
    for chain, partner in re.findall(r"chain (\S+) is (receptor|ligand|copy \d+) chain", text):
        sides.setdefault(partner, []).append(chain)
    data = {"text": text, "sides": list(sides.values()), "sticks": True}
    return View(data, f"{caption}; residues within 5 Å of the other side as sticks", viewer)


def _meshes(text: str) -> list[dict[str, Any]]:
    """Receptor and ligand of an OBJ file as page/view.js reads them."""
    bodies: list[dict[str, Any]] = []
    before = 0
    for part in text.split("\ng ")[1:]:
        lines = [line.split() for line in part.splitlines()]
        positions = [float(number) for line in lines if line[0] == "v" for number in line[1:]]
        triangles = [int(corner) - before - 1 for line in lines if line[0] == "f" for corner in line[1:]]
        bodies.append({"format": "mesh", "positions": positions, "triangles": triangles})
        before += len(positions) // 3
    return bodies
