"""Many pairs: batches, their tables, and screens on a cluster."""

import csv

import knotdock
import numpy as np
import pytest
from conftest import CASES

DOCK = {"rotations": 24, "poses": 40}


@pytest.fixture
def pairs(tmp_path):
    """A table of four pairs, of which the third has no file."""
    path = tmp_path / "pairs.csv"
    names = ("helices", "charged_helices", "none", "salt_bridge")
    with path.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["name", "receptor", "ligand"])
        rows.writerows([name, CASES / f"{name}_receptor.pdb", CASES / f"{name}_ligand.pdb"] for name in names)
    return path


def test_shards_are_merged_and_read(pairs, tmp_path):
    out = tmp_path / "out"
    knotdock.batch(pairs, out, dock=DOCK, keep="table", rows=5, shard="2/2")
    with pytest.warns(knotdock.KnotdockWarning, match="none failed"):
        knotdock.batch(pairs, out, dock=DOCK, keep="table", rows=5, shard="1/2")
    merged = knotdock.merge(out)
    assert (merged["pairs"], merged["done"], merged["failed"]) == (4, 3, 1)
    results = knotdock.read_results(out)
    assert results["status"].tolist() == ["done", "done", "failed", "done"]
    poses = knotdock.read_poses(out)
    assert set(poses["name"]) == {"helices", "charged_helices", "salt_bridge"}
    run = knotdock.dock(CASES / "helices_receptor.pdb", CASES / "helices_ligand.pdb", **DOCK)
    own = poses[poses["name"] == "helices"]
    assert np.array_equal(own["score"], run.scores[: len(own)])
    pairwise = dict(knotdock.iterate_poses(out))
    assert list(pairwise) == list(dict.fromkeys(poses["name"]))
    assert np.array_equal(pairwise["helices"]["score"], own["score"])
    assert len(knotdock.read_poses(out, "polars")) == len(knotdock.read_poses(out, "numpy")["name"]) == len(poses)
    assert list(knotdock.read_poses(run.directory).columns) == list(run.poses.columns)


def test_a_screen_on_a_cluster_makes_the_same_table(pairs, tmp_path, monkeypatch):
    pytest.importorskip("distributed")
    import pandas
    from distributed import Client, LocalCluster

    with pytest.warns(knotdock.KnotdockWarning, match="none failed"):
        knotdock.batch(pairs, tmp_path / "plain", dock=DOCK, keep="table", rows=5)
    expected = knotdock.read_poses(tmp_path / "plain")
    place = tmp_path / "screen"
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        done = knotdock.screen(pairs, client, output=place, dock=DOCK, rows=5, shards=3)
        assert (done["pairs"], done["done"], done["failed"]) == (4, 3, 1)
        parts = {path: path.stat().st_mtime_ns for path in place.glob("*/*.parquet")}
        # Only missing pairs are done again.
        missing = place / "poses" / "part-0002-of-0003.parquet"
        missing.unlink()
        again = knotdock.screen(pairs, client, output=place, dock=DOCK, rows=5)
        assert again == done
        kept = [path for path, time in parts.items() if path.stat().st_mtime_ns == time]
        assert len(parts) == 6 and len(kept) == 4
        with pytest.raises(ValueError, match="3 shards"):
            knotdock.screen(pairs, client, output=place, shards=4)
        monkeypatch.chdir(CASES)
        sides = {side: f"helices_{side}.pdb" for side in ("receptor", "ligand")}
        native = {f"native_{side}": path for side, path in sides.items()}
        rows = pandas.DataFrame([{"name": "a", **sides, **native, "rotations": "12"}, {"name": "b", **sides}])
        few = knotdock.screen(rows, client, output=tmp_path / "few", rows=None)
        assert few["done"] == 2
        labels = pandas.read_parquet(few["poses"]).groupby("name")["irmsd"].count()
        assert labels["a"] > 0 and labels["b"] == 0
    poses = pandas.read_parquet(done["poses"]).sort_values(["name", "rank"]).reset_index(drop=True)
    expected = expected.sort_values(["name", "rank"]).reset_index(drop=True)
    pandas.testing.assert_frame_equal(poses, expected, check_dtype=False)
    results = pandas.read_parquet(done["results"]).sort_values("row")
    assert results["status"].tolist() == ["done", "done", "failed", "done"]
