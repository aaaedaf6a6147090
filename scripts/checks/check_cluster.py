#!/usr/bin/env python3
"""Check that the recipes for clusters make the table of one undisturbed batch, though a worker is killed in mid-run.

usage: check_cluster.py FOLDER        with `knotdock` (the Python package) on the path, as root, in an empty folder

Starts a Slurm of one node (scripts/checks/slurm_of_one_node.sh). On it run: an array by
scripts/cluster/slurm_array.sh, of which one task is killed and submitted again; scripts/cluster/Snakefile with
Snakemake's Slurm executor, of which one job is killed; and `knotdock.screen` on dask-jobqueue, of which one worker is
killed.
"""

import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import knotdock
import pandas

ROOT = pathlib.Path(__file__).resolve().parents[2]
RECIPES = ROOT / "scripts" / "cluster"
CASES = ROOT / "tests" / "scoring_table" / "cases"
DOCK = {"rotations": 120, "poses": 40}
WORDS = [f"--{name}={value}" for name, value in DOCK.items()]
SHARDS = 3


def table(folder):
    """A table of twelve small pairs, one of which has no file."""
    names = ["helices", "charged_helices", "salt_bridge", "two_atoms"] * 3
    names[5] = "none"
    path = folder / "pairs.csv"
    rows = [
        f"{number}_{name},{CASES}/{name}_receptor.pdb,{CASES}/{name}_ligand.pdb\n" for number, name in enumerate(names)
    ]
    path.write_text("name,receptor,ligand\n" + "".join(rows))
    return path


def children():
    """Processes that dock or work, by their command lines."""
    found = {}
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                found[int(entry.name)] = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode()
            except OSError:
                continue
    return found


def kill_one(words, shards, is_over=lambda: False, seconds=600):
    """Kill the first process whose command line has all words, once two pairs of a shard were started."""
    end = time.monotonic() + seconds
    while time.monotonic() < end and not is_over():
        started = [path for path in shards.glob("shards/*/attempts.csv") if path.read_bytes().count(b"\n") > 1]
        for pid, line in children().items():
            if started and all(word in line for word in words) and pid != os.getpid():
                os.kill(pid, signal.SIGKILL)
                return
        time.sleep(0.02)
    sys.exit(f"no process of {words} was seen in mid-run")


def wait(condition, what, seconds=300):
    """Wait until a condition holds."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            sys.exit(f"{what} took longer than {seconds} s")
        time.sleep(0.1)


def run(*words, **options):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True, **options).stdout


def same(folder, expected, what):
    """Stop unless the tables in a folder are those expected."""
    for name in ("results.csv", "poses.csv.gz"):
        if (folder / name).read_bytes() != (expected / name).read_bytes():
            sys.exit(f"{what}: {folder / name} differs from {expected / name}")
    print(f"{what}: the same tables, though one was killed")


def by_array(folder, pairs, expected):
    """A Slurm array, one task of which is killed and submitted again."""
    out = folder / "array"
    logs = folder / "array_%a.log"

    def submit(tasks):
        script = RECIPES / "slurm_array.sh"
        words = ("sbatch", "--parsable", f"--array={tasks}", f"--output={logs}", "--mem=500M")
        return run(*words, script, SHARDS, pairs, out, *WORDS).strip()

    def is_gone(job):
        return not run("squeue", "--noheader", "--jobs", job, "--states=PENDING,RUNNING,COMPLETING").strip()

    job = submit(f"1-{SHARDS}")
    kill_one(["knotdock", "batch", str(out), "--shard 1/"], out)
    wait(lambda: is_gone(job), "the array")
    unfinished = subprocess.run(["knotdock", "merge", out], capture_output=True, text=True, check=False)
    if unfinished.returncode != 2:
        sys.exit(f"a killed shard was merged: {unfinished.stdout}")
    job = submit("1")
    wait(lambda: is_gone(job), "the task that was killed")
    run("knotdock", "merge", out)
    same(out, expected, "array of Slurm")


def by_snakemake(folder, pairs, expected):
    """Snakemake with its Slurm executor, a job of which is killed and started again by Snakemake."""
    out = folder / "snakemake"
    words = ["snakemake", "-s", RECIPES / "Snakefile", "--executor", "slurm", "--jobs", "4"]
    words += [
        "--slurm-no-account",
        "--slurm-status-command",
        "squeue",
        "--slurm-init-seconds-before-status-checks",
        "1",
    ]
    words += [
        "--seconds-between-status-checks",
        "1",
        "--latency-wait",
        "1",
        "--default-resources",
        "slurm_partition=batch",
    ]
    words += ["--set-resources", "shard:mem_mb=500", "merge:mem_mb=500"]
    words += ["--config", f"pairs={pairs}", f"output={out}", f"shards={SHARDS}", f"dock={' '.join(WORDS)}"]
    with (folder / "snakemake.log").open("w") as log:
        flow = subprocess.Popen([str(word) for word in words], cwd=folder, stdout=log, stderr=log)
        try:
            kill_one(["knotdock", "batch", str(out), "--shard 2/"], out, lambda: flow.poll() is not None)
            if flow.wait(timeout=600):
                sys.exit("Snakemake failed")
        except SystemExit:
            print((folder / "snakemake.log").read_text()[-3000:])
            raise
    same(out, expected, "Snakemake on Slurm")


def by_dask(folder, pairs, expected):
    """dask-jobqueue on Slurm, a worker of which is killed."""
    from dask_jobqueue import SLURMCluster
    from distributed import Client

    out = folder / "dask"
    settings = {
        "cores": 1,
        "memory": "500MB",
        "processes": 1,
        "queue": "batch",
        "log_directory": str(folder / "dask_logs"),
    }
    with SLURMCluster(**settings, interface="lo", scheduler_options={"dashboard_address": ":0"}) as cluster:
        cluster.adapt(minimum=2, maximum=2)
        with Client(cluster) as client:
            client.wait_for_workers(2, timeout=120)
            with ThreadPoolExecutor() as pool:
                killer = pool.submit(kill_one, ["dask", "worker", "--nthreads 1", "--name"], out / "batch")
                done = knotdock.screen(pairs, client, output=out, dock=DOCK, shards=SHARDS)
                killer.result(timeout=1)
    if (done["pairs"], done["done"], done["failed"]) != (12, 11, 1):
        sys.exit(f"Dask: {done}")
    poses = pandas.read_parquet(done["poses"]).sort_values(["name", "rank"]).reset_index(drop=True)
    plain = knotdock.read_poses(expected).sort_values(["name", "rank"]).reset_index(drop=True)
    pandas.testing.assert_frame_equal(poses, plain, check_dtype=False)
    knotdock.merge(out / "batch")
    same(out / "batch", expected, "Dask on Slurm")


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    # Munge runs as a user of its own.
    folder.chmod(0o755)
    pairs = table(folder)
    expected = folder / "expected"
    knotdock.batch(pairs, expected, dock=DOCK, keep="table")
    starter = ROOT / "scripts" / "checks" / "slurm_of_one_node.sh"
    slurm = folder / "slurm"
    # Daemons go on after the script, and would keep a pipe open.
    subprocess.run([starter, slurm, "start"], check=True)
    os.environ["SLURM_CONF"] = str(slurm / "slurm.conf")
    try:
        by_array(folder, pairs, expected)
        by_snakemake(folder, pairs, expected)
        by_dask(folder, pairs, expected)
    finally:
        subprocess.run([starter, slurm, "stop"], check=False)
    shutil.rmtree(folder)


if __name__ == "__main__":
    main()
