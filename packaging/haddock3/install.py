#!/usr/bin/env python3
"""Install the module knotdock into the HADDOCK3 of this Python, or remove it.

python3 install.py             copies the folder knotdock into haddock/modules/sampling
python3 install.py --remove    removes it there
"""

import argparse
import importlib.util
import shutil
import sys
from pathlib import Path

arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("--remove", action="store_true", help="remove the module")
remove = arguments.parse_args().remove

found = importlib.util.find_spec("haddock")
if found is None or found.origin is None:
    sys.exit(f"error: {sys.executable} has no HADDOCK3\n  help: run this script with the Python that runs haddock3")
sampling = Path(found.origin).parent / "modules" / "sampling"
if not sampling.is_dir():
    sys.exit(f"error: {sampling} does not exist\n  help: install HADDOCK3 2026.10 or later")
module = sampling / "knotdock"
shutil.rmtree(module, ignore_errors=True)
if not remove:
    source = Path(__file__).resolve().parent / "knotdock"
    shutil.copytree(source, module, ignore=shutil.ignore_patterns("__pycache__"))
print(f"{'Removed from' if remove else 'Installed in'} {module}")
