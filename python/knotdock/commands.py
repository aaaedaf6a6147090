"""Commands of the program as functions: keywords are the options of the command line."""

from __future__ import annotations

import functools
import json
import keyword
import os
import warnings
from collections.abc import Iterable, Sequence
from typing import Any

from knotdock import _knotdock
from knotdock.progress import ProgressBar

__all__ = ["KnotdockWarning", "Listener", "keyword_name", "run_command", "text_of", "words_of"]


class KnotdockWarning(UserWarning):
    """A warning of knotdock about its input or its results."""


class Listener:
    """Receives the messages of a command: warnings become Python's, failures of parts are collected."""

    def __init__(self, progress: bool | None) -> None:
        self._bar = ProgressBar(progress)
        self.said: list[str] = []
        self.failures: list[str] = []

    def say(self, text: str) -> None:
        self.said.append(text)

    def warn(self, text: str) -> None:
        warnings.warn(text, KnotdockWarning, stacklevel=5)

    def error(self, text: str) -> None:
        self.failures.append(text)

    def stage(self, name: str, total: int) -> None:
        self._bar.stage(name, total)

    def advance(self, steps: int) -> None:
        self._bar.advance(steps)

    def close(self) -> None:
        self._bar.close()


def text_of(value: Any) -> str:
    """A value as the text of a command line."""
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, Iterable):
        return ",".join(text_of(part) for part in value)
    return str(value)


def keyword_name(option: str) -> str:
    """The keyword of an option: its name, and `_` behind it where Python has a word of that name.

    >>> keyword_name("lambda"), keyword_name("rotations")
    ('lambda_', 'rotations')
    """
    return f"{option}_" if keyword.iskeyword(option) else option


def words_of(options: dict[str, Any]) -> list[str]:
    """Options as words of a command line.

    `True` is a flag, `False` and `None` leave the option out, and a list is joined by commas. Names may end in `_`
    where Python has a word of that name. Weights and potentials become lines of `--config`.

    >>> words_of({"rotations": 600, "no_cluster": True, "effects": ["shape", "contact"], "native": None})
    ['--rotations=600', '--no-cluster', '--effects=shape,contact']
    >>> words_of({"config": ["lab.toml", "pair.toml"], "contact_weight": 1.5})
    ['--config=lab.toml', '--config=pair.toml', '--config=terms.contact_weight=1.5']
    """
    words = []
    for name, value in options.items():
        option = "--" + name.rstrip("_").replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            words.append(option)
        elif name in _of_files():
            line = value if isinstance(value, (int, float)) else json.dumps(text_of(value))
            words.append(f"--config={_of_files()[name]}.{name}={line}")
        elif name in ("config", "confidence") and isinstance(value, (list, tuple)):
            words += [f"{option}={text_of(file)}" for file in value]
        else:
            words.append(f"{option}={text_of(value)}")
    return words


@functools.cache
def _of_files() -> dict[str, str]:
    """The options that files alone give, with their tables."""
    return {option["name"]: option["subject"] for option in _knotdock.options() if option["of_files"]}


def run_command(
    command: str,
    *arguments: Any,
    progress: bool | None = None,
    after: Sequence[str] = (),
    **options: Any,
) -> Any:
    """Run a command of the program: `run_command("collide", "a.stl", "b.stl", pose=[1, 0, 0, 0, 5, 0, 0])`.

    Args:
        command: its name, as on the command line.
        arguments: files and other arguments without a name.
        progress: whether a progress bar is shown; by default in notebooks, and in terminals if tqdm is installed.
        after: words for behind a `--`, as `knotdock batch` takes them.
        options: the command's options; see `words_of`.

    Returns:
        The command's JSON object (`knotdock COMMAND --json`) as Python's dicts, lists and numbers.

    Raises:
        InputError: the input or an option cannot be used.
        KnotdockError: the command failed otherwise.
    """
    files = [text_of(argument) for argument in arguments]
    # A file whose name begins with a dash is no option.
    dashes = ["--"] if any(file.startswith("-") for file in files) else []
    words = [command, *files, *words_of(options)] if not dashes else [command, *words_of(options), *dashes, *files]
    if after:
        words += ["--", *after]
    listener = Listener(progress)
    try:
        result, _ = _knotdock.call(words, listener)
    finally:
        listener.close()
        # Parts that failed, such as pairs of a batch, end no command.
        for text in listener.failures:
            warnings.warn(text, KnotdockWarning, stacklevel=3)
    return None if result is None else json.loads(result)
