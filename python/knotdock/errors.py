"""What goes wrong, with the file, the line and what to do about it."""

from __future__ import annotations

__all__ = ["InputError", "KnotdockError"]


class KnotdockError(Exception):
    """A command that failed.

    Attributes:
        message: what went wrong.
        file: the file in question, or None.
        line: its line, counted from 1, or None.
        remedy: what to do about it, or None.
    """

    def __init__(
        self,
        message: str,
        file: str | None = None,
        line: int | None = None,
        remedy: str | None = None,
    ) -> None:
        super().__init__(message, file, line, remedy)
        self.message = message
        self.file = file
        self.line = line
        self.remedy = remedy

    def __str__(self) -> str:
        text = self.message
        if self.file is not None:
            text += f"\n  in {self.file}"
            if self.line is not None:
                text += f", line {self.line}"
        if self.remedy is not None:
            text += f"\n  help: {self.remedy}"
        return text


class InputError(KnotdockError, ValueError):
    """Bad input: a file, an option or an argument that cannot be used."""
