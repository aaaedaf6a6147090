"""`knotdock.dock`: two structures in, ranked poses out."""

from __future__ import annotations

import inspect
import os
import pathlib
import tempfile
import textwrap
from typing import TYPE_CHECKING, Any

from knotdock import _knotdock
from knotdock.commands import Listener, keyword_name, run_command, text_of
from knotdock.errors import InputError
from knotdock.inputs import given
from knotdock.molecule import Molecule
from knotdock.run import MemoryRun, Run

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from knotdock._options import DockArguments

__all__ = ["dock"]

# Options that name structures, which may be given as they are.
_STRUCTURES = ("native", "native_receptor", "native_ligand", "receptor_also", "ligand_also")


def dock(
    receptor: Any,
    ligand: Any = None,
    *,
    output: str | os.PathLike[str] | None = None,
    progress: bool | None = None,
    **options: Unpack[DockArguments],
) -> Run:
    """Dock a ligand to a receptor and rank the poses.

    Args:
        receptor: what stays: a path (perhaps with chains, `"file.pdb:H,L"`), the text of a PDB or mmCIF file, a
            structure of biotite, Biopython or gemmi, balls (n, 4), or a mesh as a pair of vertices and triangles. Two
            of `Molecule` are docked in memory: no file is written, and `output` is left out.
        ligand: what moves, likewise; none with `symmetry`.
        output: directory of the run; by default a temporary one, which goes with the run unless it is saved.
        progress: whether a progress bar is shown; by default in notebooks, and in terminals if tqdm is installed.

    Returns:
        The run. Its table has the same bytes as that of `knotdock dock` with the same options.

    Raises:
        InputError: a file or an option cannot be used.
        KnotdockError: the run failed otherwise.

    Further keywords are options of the command line, `native` and `force` among them, and:
    """
    if isinstance(receptor, Molecule):
        if output is not None:
            message = "a docking of molecules in memory has no directory"
            raise InputError(message, None, None, "leave out `output`, and save the run that is returned")
        return _in_memory(receptor, receptor if ligand is None else ligand, progress, dict(options))
    temporary = tempfile.TemporaryDirectory(prefix="knotdock-")
    directory = pathlib.Path(temporary.name, "run") if output is None else pathlib.Path(output)
    inputs = pathlib.Path(temporary.name, "inputs")

    def folder() -> pathlib.Path:
        inputs.mkdir(exist_ok=True)
        return inputs

    arguments = [given(receptor, folder, "receptor")]
    if ligand is not None:
        arguments.append(given(ligand, folder, "ligand"))
    words: dict[str, Any] = dict(options)
    for name in _STRUCTURES:
        if words.get(name) is not None:
            words[name] = given(words[name], folder, name)
    run_command("dock", *arguments, output=directory, progress=progress, **words)
    if inputs.exists():
        # Beside run.json inputs are found again, wherever the directory is moved.
        _knotdock.add(directory, sorted(inputs.iterdir()))
    return Run(directory, _temporary=temporary if output is None else None)


def _in_memory(receptor: Molecule, ligand: Any, progress: bool | None, options: dict[str, Any]) -> Run:
    if not isinstance(ligand, Molecule):
        message = "the receptor is a Molecule and the ligand is not"
        raise InputError(message, None, None, "read both with `Molecule.read`, or give both as files or structures")
    given = {name.rstrip("_"): value for name, value in options.items() if value is not None and value is not False}
    texts = [(name, "true" if value is True else text_of(value)) for name, value in given.items()]
    listener = Listener(progress)
    try:
        return MemoryRun(_knotdock.dock(receptor._inner, ligand._inner, texts, listener))
    finally:
        listener.close()


def _describe() -> None:
    """Let `help(knotdock.dock)` and editors show every option."""
    own = inspect.signature(dock)
    kept = [part for part in own.parameters.values() if part.kind is not part.VAR_KEYWORD]
    lines = []
    for option in _knotdock.options():
        name = keyword_name(option["name"])
        kept.append(inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=option["default"]))
        text = " ".join(option["help"].split())
        lines.append(textwrap.fill(f"{name}: {text}", 112, initial_indent="    ", subsequent_indent="        "))
    # Options of the command line that are not of every run.
    kept.append(inspect.Parameter("options", inspect.Parameter.VAR_KEYWORD))
    dock.__signature__ = own.replace(parameters=kept)  # type: ignore[attr-defined]
    dock.__doc__ = inspect.cleandoc(dock.__doc__ or "") + "\n\n" + "\n".join(lines) + "\n"


_describe()
