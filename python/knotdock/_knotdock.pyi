import os
from collections.abc import Sequence
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

class _Option(TypedDict):
    name: str
    kind: str
    values: list[str]
    default: str | None
    subject: str
    help: str
    of_files: bool

def call(words: Sequence[str | os.PathLike[str]], listener: Any) -> tuple[str | None, int]: ...
def main(arguments: list[str]) -> int: ...
def version() -> str: ...
def options() -> list[_Option]: ...

class Molecule:
    @staticmethod
    def from_words(file: str, words: Sequence[str]) -> Molecule: ...
    def __len__(self) -> int: ...
    @property
    def report(self) -> str: ...
    @property
    def positions(self) -> NDArray[np.float64]: ...
    @property
    def radii(self) -> NDArray[np.float64]: ...
    @property
    def labels(self) -> dict[str, Any]: ...

class Correlator:
    def __init__(
        self,
        receptor: NDArray[np.float64],
        ligand: NDArray[np.float64],
        receptor_weights: NDArray[np.float64] | None = None,
        ligand_weights: NDArray[np.float64] | None = None,
        *,
        lambda_: float = 9.0,
        offset: float = 2.2,
        alpha: float = 2.0,
        resolution: float = 4.5,
        pass_length: float | None = None,
        spacing: float | None = None,
        tolerance: float = 1e-2,
    ) -> None: ...
    def correlate(self, quaternion: Sequence[float]) -> NDArray[np.float32]: ...
    def peaks(
        self, quaternion: Sequence[float], count: int
    ) -> list[tuple[float, tuple[float, float, float, float], tuple[float, float, float]]]: ...
    def pose(self, quaternion: Sequence[float], voxel: Sequence[int]) -> tuple[list[float], list[float]]: ...
    def score(self, quaternions: NDArray[np.float64], translations: NDArray[np.float64]) -> NDArray[np.float64]: ...
    @property
    def size(self) -> list[int]: ...
    @property
    def spacing(self) -> float: ...
    @property
    def rank(self) -> int: ...
    @property
    def rank_error(self) -> float: ...
