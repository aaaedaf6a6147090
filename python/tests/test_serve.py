"""`python -m knotdock serve`: its children are Python's, too."""

import json
import subprocess
import sys
from pathlib import Path
from urllib.request import Request, urlopen

ATOM = "ATOM      1  CA  ALA A   1       0.000   0.000   0.000  1.00  0.00           C\n"


def test_the_page_reads_a_structure(tmp_path: Path) -> None:
    words = [sys.executable, "-m", "knotdock", "serve", "--port", "0", "--no-browser", "--json"]
    with subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE, text=True) as server:
        try:
            link = json.loads(server.stdout.readline())["link"]
            upload = json.load(urlopen(Request(f"{link}api/uploads", method="POST")))["upload"]
            urlopen(Request(f"{link}api/uploads/{upload}/a.pdb", data=ATOM.encode(), method="PUT")).close()
            read = json.load(urlopen(f"{link}api/inspect/{upload}/a.pdb"))
            assert read["result"]["chains"] == [
                {"chain": "A", "residues": [{"number": "1", "name": "ALA", "letter": "A"}]}
            ]
        finally:
            server.kill()
