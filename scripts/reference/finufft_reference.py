#!/usr/bin/env python3
"""Our transform from points to modes beside FINUFFT and NFFT3: time and agreement, on the same numbers, on one thread.

    python3 scripts/reference/finufft_reference.py [--venv FOLDER] [--runs 15] [--skip-large] [--executable FILE]

Builds `benches/nfft.rs`, installs finufft and numpy (and pyNFFT3, where it can be installed) from PyPI into a virtual
environment of its own, and prints two tables in Markdown.

The steps that a user repeats for every new set of points are timed; planning is left out:

- FINUFFT: setpts + execute of the plan interface.
- Ours: locate_into + forward.
- NFFT3: `x =` + adjoint (its name for this direction).

All run in turn, run by run, so that noise of the machine affects all alike. Medians are by the wall clock, and in
parentheses by the thread's CPU time, which other programs on the machine disturb less.

FINUFFT runs at its own best of several settings: oversampling 1.25, 1.5 and 2, each by a median of three runs, twice.
NFFT3 runs at the cheapest of several window widths and grids that meets the tolerance. Errors are relative, in the
2-norm, against the direct sum at 300 modes; agreement is between ours and FINUFFT's over all modes.

Exits with 1 if ours misses the tolerance anywhere or, at a settled load, takes more than 1.3 times FINUFFT's CPU time.
"""

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BAR = 1.3


def enter_environment(folder):
    """Re-runs this script by the Python of a virtual environment that has the packages."""
    python = Path(folder) / "bin" / "python"
    if not python.exists():
        venv.create(folder, with_pip=True)
    install = [str(python), "-m", "pip", "install", "-q", "--disable-pip-version-check"]
    subprocess.run(install + ["finufft==2.5.1", "numpy"], check=True)
    if subprocess.run(install + ["pyNFFT3==1.1.0"]).returncode != 0:
        print("pyNFFT3 cannot be had here: NFFT3 is left out", file=sys.stderr)
    environment = dict(os.environ, KNOTDOCK_REFERENCE_VENV="1", OMP_NUM_THREADS="1")
    os.execve(python, [str(python), *sys.argv], environment)


def bench_executable():
    command = ["cargo", "bench", "--bench", "nfft", "--no-run", "--message-format=json"]
    output = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    for line in reversed(output.splitlines()):
        message = json.loads(line)
        if message.get("executable") and message.get("target", {}).get("name") == "nfft":
            return message["executable"]
    sys.exit("cargo did not say where the benchmark is")


class Ours:
    """`benches/nfft.rs --serve`, one line a request."""

    def __init__(self, executable):
        self.process = subprocess.Popen(
            [executable, "--serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def ask(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        if not answer:
            sys.exit(f"the benchmark stopped at: {line}")
        return answer.strip()

    def plan(self, folder, tolerance, modes):
        return self.ask(f"plan {folder} {tolerance} {' '.join(map(str, modes))}").split(" seconds ")[0]

    def run(self):
        wall_sort, wall, cpu_sort, cpu = map(float, self.ask("run").split())
        return wall_sort + wall, cpu_sort + cpu

    def modes(self, folder, shape):
        import numpy as np

        file = Path(folder) / "modes.bin"
        self.ask(f"write {file}")
        return np.fromfile(file, dtype=complex).reshape(shape)


def timed(work):
    wall, cpu = time.perf_counter(), time.thread_time()
    work()
    return time.perf_counter() - wall, time.thread_time() - cpu


def median(pairs):
    import numpy as np

    return np.median(np.array(pairs), axis=0)


class Finufft:
    def __init__(self, points, weights, modes, tolerance):
        import finufft
        import numpy as np

        self.axes = [np.ascontiguousarray(2 * np.pi * axis) for axis in points.T]
        self.weights = weights
        self.output = np.empty(modes, dtype=complex)
        self.plans = {}
        for factor in (1.25, 1.5, 2.0):
            self.plans[factor] = finufft.Plan(1, modes, 1, tolerance, -1, nthreads=1, upsampfac=factor)
        best = {factor: float("inf") for factor in self.plans}
        for _ in range(2):
            for factor in self.plans:
                self.factor = factor
                best[factor] = min(best[factor], median([self.run() for _ in range(3)])[1])
        self.factor = min(best, key=best.get)

    def run(self):
        plan = self.plans[self.factor]
        return timed(lambda: (plan.setpts(*self.axes), plan.execute(self.weights, self.output)))


class Nfft3:
    """The widths and grids tried, cheapest first by our own reckoning; the first that meets the tolerance is timed."""

    def __init__(self, points, weights, modes, tolerance, error):
        import pyNFFT3
        import numpy as np

        # Its adjoint has exp(+2 pi i k.x), and its nodes are in [-1/2, 1/2).
        self.points = np.ascontiguousarray(np.where(points == -0.5, points, -points))
        self.weights = np.ascontiguousarray(weights)
        # All else is the library's default: window values precomputed an axis (PRE_PSI), nodes sorted, FFTW_ESTIMATE.
        found = None
        for factor in (1.25, 1.5, 2.0):
            grid = np.array([max(2 * -(-int(n * factor) // 2), 20) for n in modes], dtype=np.int32)
            for half in range(2, 9):
                plan = pyNFFT3.NFFT(np.array(modes, dtype=np.int32), len(points), n=grid, m=half)
                self.plan = plan
                seconds = self.run()
                if error(np.asarray(plan.fhat).reshape(modes)) <= tolerance:
                    seconds = min(seconds[1], self.run()[1])
                    if found is None or seconds < found[0]:
                        found = (seconds, plan, f"grid {grid.tolist()} m {half}")
                    break
        if found is None:
            raise ValueError("NFFT3 does not meet the tolerance at any width tried")
        _, self.plan, self.setting = found

    def run(self):
        def work():
            self.plan.x = self.points
            self.plan.f = self.weights
            self.plan.nfft_adjoint()

        return timed(work)


def direct_modes(points, weights, modes):
    """The direct sum at 300 modes strewn over the array, as (flat indices, values)."""
    import numpy as np

    indices = (np.arange(300) * 1_000_003 + 77) % int(np.prod(modes))
    k = np.stack(np.unravel_index(indices, modes), axis=1) - np.array(modes) // 2
    values = np.array([np.sum(weights * np.exp(-2j * np.pi * (points @ row))) for row in k])
    return indices, values


def compare(ours, modes, count, tolerance, runs, folder, beside_nfft3):
    import numpy as np

    generator = np.random.default_rng(2016)
    points = generator.uniform(-0.5, 0.5, (count, len(modes)))
    weights = generator.normal(size=count) + 1j * generator.normal(size=count)
    points.tofile(Path(folder) / "points.bin")
    weights.tofile(Path(folder) / "weights.bin")
    indices, exact = direct_modes(points, weights, modes)

    def error(array):
        return np.linalg.norm(array.ravel()[indices] - exact) / np.linalg.norm(exact)

    row = {"modes": modes, "points": count, "tolerance": tolerance, "plan": ours.plan(folder, tolerance, modes)}
    peers = {}
    if len(modes) == 3:
        peers["finufft"] = Finufft(points, weights, modes, tolerance)
        row["finufft_setting"] = f"upsampfac {peers['finufft'].factor}"
    if beside_nfft3:
        peers["nfft3"] = Nfft3(points, weights, modes, tolerance, error)
        row["nfft3_setting"] = peers["nfft3"].setting
    times = {name: [] for name in ["ours", *peers]}
    for turn in range(runs + 1):
        for name in times:
            seconds = (ours if name == "ours" else peers[name]).run()
            if turn > 0:
                times[name].append(seconds)
    for name in times:
        row[name] = median(times[name])
    modes_of_ours = ours.modes(folder, modes)
    row["ours_error"] = error(modes_of_ours)
    if "finufft" in peers:
        theirs = peers["finufft"].output
        row["finufft_error"] = error(theirs)
        row["agreement"] = np.linalg.norm(modes_of_ours - theirs) / np.linalg.norm(theirs)
    if "nfft3" in peers:
        row["nfft3_error"] = error(np.asarray(peers["nfft3"].plan.fhat).reshape(modes))
    return row


def milliseconds(pair):
    return f"{1e3 * pair[0]:.1f} ({1e3 * pair[1]:.1f})"


def show(rows, peer, title):
    print(f"\n| points | modes | tolerance | ours, ms | {title}, ms | ratio | error of ours | of {title} | settings |")
    print("|---|---|---|---|---|---|---|---|---|")
    for row in rows:
        if peer not in row:
            continue
        ratio = row["ours"] / row[peer]
        size = "x".join(map(str, row["modes"]))
        settings = f"{row['plan']}; {row[peer + '_setting']}"
        print(
            f"| {row['points']} | {size} | {row['tolerance']:.0e} | {milliseconds(row['ours'])} "
            f"| {milliseconds(row[peer])} "
            f"| {ratio[0]:.2f} ({ratio[1]:.2f}) | {row['ours_error']:.1e} | {row[peer + '_error']:.1e} | {settings} |",
            flush=True,
        )


def processor():
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument(
        "--venv", default=str(ROOT / "target" / "reference-venv"), help="virtual environment to make or use"
    )
    parser.add_argument("--runs", type=int, default=15, help="timed runs of each program")
    parser.add_argument("--skip-large", action="store_true", help="leave the 128^3 cases out")
    parser.add_argument("--executable", help="the benchmark, if it is built already")
    options = parser.parse_args()
    if "KNOTDOCK_REFERENCE_VENV" not in os.environ:
        enter_environment(options.venv)
    ours = Ours(options.executable or bench_executable())
    try:
        import pyNFFT3  # noqa: F401

        has_nfft3 = True
    except (ImportError, OSError) as problem:
        print(f"NFFT3 is left out: {problem}", file=sys.stderr)
        has_nfft3 = False
    cases = [((64, 64, 64), 3_000), ((128, 128, 128), 100_000)]
    if options.skip_large:
        cases.pop()
    if has_nfft3:
        cases.append(((16, 16, 16, 16), 3_000))
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for modes, count in cases:
            for tolerance in (1e-3, 1e-6):
                print(f"{modes}, {count} points, {tolerance:.0e} ...", file=sys.stderr, flush=True)
                beside = has_nfft3 and (len(modes) == 4 or modes[0] == 64)
                rows.append(compare(ours, modes, count, tolerance, options.runs, folder, beside))
                print(f"  {rows[-1]}", file=sys.stderr, flush=True)
    load = os.getloadavg()[0]
    print(
        f"{processor()}, {os.cpu_count()} cores, one thread; load {load:.1f}; "
        f"medians of {options.runs} runs, wall clock (CPU)"
    )
    show(rows, "finufft", "FINUFFT")
    show(rows, "nfft3", "NFFT3")
    # Written so that NaN is wrong.
    missed = [row for row in rows if not row["ours_error"] <= row["tolerance"]]
    missed += [row for row in rows if not row.get("agreement", 0) <= 2 * row["tolerance"] + row.get("finufft_error", 0)]
    slow = [row for row in rows if "finufft" in row and row["ours"][1] > BAR * row["finufft"][1]]
    for row in missed:
        print(f"wrong: {row}", file=sys.stderr)
    for row in slow:
        print(f"slower than {BAR} times FINUFFT: {row}", file=sys.stderr)
    return 1 if missed or slow else 0


if __name__ == "__main__":
    sys.exit(main())
