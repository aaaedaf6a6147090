"""Tables of CSV as NumPy arrays, pandas or polars."""

from __future__ import annotations

import csv
import gzip
import io
import itertools
import os
from collections.abc import Iterator
from typing import Any, Literal

import numpy as np

__all__ = ["Frame", "iterate_poses", "read_poses", "read_results", "read_table", "unquoted"]

Frame = Literal["pandas", "polars", "numpy"]


def read_table(path: str | os.PathLike[str] | io.StringIO, frame: Frame = "pandas") -> Any:
    """A table, of a file or of text, as a pandas or polars DataFrame, or as a dict of NumPy arrays by column.

    Empty cells are NaN, or null in polars. A quote in front of a cell that a spreadsheet would take for a formula is
    taken off.
    """
    path = path if isinstance(path, io.StringIO) else os.fspath(path)
    if frame == "pandas":
        import pandas

        # Before pandas 3 the last digits of numbers were not read exactly.
        is_old = int(pandas.__version__.split(".")[0]) < 3
        precise = {"float_precision": "round_trip"} if is_old else {}
        table = pandas.read_csv(path, keep_default_na=False, na_values=[""], **precise)
        texts = table.select_dtypes(exclude="number").columns
        for name in texts:
            table[name] = table[name].map(unquoted, na_action="ignore")
        return table
    if frame == "polars":
        import polars

        table = polars.read_csv(path, infer_schema_length=None)
        texts = [name for name, kind in table.schema.items() if kind == polars.String]
        return table.with_columns(polars.col(name).map_elements(unquoted, return_dtype=polars.String) for name in texts)
    if frame == "numpy":
        return _arrays(path)
    message = f"frame is {frame!r}; it must be 'pandas', 'polars' or 'numpy'"
    raise ValueError(message)


def unquoted(cell: str) -> str:
    """A cell without the quote that keeps spreadsheets from taking it for a formula."""
    return cell[1:] if cell.startswith("'") and cell.lstrip("'")[:1] in tuple("=+-@\t\r") else cell


def _arrays(path: str | io.StringIO) -> dict[str, np.ndarray]:
    with _opened(path) as file:
        rows = csv.reader(file)
        return _columns(next(rows), rows)


def _opened(path: str | io.StringIO) -> Any:
    if isinstance(path, io.StringIO):
        return path
    return gzip.open(path, "rt", newline="") if path.endswith(".gz") else open(path, newline="")


def _columns(header: list[str], rows: Iterator[list[str]]) -> dict[str, np.ndarray]:
    columns = list(zip(*rows, strict=True)) or [()] * len(header)
    return {name: _array(cells) for name, cells in zip(header, columns, strict=True)}


def _array(cells: tuple[str, ...]) -> np.ndarray:
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return np.array([unquoted(cell) for cell in cells])


def read_results(path: str | os.PathLike[str], frame: Frame = "pandas") -> Any:
    """`results.csv` of a batch: one row per pair. `path` is the file or the batch's directory."""
    path = os.fspath(path)
    return read_table(os.path.join(path, "results.csv") if os.path.isdir(path) else path, frame)


def read_poses(path: str | os.PathLike[str], frame: Frame = "pandas") -> Any:
    """The poses of a run (`poses.csv`) or of a batch (`poses.csv.gz`): one row per pose.

    `path` is the file, or the directory of the run or batch.
    """
    return read_table(_poses_file(path), frame)


def _poses_file(path: str | os.PathLike[str]) -> str:
    path = os.fspath(path)
    if os.path.isdir(path):
        names = (os.path.join(path, name) for name in ("poses.csv", "poses.csv.gz"))
        path = next((name for name in names if os.path.exists(name)), os.path.join(path, "poses.csv"))
    return path


def iterate_poses(path: str | os.PathLike[str]) -> Iterator[tuple[str, dict[str, np.ndarray]]]:
    """The poses of a batch pair by pair, each as its name and a dict of NumPy arrays by column.

    One pair is in memory at a time. `path` is the batch's `poses.csv.gz` or its directory.
    """
    with _opened(_poses_file(path)) as file:
        rows = csv.reader(file)
        header = next(rows)
        place = header.index("name")
        for name, of_pair in itertools.groupby(rows, key=lambda row: row[place]):
            yield unquoted(name), _columns(header, of_pair)
