"""A progress bar: HTML in Jupyter, marimo's own in marimo, tqdm in a terminal if it is installed."""

from __future__ import annotations

import html
import sys
import time
from typing import Any

__all__ = ["ProgressBar"]


class _JupyterBar:
    """A bar in the output of a cell, for every front end of Jupyter."""

    def __init__(self, name: str, total: int) -> None:
        from IPython.display import HTML, display

        self._html, self._name, self._total = HTML, name, total
        self._done, self._next = 0, 0.0
        self._handle: Any = display(HTML(self._text()), display_id=True)

    def _text(self) -> str:
        done = f'<progress value="{self._done}" max="{self._total}"></progress> {self._done}/{self._total}'
        return f"{html.escape(self._name)} {done}"

    def update(self, steps: int) -> None:
        self._done += steps
        # Ten updates per second at most.
        if time.monotonic() >= self._next:
            self._next = time.monotonic() + 0.1
            self._handle.update(self._html(self._text()))

    def close(self) -> None:
        self._handle.update(self._html(""))


class _MarimoBar:
    def __init__(self, name: str, total: int) -> None:
        import marimo

        self._context = marimo.status.progress_bar(total=total, title=name, remove_on_exit=True)
        self._bar = self._context.__enter__()

    def update(self, steps: int) -> None:
        self._bar.update(steps)

    def close(self) -> None:
        self._context.__exit__(None, None, None)


def _tqdm(name: str, total: int) -> Any:
    from tqdm import tqdm

    return tqdm(total=total, desc=name, leave=False)


def _kind(shown: bool | None) -> Any:
    """The bar that can be seen here, or None."""
    if shown is False:
        return None
    marimo, ipython = sys.modules.get("marimo"), sys.modules.get("IPython")
    if marimo is not None and marimo.running_in_notebook():
        return _MarimoBar
    if ipython is not None and hasattr(ipython.get_ipython(), "kernel"):
        return _JupyterBar
    if not shown and (sys.stderr is None or not sys.stderr.isatty()):
        return None
    try:
        import tqdm  # noqa: F401
    except ImportError:
        if shown:
            raise
        return None
    return _tqdm


class ProgressBar:
    """The stages of a command, one bar after another."""

    def __init__(self, shown: bool | None) -> None:
        self._kind = _kind(shown)
        self._bar: Any = None

    def stage(self, name: str, total: int) -> None:
        """Begin a stage of `total` steps."""
        self.close()
        if self._kind is not None:
            self._bar = self._kind(name, total)

    def advance(self, steps: int) -> None:
        """Note the number of further steps that are done."""
        if self._bar is not None:
            self._bar.update(steps)

    def close(self) -> None:
        """Clear the bar."""
        if self._bar is not None:
            self._bar.close()
            self._bar = None
