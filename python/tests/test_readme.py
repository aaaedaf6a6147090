"""The README's code runs unchanged."""

import pathlib
import re
import shutil

from conftest import EXAMPLES

README = pathlib.Path(__file__).parents[1] / "README.md"


def test_the_code_of_the_readme_runs(tmp_path, monkeypatch):
    import matplotlib

    matplotlib.use("Agg")
    for name, example in [
        ("receptor.pdb", "1ppe_receptor_unbound.pdb"),
        ("ligand.pdb", "1ppe_ligand_unbound.pdb"),
        ("native_receptor.pdb", "1ppe_receptor_bound.pdb"),
        ("native_ligand.pdb", "1ppe_ligand_bound.pdb"),
    ]:
        shutil.copy(EXAMPLES / example, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", README.read_text(), re.S)
    assert len(blocks) == 4
    names = {}
    for block in blocks:
        exec(compile(block, str(README), "exec"), names)
    assert (tmp_path / "score_irmsd.png").stat().st_size > 1000
    poses = names["run"].poses
    assert (poses["capri"][:10] != "incorrect").any()
    assert len(names["grid"].shape) == 3
