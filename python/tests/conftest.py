"""What the tests share: the example pair, and small molecules that dock in a moment."""

import pathlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "structures" / "examples"
CASES = ROOT / "tests" / "scoring_table" / "cases"


@pytest.fixture
def helices() -> tuple[str, str]:
    """Two small molecules."""
    return str(CASES / "helices_receptor.pdb"), str(CASES / "helices_ligand.pdb")


@pytest.fixture
def options() -> dict[str, object]:
    """Options of a short run."""
    return {"rotations": 24, "poses": 40, "write_top": 1, "threads": 1}
