"""Many pairs on a cluster: shards of a batch as tasks of Dask."""

from __future__ import annotations

import json
import math
import os
import pathlib
import shutil
import tempfile
from typing import TYPE_CHECKING, Any

from knotdock.functions import batch
from knotdock.progress import ProgressBar
from knotdock.tables import unquoted

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["screen"]

_TEXTS = ("name", "receptor", "ligand", "status", "error", "capri")
_COUNTS = (
    "row",
    "rank",
    "poses",
    "clusters",
    "cluster",
    "cluster_size",
    "sharp_clashes",
    "restraints_met",
    "first_acceptable_rank",
)
# Pairs per shard if their number is not given: some minutes of work on one core.
_PAIRS_A_SHARD = 50


def screen(
    pairs: Any,
    client: Client,
    *,
    output: str | os.PathLike[str],
    dock: dict[str, Any] | None = None,
    shards: int | None = None,
    rows: int | None = 200,
    threads: int = 1,
    progress: bool | None = None,
    remove_shards: bool = False,
    **options: Any,
) -> dict[str, Any]:
    """Dock the pairs of a table on a cluster of Dask.

    Each shard is one task: `knotdock batch --shard I/N --keep table`, then its tables as Parquet. A task whose worker
    dies is started again elsewhere, and goes on after the last pair that it finished. Called again, the function goes
    on with what is left.

    Args:
        pairs: a table of pairs: a path, or rows (a DataFrame or a list of dicts) with columns `receptor`, `ligand` and
            perhaps `name` and options of `dock`.
        client: a client of any cluster: `Client(LocalCluster())`, dask-jobqueue on Slurm, Kubernetes.
        output: directory that all workers see; the shards are in its folder `batch`.
        dock: options of `knotdock.dock` for all pairs.
        shards: number of shards; by default one for 50 pairs, and four a thread of the cluster at least. A screen that
            goes on keeps its own.
        rows: poses of each pair that are kept, best first; None for all.
        threads: threads of each task.
        progress: whether a progress bar is shown.
        remove_shards: whether a shard's files are removed once they are in Parquet.
        options: further options of `knotdock batch`, such as `time_limit="10min"` and `scratch="/tmp"`.

    Returns:
        `results` and `poses`, folders of Parquet files (`pandas.read_parquet(folder)`), and the counts `pairs`, `done`
        and `failed`.
    """
    from distributed import as_completed

    place = pathlib.Path(os.path.abspath(output))
    table, count = _table(pairs, place)
    cores = sum(client.nthreads().values())
    number = _shards(place, shards, count, cores)
    for name in ("results", "poses"):
        (place / name).mkdir(exist_ok=True)
    bar = ProgressBar(progress)
    bar.stage("shards", number)
    settings = {"rows": "all" if rows is None else rows, "threads": threads, **options}
    tasks = [
        client.submit(
            _shard,
            (str(table), str(place), f"{index}/{number}"),
            dock,
            settings,
            remove_shards,
            pure=False,
            retries=3,
        )
        for index in range(1, number + 1)
    ]
    done = failed = 0
    try:
        for task in as_completed(tasks):
            shard_done, shard_failed = task.result()
            done, failed = done + shard_done, failed + shard_failed
            bar.advance(1)
    finally:
        bar.close()
        client.cancel([task for task in tasks if not task.done()])
    folders = {name: str(place / name) for name in ("results", "poses")}
    return {**folders, "pairs": done + failed, "done": done, "failed": failed}


def _table(pairs: Any, place: pathlib.Path) -> tuple[pathlib.Path, int]:
    """The table as a file that workers see, and the number of its pairs."""
    place.mkdir(parents=True, exist_ok=True)
    if isinstance(pairs, (str, os.PathLike)):
        path = pathlib.Path(os.path.abspath(pairs))
    else:
        path = place / "pairs.csv"
        text = _rows(pairs)
        if not path.exists() or path.read_text() != text:
            path.write_text(text)
    with path.open() as file:
        lines = [line for line in file if line.strip() and not line.startswith("#")]
    return path, len(lines) - 1


def _rows(pairs: Any) -> str:
    import csv
    import io

    rows = pairs.to_dicts() if hasattr(pairs, "to_dicts") else pairs
    rows = rows.to_dict("records") if hasattr(rows, "to_dict") else list(rows)
    columns = list(dict.fromkeys(name for row in rows for name in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    for row in rows:
        # What a DataFrame has in an empty cell differs from itself.
        there = {name: value for name, value in row.items() if value is not None and value == value}
        writer.writerow({name: _absolute(name, value) for name, value in there.items()})
    return text.getvalue()


def _absolute(name: str, value: Any) -> Any:
    """A cell of the table: files are looked for from the table's folder, which is not where the caller is."""
    is_structure = name in ("receptor", "ligand", "native", "native_receptor", "native_ligand")
    if is_structure or (isinstance(value, (str, os.PathLike)) and os.path.exists(value)):
        return os.path.abspath(os.fspath(value))
    return value


def _shards(place: pathlib.Path, wanted: int | None, pairs: int, cores: int) -> int:
    """How many shards the screen has: as many as it had before, where it goes on."""
    path = place / "screen.json"
    if path.exists():
        before = json.loads(path.read_text())["shards"]
        if wanted not in (None, before):
            message = f"{place} holds a screen of {before} shards, and {wanted} are requested"
            raise ValueError(message)
        return before
    number = wanted or min(pairs, max(math.ceil(pairs / _PAIRS_A_SHARD), 4 * cores))
    number = max(number, 1)
    path.write_text(json.dumps({"shards": number}) + "\n")
    return number


def _shard(
    where: tuple[str, str, str],
    dock: dict[str, Any] | None,
    settings: dict[str, Any],
    remove: bool,
) -> tuple[int, int]:
    """One task: docks a shard, and writes its tables as Parquet; pairs that were docked and that failed."""
    table, directory, shard = where
    index, number = shard.split("/")
    name = f"{int(index):04}-of-{int(number):04}"
    place = pathlib.Path(directory)
    parts = {kind: place / kind / f"part-{name}.parquet" for kind in ("results", "poses")}
    if not all(part.exists() for part in parts.values()):
        # A batch has a directory of its own.
        output = place / "batch"
        batch(table, output, keep="table", shard=shard, dock=dock, progress=False, **settings)
        folder = output / "shards" / name
        _to_parquet(folder / "poses.csv.gz", parts["poses"])
        _to_parquet(folder / "results.csv", parts["results"], (int(index), int(number)))
        if remove:
            shutil.rmtree(folder)
    status = _statuses(parts["results"])
    return status.count("done"), status.count("failed")


def _to_parquet(table: pathlib.Path, part: pathlib.Path, shard: tuple[int, int] | None = None) -> None:
    """A table of a shard as Parquet, whole or not at all; with `shard` it has one row per pair, and gets their rows' numbers."""
    import pyarrow as pa
    import pyarrow.csv as csv
    import pyarrow.parquet as parquet

    with csv.open_csv(table) as reader:
        names = reader.schema.names
    kinds = {name: _kind(name) for name in names}
    convert = csv.ConvertOptions(column_types=kinds, strings_can_be_null=True)
    found = csv.read_csv(table, convert_options=convert)
    for place, name in enumerate(names):
        if name in _TEXTS:
            cells = [cell and unquoted(cell) for cell in found.column(name).to_pylist()]
            found = found.set_column(place, name, pa.array(cells, pa.string()))
    if shard:
        first, step = shard
        rows = range(first, first + step * found.num_rows, step)
        found = found.add_column(0, "row", pa.array(rows, pa.int64()))
    handle, path = tempfile.mkstemp(dir=part.parent, prefix=".part-")
    os.close(handle)
    try:
        parquet.write_table(found, path, compression="zstd")
        os.replace(path, part)
    except BaseException:
        os.unlink(path)
        raise


def _kind(name: str) -> Any:
    import pyarrow as pa

    if name in _TEXTS:
        return pa.string()
    return pa.int64() if name in _COUNTS else pa.float64()


def _statuses(part: pathlib.Path) -> list[str]:
    import pyarrow.parquet as parquet

    return parquet.read_table(part, columns=["status"]).column("status").to_pylist()
