"""Write `knotdock/_options.py`, the types of the options of `knotdock.dock`, from their one definition.

usage: python python/tools/make_options.py        with the package installed
"""

import json
import pathlib
import textwrap

from knotdock import _knotdock
from knotdock.commands import keyword_name

KINDS = {
    "flag": "bool",
    "list": "str | Sequence[str]",
    "file": "str | os.PathLike[str]",
    "number": "float | str",
    "text": "str | float | Sequence[object]",
}

HEAD = '''"""Types of the options of `knotdock.dock`. Written by python/tools/make_options.py."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Literal, TypedDict


class DockOptions(TypedDict, total=False):
    """Options of every run."""
'''

TAIL = '''

class DockArguments(DockOptions, total=False):
    """Options of the command line that are not of every run."""

    preset: Literal["fast", "default", "thorough", "shape"]
    """Options by a name."""
    config: str | os.PathLike[str] | Sequence[str | os.PathLike[str]]
    """Options from files in TOML, or from lines such as `terms.contact_weight=1`; later ones win."""
    native: Any
    """The known complex, as inputs of `dock`."""
    native_receptor: Any
    """The receptor of the known complex, in a file of its own."""
    native_ligand: Any
    """The ligand of the known complex, in a file of its own."""
    native_chains: str | Sequence[str]
    """Chains of the known complex."""
    receptor_models: str
    """Models of the receptor's file that are docked: `all` or `1,3,5-10`."""
    ligand_models: str
    """Models of the ligand's file that are docked."""
    receptor_also: Any
    """A further conformation of the receptor."""
    ligand_also: Any
    """A further conformation of the ligand."""
    accuracy: float
    """Take the cheapest setting whose error is expected to be within this share of the best score."""
    budget: str | float
    """End within a time, such as `5s`."""
    force: bool
    """Replace the run in the directory, once the new one is done."""
'''


def text() -> str:
    """The file."""
    parts = [HEAD]
    for option in _knotdock.options():
        kind = KINDS.get(option["kind"]) or f"Literal[{', '.join(json.dumps(value) for value in option['values'])}]"
        help_text = " ".join(option["help"].split()).replace("\\", "\\\\")
        if option["default"] is not None:
            help_text += f" [default: {option['default']}]"
        lines = textwrap.wrap(f'"""{help_text}"""', 112, initial_indent="    ", subsequent_indent="    ")
        parts.append(f"\n    {keyword_name(option['name'])}: {kind}\n" + "\n".join(lines) + "\n")
    return "".join(parts) + TAIL


if __name__ == "__main__":
    path = pathlib.Path(__file__).parents[1] / "knotdock" / "_options.py"
    path.write_text(text())
    print(path)
