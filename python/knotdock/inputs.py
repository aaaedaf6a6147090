"""Structures and solids as files that commands read."""

from __future__ import annotations

import functools
import gzip
import os
import pathlib
import tempfile
from collections.abc import Callable
from typing import Any

import numpy as np

from knotdock.errors import InputError

__all__ = ["given"]

# Marks of mmCIF files, which no PDB file has.
_CIF = ("data_", "_atom_site.", "loop_")


def given(what: Any, folder: Callable[[], pathlib.Path], name: str) -> str:
    """A structure or solid as the program's command line names it.

    Args:
        what: a path (perhaps with chains, `file.pdb:H,L`); the bytes or text of a PDB or mmCIF file; a structure of
            biotite, Biopython or gemmi; balls, an array (n, 4) of centres and radii; or a mesh, a pair of vertices
            (n, 3) and triangles (m, 3).
        folder: gives the folder for a file that has to be written.
        name: the file's name without an ending.
    """
    if isinstance(what, os.PathLike):
        return os.fspath(what)
    if isinstance(what, str):
        return _written(what.encode(), folder(), name) if "\n" in what else what
    if isinstance(what, (bytes, bytearray, memoryview)):
        return _written(bytes(what), folder(), name)
    library = type(what).__module__.split(".")[0]
    for module, write in (("biotite", _of_biotite), ("Bio", _of_biopython), ("gemmi", _of_gemmi)):
        if library == module:
            return _made(functools.partial(write, what), folder() / f"{name}.cif")
    if isinstance(what, tuple) and len(what) == 2:
        return _made(lambda path: _mesh(*what, path), folder() / f"{name}.obj")
    array = np.asarray(what)
    if array.ndim == 2 and array.shape[1] == 4 and np.issubdtype(array.dtype, np.number):
        columns = {"fmt": "%.17g", "delimiter": ",", "header": "x,y,z,r", "comments": ""}
        return _made(lambda path: np.savetxt(path, array, **columns), folder() / f"{name}.csv")
    message = (
        f"{type(what).__name__} is neither a path, the text of a structure file, a structure of biotite, Biopython "
        "or gemmi, an array (n, 4) of balls, nor a pair of vertices and triangles"
    )
    raise TypeError(message)


def _written(text: bytes, folder: pathlib.Path, name: str) -> str:
    if text[:2] == b"\x1f\x8b":
        text = gzip.decompress(text)
    start = text[:4096].decode("latin-1").lstrip()
    is_cif = start.startswith(_CIF) or "\n_atom_site." in start or "\nloop_" in start
    return _placed(text, folder / f"{name}.{'cif' if is_cif else 'pdb'}")


def _made(write: Callable[[pathlib.Path], None], path: pathlib.Path) -> str:
    """A file as some library writes it."""
    with tempfile.TemporaryDirectory(prefix="knotdock-") as folder:
        made = pathlib.Path(folder, path.name)
        write(made)
        return _placed(made.read_bytes(), path)


def _placed(content: bytes, path: pathlib.Path) -> str:
    """A file in its place, which holds nothing else of its user's."""
    if path.exists() and path.read_bytes() != content:
        message = "a file of another content is where the structure has to be written"
        raise InputError(message, str(path), None, "name another output, or give the structure as a path")
    path.write_bytes(content)
    return str(path)


def _of_biotite(structure: Any, path: pathlib.Path) -> None:
    from biotite.structure.io import pdbx

    file = pdbx.CIFFile()
    pdbx.set_structure(file, structure, data_block="structure")
    file.write(path)


def _of_biopython(structure: Any, path: pathlib.Path) -> None:
    from Bio.PDB import MMCIFIO

    writer = MMCIFIO()
    writer.set_structure(structure)
    writer.save(str(path))


def _of_gemmi(structure: Any, path: pathlib.Path) -> None:
    structure.setup_entities()
    structure.make_mmcif_document().write_file(str(path))


def _mesh(vertices: Any, triangles: Any, path: pathlib.Path) -> None:
    vertices, triangles = np.asarray(vertices, dtype=float), np.asarray(triangles)
    if vertices.ndim != 2 or vertices.shape[1] != 3 or triangles.ndim != 2 or triangles.shape[1] != 3:
        message = "a mesh is a pair of vertices (n, 3) and triangles (m, 3)"
        raise TypeError(message)
    with path.open("w") as file:
        np.savetxt(file, vertices, fmt="v %.17g %.17g %.17g")
        np.savetxt(file, triangles + 1, fmt="f %d %d %d")
