"""Docking from Python gives the same results as the command line."""

import os
import pathlib
import subprocess
import sys
import threading
import time

import knotdock
import numpy as np
import pytest


def test_the_table_has_the_bytes_of_the_command_line(helices, options, tmp_path):
    run = knotdock.dock(*helices, **options)
    words = [f"--{name.replace('_', '-')}={value}" for name, value in options.items()]
    program = [sys.executable, "-m", "knotdock", "dock", *helices, *words, "-o", str(tmp_path / "run")]
    subprocess.run(program, check=True, capture_output=True)
    for name in ("poses.csv", "interface.csv", "view.pml", "top/rank_0001.pdb"):
        assert (run.directory / name).read_bytes() == (tmp_path / "run" / name).read_bytes(), name
    assert run.complex(1) == (tmp_path / "run" / "top" / "rank_0001.pdb").read_text()


def test_arrays_agree_with_the_table_and_the_complexes(helices, options):
    run = knotdock.dock(*helices, **options)
    table, numbers = run.poses, run.table("numpy")
    assert list(table.columns) == list(numbers) == run.table("polars").columns
    assert np.array_equal(table["score"], run.scores)
    ligand = knotdock.Molecule.read(helices[1])
    placed = ligand.positions @ run.rotations[0].T + run.translations[0]
    atoms = [line for line in run.complex(1).splitlines() if line.startswith("ATOM")]
    written = np.array([[float(line[place : place + 8]) for place in (30, 38, 46)] for line in atoms])
    assert np.allclose(written[-len(ligand) :], placed, atol=6e-4)
    assert np.allclose(run.rotations @ np.swapaxes(run.rotations, 1, 2), np.eye(3))
    assert run.record["results"]["rows"] == len(run.scores)


def test_inputs_of_every_kind_make_the_same_table(helices, options):
    import biotite.structure.io.pdb as pdb
    import gemmi
    from Bio.PDB import PDBParser

    expected = knotdock.dock(*helices, **options)
    texts = [pathlib.Path(path).read_text() for path in helices]
    structures = {
        "path": [pathlib.Path(path) for path in helices],
        "text": texts,
        "bytes": [text.encode() for text in texts],
        "biotite": [pdb.PDBFile.read(path).get_structure(model=1) for path in helices],
        "biopython": [PDBParser(QUIET=True).get_structure("x", path) for path in helices],
        "gemmi": [gemmi.read_structure(path) for path in helices],
    }
    for kind, pair in structures.items():
        run = knotdock.dock(*pair, **options)
        assert np.allclose(run.scores, expected.scores, rtol=1e-6), kind
    with pytest.raises(TypeError, match="neither a path"):
        knotdock.dock(helices[0], 3.0)


def test_a_run_is_saved_opened_and_evaluated(helices, options, tmp_path):
    run = knotdock.dock(pathlib.Path(helices[0]).read_bytes(), helices[1], **options)
    temporary = run.directory
    saved = run.save(tmp_path / "kept")
    assert saved.scores.tolist() == run.scores.tolist()
    del run
    assert not temporary.exists()
    # The input that came as bytes is found beside run.json.
    assert saved.complex(2).startswith("REMARK")
    native = saved.complex(1)
    evaluated = knotdock.Run(tmp_path / "kept").evaluate(native)
    assert evaluated["irmsd"][0] < 0.01
    assert evaluated["capri"][0] == "high"
    with pytest.raises(knotdock.InputError, match="in the way"):
        saved.save(tmp_path / "kept")
    with pytest.raises(knotdock.InputError, match="no directory of a run"):
        knotdock.Run(tmp_path)


def test_a_file_of_the_user_s_stays(helices, options, tmp_path):
    text = pathlib.Path(helices[0]).read_text()
    (tmp_path / "receptor.pdb").write_text("mine")
    with pytest.raises(knotdock.InputError, match="not empty"):
        knotdock.dock(text, helices[1], output=tmp_path, **options)
    assert (tmp_path / "receptor.pdb").read_text() == "mine"
    run = knotdock.dock(text, helices[1], output=tmp_path / "run", **options)
    assert (tmp_path / "run/receptor.pdb").read_text() == text
    assert run.complex(2).startswith("REMARK")
    assert len(knotdock.dock(text, helices[1], output=tmp_path / "run", force=True, **options).scores)


def test_errors_have_their_parts(helices, tmp_path):
    broken = tmp_path / "broken.pdb"
    broken.write_text("ATOM      1  CA  ALA A   1      nonsense\n")
    with pytest.raises(knotdock.InputError) as caught:
        knotdock.dock(broken, helices[1])
    error = caught.value
    assert (error.file, error.line) == (str(broken), 1)
    assert error.message and error.remedy
    assert isinstance(error, ValueError) and str(broken) in str(error)
    with pytest.raises(knotdock.InputError, match="rotatoins"):
        knotdock.dock(*helices, rotatoins=5)
    with pytest.raises(knotdock.InputError, match="rotations"):
        knotdock.dock(*helices, rotations=-5)


def test_warnings_are_those_of_python(helices, options):
    with pytest.warns(knotdock.KnotdockWarning):
        knotdock.dock(*helices, **{**options, "resolution": 60, "pass_length": 120})


def test_ctrl_c_ends_a_docking(helices):
    """The signal is sent by a thread of the same process, as a terminal would send it."""
    code = (
        "import knotdock, os, signal, threading\n"
        "threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()\n"
        "try:\n"
        f"    knotdock.dock({helices[0]!r}, {helices[1]!r}, rotations=50000, threads=1)\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted')\n"
    )
    started = time.monotonic()
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300, check=False)
    assert done.stdout == "interrupted\n", done
    # The whole search would take minutes.
    assert time.monotonic() - started < 60


def test_a_panic_is_an_exception(helices):
    """Only builds with debug assertions can be made to panic; they say nothing of others."""
    code = (
        "import knotdock\n"
        "try:\n"
        f"    knotdock.dock({helices[0]!r}, {helices[1]!r}, rotations=4)\n"
        "except knotdock.KnotdockError as error:\n"
        "    print(error.message, '|', error.remedy)\n"
        f"print(len(knotdock.Molecule.read({helices[0]!r})) > 0)\n"
    )
    environment = {**os.environ, "KNOTDOCK_FAULT": "panic 3"}
    words = [sys.executable, "-c", code]
    done = subprocess.run(words, capture_output=True, text=True, check=True, env=environment)
    said = done.stdout.splitlines()
    if len(said) == 1:
        pytest.skip("built without debug assertions")
    assert said == ["knotdock failed: this is a bug | report it with the call and its files", "True"]


def test_other_threads_of_python_run_meanwhile(helices, options):
    ticks, stop = [], threading.Event()

    def tick() -> None:
        while not stop.wait(0.005):
            ticks.append(None)

    thread = threading.Thread(target=tick)
    thread.start()
    knotdock.dock(*helices, **{**options, "rotations": 600})
    stop.set()
    thread.join()
    assert len(ticks) > 5


@pytest.mark.skipif(not os.path.isdir("/proc/self/task"), reason="threads are counted on Linux alone")
def test_no_thread_outlives_its_work(helices, options, tmp_path):
    """Rayon's global pool would: nothing may start it, neither a docking nor what is asked of its run."""
    code = (
        "import knotdock, os, time\n"
        "threads = lambda: len(os.listdir('/proc/self/task'))\n"
        "before = threads()\n"
        f"molecules = [knotdock.Molecule.read(file) for file in {helices!r}]\n"
        f"run = knotdock.dock(*molecules, **{options!r})\n"
        f"run.record, run.complex(1), run.save({str(tmp_path / 'run')!r})\n"
        "end = time.monotonic() + 20\n"
        "while threads() > before and time.monotonic() < end:\n"
        "    time.sleep(0.01)\n"
        "print(threads() - before)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "0\n", done


def test_help_shows_every_option():
    for option in knotdock.options():
        assert f"{option['name']}" in knotdock.dock.__doc__
    import inspect

    parameters = inspect.signature(knotdock.dock).parameters
    assert parameters["rotations"].kind is inspect.Parameter.KEYWORD_ONLY
    assert {"receptor", "ligand", "output", "progress"} <= set(parameters)


def test_each_stage_advances_by_its_own_steps(helices, options, monkeypatch):
    """A notebook once showed 2 steps of 1, which were those of two stages, and 0 of 0."""
    stages = []

    class Bar:
        def __init__(self, shown):
            pass

        def stage(self, name, total):
            stages.append([name, total, 0])

        def advance(self, steps):
            stages[-1][2] += steps

        def close(self):
            pass

    monkeypatch.setattr("knotdock.commands.ProgressBar", Bar)
    knotdock.dock(*helices, **options)
    assert [name for name, _, _ in stages][:2] == ["prepare", "search"]
    assert all(total > 0 and steps == total for _, total, steps in stages), stages


def test_molecules_are_docked_in_memory(helices, options, tmp_path):
    molecules = [knotdock.Molecule.read(file) for file in helices]
    run = knotdock.dock(*molecules, **options, lambda_=8)
    of_files = knotdock.dock(*helices, **options, lambda_=8)
    assert np.array_equal(run.scores, of_files.scores)
    assert run.complex(1) == of_files.complex(1)
    assert run.record["options"] == of_files.record["options"]
    saved = run.save(tmp_path / "saved")
    for name in ("poses.csv", "interface.csv", "view.pml", "top/rank_0001.pdb"):
        assert (saved.directory / name).read_bytes() == (of_files.directory / name).read_bytes(), name
    for wrong, message in (
        ({"waters": "keep"}, "option of reading"),
        ({"poses": 0}, "--poses is 0"),
        ({"gravity": 1}, "no option gravity"),
        ({"output": tmp_path / "run"}, "has no directory"),
    ):
        with pytest.raises(knotdock.InputError, match=message):
            knotdock.dock(*molecules, **{**options, **wrong})
    with pytest.raises(knotdock.InputError, match="no rank 999"):
        run.complex(999)
