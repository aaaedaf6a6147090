"""The program `knotdock`, as `pip install knotdock` brings it."""

import signal
import sys

from knotdock._knotdock import main as program


def main() -> None:
    """Run the program on the words of the command line."""
    # Ctrl-C ends the program at once, as it ends one that is not Python.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(program(["knotdock", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
