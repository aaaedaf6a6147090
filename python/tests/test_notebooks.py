"""What the cells of notebooks show."""

import html
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import types

import knotdock
import numpy as np
import pytest
from conftest import EXAMPLES, ROOT
from knotdock.progress import ProgressBar

# What a build without the feature `viewer` reads instead; `npm ci --prefix viewer` makes the folder.
LIBRARY = ROOT / "viewer" / "node_modules" / "3dmol"
needs_library = pytest.mark.skipif(not LIBRARY.exists(), reason="npm's package 3dmol is not installed")
CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
HOSTILE = "<img src=x onerror=alert(1)>"
TETRAHEDRON = (np.array([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]]), [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


@pytest.fixture
def run(helices, options, tmp_path):
    """A run of files whose names are markup."""
    files = [shutil.copy(file, tmp_path / f"{HOSTILE}{place}.pdb") for place, file in enumerate(helices)]
    return knotdock.dock(*files, **options)


def test_a_run_shows_its_names_its_best_score_and_a_table(run, helices, options):
    assert repr(run).startswith(f"<Run of {HOSTILE}0.pdb and {HOSTILE}1.pdb: {len(run.scores)} poses, best score ")
    assert f"{run.scores[0]:.1f}" in repr(run) and str(run.directory) in repr(run)
    shown = run._repr_html_()
    assert "<img" not in shown and "&lt;img src=x onerror=alert(1)&gt;0.pdb" in shown
    assert shown.count("<tr>") == 1 + min(10, len(run.scores))
    assert re.findall("<th[^>]*>([^<]*)", shown)[:2] == ["rank", "score"]
    assert re.findall("<td[^>]*>([^<]*)", shown)[:2] == ["1", f"{run.scores[0]:.2f}"]
    # Of molecules in memory and of files alike.
    in_memory = knotdock.dock(*(knotdock.Molecule.read(file) for file in helices), **options)
    assert "in memory" in repr(in_memory) and in_memory._repr_html_().count("<tr>") == shown.count("<tr>")


def test_names_and_colours_are_by_chains_conformations_and_copies(helices, options, tmp_path, monkeypatch):
    monkeypatch.setattr("knotdock._knotdock.view_page", lambda data, package: data)

    def sides(run):
        return json.loads(run.view(1).page)["sides"]

    in_memory = knotdock.dock(*(knotdock.Molecule.read(file) for file in helices), **options)
    assert sides(in_memory) == sides(knotdock.dock(*helices, **options)) == [["A", "B"], ["C"]]
    dimer = str(EXAMPLES / "4e43_dimer.pdb")
    with pytest.warns(knotdock.KnotdockWarning, match="same molecule"):
        chains = knotdock.dock(f"{dimer}:A", f"{dimer}:B", **options)
    assert repr(chains).startswith("<Run of 4e43_dimer.pdb:A and 4e43_dimer.pdb:B: ")
    ring = knotdock.dock(EXAMPLES / "4e43_molecule.pdb", symmetry="C3", rotations=24)
    assert repr(ring).startswith("<Run of 4e43_molecule.pdb: ")
    assert "its copies in other colours" in repr(ring.view(1)) and sides(ring) == [["A"], ["B"], ["C"]]
    atoms = "".join(line for line in open(helices[1]) if line.startswith(("ATOM", "TER")))
    models = "".join(f"MODEL     {number:4}\n{atoms}ENDMDL\n" for number in (1, 2))
    (tmp_path / "models.pdb").write_text(f"{models}END\n")
    ensemble = knotdock.dock(helices[0], tmp_path / "models.pdb", ligand_models="all", **options)
    assert " and models.pdb (2 conformations): " in repr(ensemble)
    assert "<table>" in ensemble._repr_html_() and len(sides(ensemble)) == 2


def test_inputs_that_are_gone_leave_the_table(run):
    rank_2 = run.view(2)
    assert "Rank 2" in repr(rank_2)
    for file in pathlib.Path(run.record["inputs"]["receptor"]["path"]).parent.glob("*.pdb"):
        file.unlink()
    shutil.rmtree(run.directory / "top")
    assert run._repr_html_().count("<tr>") > 1
    with pytest.raises(knotdock.InputError):
        run.view(1)


def test_molecules_and_balls_show_a_table_and_a_view():
    molecule = knotdock.Molecule.read(EXAMPLES / "4e43_dimer.pdb")
    shown = molecule._repr_html_()
    assert f"Molecule of {len(molecule)} atoms" in shown and shown.count("<tr>") == 3
    assert len(re.findall(r">[AB]</td><td[^>]*>99</td>", shown)) == 2
    balls = knotdock.sample(TETRAHEDRON, grid="2^12")
    assert f"{len(balls)} balls" in balls._repr_html_() and balls._repr_html_().count("<tr>") == 4


def test_a_build_without_the_view_says_how_to_get_it(run, tmp_path, monkeypatch):
    monkeypatch.setattr("knotdock._knotdock.view_page", lambda data, package: None)
    view = run.view(1)
    assert view.page is None and "npm" in view._repr_html_() and "<img" not in view._repr_html_()
    with pytest.raises(knotdock.KnotdockError, match="no three-dimensional view"):
        view.save(tmp_path / "view.html")
    monkeypatch.undo()
    with pytest.raises(knotdock.InputError, match="3Dmol-min.js"):
        run.view(1, viewer=tmp_path)


def test_a_view_is_an_isolated_frame_that_loads_nothing(run, tmp_path):
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "3Dmol-min.js").write_text("")
    (tmp_path / "LICENSE").write_text("")
    view = run.view(1, viewer=tmp_path)
    shown = view._repr_html_()
    assert "<img" not in shown and '<iframe sandbox="allow-scripts"' in shown
    assert f'srcdoc="{html.escape(view.page)}"' in shown and "default-src 'none'" in view.page
    view.save(tmp_path / "view.html")
    assert (tmp_path / "view.html").read_text() == view.page


@needs_library
@pytest.mark.skipif(not (shutil.which("node") and os.path.exists(CHROMIUM)), reason="there is no browser")
def test_views_appear_in_a_browser_without_a_network(run, tmp_path):
    meshes = knotdock.dock(TETRAHEDRON, TETRAHEDRON, rotations=60, sample_grid="2^12")
    views = {
        "complex": run.view(1, viewer=LIBRARY),
        "molecule": knotdock.Molecule.read(EXAMPLES / "4e43_dimer.pdb").view(viewer=LIBRARY),
        "balls": knotdock.sample(TETRAHEDRON, grid="2^12").view(viewer=LIBRARY),
        "meshes": meshes.view(1, viewer=LIBRARY),
    }
    assert all(len(view.page) < 400_000 for view in views.values())
    cells = {name: view._repr_html_() for name, view in views.items()}
    cells["hidden"] = f"<div hidden>{cells['balls']}</div>"
    for name, cell in cells.items():
        (tmp_path / f"{name}.html").write_text(f"<!DOCTYPE html><meta charset=utf-8><title>cell</title>{cell}")
    script = ROOT / "viewer" / "test" / "cell.mjs"
    done = subprocess.run(
        ["node", script, *(tmp_path / f"{name}.html" for name in cells)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_scores_are_plotted(run, monkeypatch):
    import matplotlib

    matplotlib.use("Agg")
    axes = run.plot_scores()
    assert axes.get_xlabel() == "rank" and len(axes.figure.axes) == 1
    assert np.array_equal(axes.collections[0].get_offsets()[:, 1], run.scores)
    known = knotdock.Run(run.directory)
    table = {**run.table("numpy"), "irmsd": np.linspace(0, 30, len(run.scores))}
    monkeypatch.setattr(known, "table", lambda frame: table)
    axes = known.plot_scores(matplotlib.pyplot.figure().add_subplot())
    assert axes.figure.axes[1].get_ylabel() == "i-RMSD (Å)"
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match=r"pip install 'knotdock\[plot\]'"):
        run.plot_scores()


def test_a_kernel_of_jupyter_shows_progress_and_html(helices):
    from jupyter_client.manager import start_new_kernel

    manager, client = start_new_kernel()
    messages = []
    code = f"import knotdock\nrun = knotdock.dock({helices[0]!r}, {helices[1]!r}, rotations=24, poses=40)\nrun"
    try:
        reply = client.execute_interactive(code, timeout=120, output_hook=messages.append)
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)
    assert reply["content"]["status"] == "ok", reply
    shown = [(message["msg_type"], message["content"]["data"]) for message in messages if "data" in message["content"]]
    bars = [data["text/html"] for kind, data in shown if kind != "execute_result"]
    assert any(re.search(r'search <progress value="\d+" max="\d+">', bar) for bar in bars), bars
    assert bars[-1] == ""
    (result,) = (data for kind, data in shown if kind == "execute_result")
    assert result["text/plain"].startswith("<Run of ") and "<table>" in result["text/html"]


def test_marimo_shows_its_own_bar(monkeypatch):
    calls = []

    class Bar:
        def __init__(self, **options):
            calls.append(options)

        def __enter__(self):
            return self

        def __exit__(self, *_):
            calls.append("closed")

        def update(self, steps):
            calls.append(steps)

    marimo = types.SimpleNamespace(
        running_in_notebook=lambda: True, status=types.SimpleNamespace(progress_bar=lambda **options: Bar(**options))
    )
    monkeypatch.setitem(sys.modules, "marimo", marimo)
    for shown in (None, False):
        bar = ProgressBar(shown)
        bar.stage("search", 3)
        bar.advance(2)
        bar.close()
    assert calls == [{"total": 3, "title": "search", "remove_on_exit": True}, 2, "closed"]
