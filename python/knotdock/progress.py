"""A progress bar by tqdm, where it is installed and someone is there to see it."""

from __future__ import annotations

import sys
from typing import Any

__all__ = ["ProgressBar"]


def _is_seen() -> bool:
    if sys.stderr is not None and sys.stderr.isatty():
        return True
    # A notebook has no terminal, and shows bars all the same.
    return "ipykernel" in sys.modules


class ProgressBar:
    """The stages of a command, one bar after another."""

    def __init__(self, shown: bool | None) -> None:
        self._tqdm: Any = None
        self._bar: Any = None
        if shown or (shown is None and _is_seen()):
            try:
                from tqdm.auto import tqdm
            except ImportError:
                if shown:
                    raise
                return
            self._tqdm = tqdm

    def stage(self, name: str, total: int) -> None:
        """Begin a stage of `total` steps."""
        self.close()
        if self._tqdm is not None:
            self._bar = self._tqdm(total=total, desc=name, leave=False)

    def advance(self, steps: int) -> None:
        """Note the number of further steps that are done."""
        if self._bar is not None:
            self._bar.update(steps)

    def close(self) -> None:
        """Clear the bar."""
        if self._bar is not None:
            self._bar.close()
            self._bar = None
