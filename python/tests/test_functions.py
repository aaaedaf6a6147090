"""The other commands, molecules and correlations."""

import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys

import knotdock
import numpy as np
import pytest
from conftest import CASES, EXAMPLES


def test_commands_give_the_objects_of_the_command_line(helices):
    for words, result in [
        (["inspect", helices[0]], knotdock.inspect(helices[0])),
        (["score", *helices, "--pose=1,0,0,0,0,0,0"], knotdock.score(*helices)),
    ]:
        program = [sys.executable, "-m", "knotdock", *words, "--json"]
        said = subprocess.run(program, check=True, capture_output=True, text=True).stdout
        expected = json.loads(said)
        differ = [name for name in expected if expected[name] != result[name]]
        # Times are those of the call.
        assert set(differ) <= {"timing", "rows"}, differ


def test_solids_are_arrays_or_files():
    cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    faces = [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
    ]
    faces += [[1, 5, 7], [1, 7, 3]]
    balls = knotdock.sample((cube, faces), grid="2^12")
    assert np.asarray(balls).shape == (len(balls), 4)
    assert (balls.centers >= -balls.radii[:, None]).all()
    near = knotdock.collide((cube, faces), np.array([[0.5, 0.5, 0.5, 0.2]]))
    far = knotdock.collide((cube, faces), np.array([[0.5, 0.5, 0.5, 0.2]]), pose=[1, 0, 0, 0, 9, 0, 0])
    assert near != far
    grown = knotdock.morph("offset", (cube, faces), distance=0.5)
    assert grown["operation"] if "operation" in grown else grown
    with pytest.raises(TypeError, match="a mesh is a pair"):
        knotdock.sample((cube, [[0, 1]]))


def test_complexes_are_evaluated_and_measured():
    native = pathlib.Path(EXAMPLES, "4e43_dimer.pdb")
    (quality,) = knotdock.evaluate(native, native, chains=("A", "B"))
    assert quality["dockq"] == pytest.approx(1.0)
    assert knotdock.interface(native, "A", "B")


def test_models_are_rated(tmp_path):
    dimer = pathlib.Path(EXAMPLES, "4e43_dimer.pdb").read_text()
    path = tmp_path / "<b>.pdb"
    path.write_text(dimer)
    scores, more = tmp_path / "scores.json", tmp_path / "more.json"
    scores.write_text(json.dumps({"iptm": 0.875}))
    more.write_text(json.dumps({"ptm": 0.75}))
    found = knotdock.models(path, confidence=[scores, more], native=dimer)
    table = found.table("numpy")
    assert table["iptm"].tolist() == [0.875]
    assert table["model_ptm"].tolist() == [0.75]
    assert table["dockq"][0] == pytest.approx(1.0)
    assert table["trust"].tolist() == [found.systems[0]["trust"]] == ["uncertain"]
    assert [pair["iptm"] for pair in found.models[0]["pairs"]] == [0.875]
    page = found._repr_html_()
    assert "&lt;b&gt;.pdb" in page
    assert "<b>" not in page
    assert "agreement unknown (one model)" in page
    bare = knotdock.models([dimer, path])
    assert len(bare) == 2
    assert "dockq" not in bare.table("numpy")
    with pytest.raises(knotdock.InputError):
        knotdock.models([dimer, path], confidence=scores)


def test_molecules_are_arrays(helices):
    molecule = knotdock.Molecule.read(helices[0])
    assert molecule.positions.shape == (len(molecule), 3)
    assert len(molecule.atoms) == len(molecule)
    assert set(molecule.atoms.dtype.names) >= {"x", "r", "chain", "residue_number", "element"}
    assert (molecule.radii > 1.0).all()
    chosen = knotdock.Molecule.read(f"{EXAMPLES / '4e43_dimer.pdb'}:B")
    assert set(chosen.labels["chain"]) == {"B"}
    with pytest.raises(knotdock.InputError):
        knotdock.Molecule.read(CASES / "none.pdb")
    with pytest.raises(knotdock.InputError):
        knotdock.Molecule.read(helices[0], waters="some")


def test_a_correlation_is_the_exact_sum(helices):
    receptor, ligand = (knotdock.Molecule.read(path).balls for path in helices)
    correlator = knotdock.Correlator(receptor, ligand, tolerance=1e-3)
    turn = np.array([0.8, 0.0, 0.6, 0.0])
    grid = correlator.correlate(turn)
    assert grid.shape == tuple(correlator.size)
    peaks = correlator.peaks(turn, 20)
    scores = np.array([peak[0] for peak in peaks])
    exact = correlator.score(np.array([peak[1] for peak in peaks]), np.array([peak[2] for peak in peaks]))
    assert np.abs(scores - exact).max() < 5e-3 * exact.max()
    assert (np.diff(scores) <= 0).all()
    best = np.unravel_index(np.argmax(grid), grid.shape)
    quaternion, shift = correlator.pose(turn, best)
    assert np.allclose(shift, peaks[0][2]) and np.allclose(quaternion, peaks[0][1])
    # Weights are factors: twice the weight, twice the score.
    twice = knotdock.Correlator(receptor, ligand, 2 * np.ones(len(receptor)), tolerance=1e-3)
    assert np.allclose(twice.correlate(turn), 2 * grid, rtol=1e-4, atol=1e-3 * np.abs(grid).max())
    for bad in (np.zeros((2, 3)), np.zeros((0, 4)), np.full((2, 4), np.nan)):
        with pytest.raises(knotdock.InputError):
            knotdock.Correlator(bad, ligand)
    with pytest.raises(knotdock.InputError, match="norm"):
        correlator.correlate([2.0, 0, 0, 0])
    with pytest.raises(knotdock.InputError, match="outside"):
        correlator.pose(turn, [10**6, 0, 0])


@pytest.fixture(scope="module")
def balls():
    numbers = np.random.default_rng(0)
    receptor = np.c_[numbers.normal(size=(20, 3)) * 4, np.full(20, 1.8)]
    return receptor, np.c_[numbers.normal(size=(8, 3)) * 3, np.full(8, 1.7)]


def test_exact_scores_take_quaternions_of_any_length_and_refuse_what_is_no_pose(balls):
    # Those of NaN, of zero and of 1e-200 were 0.0, and 1e200 gave the score of another pose.
    correlator = knotdock.Correlator(*balls)
    turn, rest = np.array([[0.3, -0.2, 0.8, 0.4]]), np.zeros((1, 3))
    score = correlator.score(turn, rest)
    assert score[0] != 0.0
    for length in (2.0, 1e-200, 1e200, 1e-308, 1e308):
        assert correlator.score(length * turn, rest) == pytest.approx(score, rel=1e-12)
    for bad in (0.0 * turn, np.full((1, 4), np.nan), np.array([[np.inf, 0, 0, 0]])):
        with pytest.raises(ValueError, match="row 0"):
            correlator.score(bad, rest)
        with pytest.raises(ValueError, match="norm"):
            correlator.correlate(bad[0])
    for bad in (np.nan, np.inf):
        with pytest.raises(ValueError, match="row 1"):
            correlator.score(np.tile(turn, (2, 1)), np.array([[0, 0, 0], [0, bad, 0]]))


def test_threads_share_a_correlator(balls):
    # Use from another thread, and of more peaks than memory has room for, ended in a panic.
    correlator = knotdock.Correlator(*balls)
    turns = [[1.0, 0, 0, 0], [0.6, 0.8, 0, 0], [0, 0, 0.6, 0.8]] * 4
    alone = [correlator.peaks(turn, 5) for turn in turns]
    with concurrent.futures.ThreadPoolExecutor(4) as threads:
        assert list(threads.map(lambda turn: correlator.peaks(turn, 5), turns)) == alone
    all_peaks = correlator.peaks(turns[0], 2**62)
    assert all_peaks[:5] == alone[0] and 5 < len(all_peaks) < np.prod(correlator.size)
    assert correlator.peaks(turns[0], 0) == []


def test_correlations_state_their_error_and_refuse_what_they_cannot_keep(balls):
    correlator = knotdock.Correlator(*balls)
    grid = correlator.correlate([1.0, 0, 0, 0])
    assert 0.0 < correlator.error <= 1e-2
    voxels = np.argwhere(grid > 0.5 * grid.max())
    poses = [correlator.pose([1.0, 0, 0, 0], voxel) for voxel in voxels]
    exact = correlator.score(*(np.array(part) for part in zip(*poses, strict=True)))
    assert np.abs(exact - grid[tuple(voxels.T)]).max() < 1e-2 * exact.max()
    # Half of the resolution is 2.25.
    with pytest.raises(ValueError, match=r"spacing of 2.25"):
        knotdock.Correlator(*balls, spacing=4.0)
    with pytest.raises(ValueError, match="coarser spacing"):
        knotdock.Correlator(*balls, spacing=0.02)
    # A second difference of the kernel, to 1e-14 of itself: less than double precision holds.
    with pytest.raises(ValueError, match="best score"):
        knotdock.Correlator(*balls, lambda_=1.0, offset=1e-7)


def test_names_that_are_not_utf_8_are_refused_by_name(helices, tmp_path):
    name = os.fsdecode(os.fsencode(tmp_path) + b"/caf\xe9.pdb")
    pathlib.Path(name).write_bytes(pathlib.Path(helices[0]).read_bytes())
    for call in (knotdock.Molecule.read, knotdock.inspect):
        with pytest.raises(ValueError, match=r"caf\\xE9.pdb"):
            call(name)


def test_any_command_runs_by_its_name(tmp_path):
    answer = knotdock.run_command("se3", "distance", "1,0,0,0,0,0,0", "1,0,0,0,3,4,0")
    assert answer["shift"] == pytest.approx(5.0)
    with pytest.raises(knotdock.InputError, match="nonsense"):
        knotdock.run_command("nonsense")


def test_the_types_of_options_are_up_to_date():
    sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "tools"))
    import make_options

    file = pathlib.Path(knotdock.__file__).parent / "_options.py"
    assert file.read_text() == make_options.text(), "run python/tools/make_options.py"
