"""Limits of the system: threads that cannot be started, and memory that is not given."""

import subprocess

from promises.folders import tree
from promises.scenes import write_inputs
from promises.same_bytes import random_dock, random_sample
from promises.trial import Skipped, limited, unprivileged


def random_call(trial):
    write_inputs(trial.folder)
    if trial.random.random() < 0.7:
        return [*random_dock(trial), "-o", "run", "--json"]
    return [*random_sample(trial), "-o", "k.csv", "--json"]


def threads_refused(trial):
    """If the system starts no more threads a command ends with an error, exit code 1 and JSON, or does without.

    RLIMIT_NPROC of 1 to 6 (`ulimit -u`), --threads 1, 4 or 64 or none (root runs the program as another user).
    """
    words = random_call(trial)
    if words[0] == "dock":
        words += trial.random.choice([[], ["--threads", "1"], ["--threads", "4"], ["--threads", "64"]])
    trial.folder.chmod(0o777)
    limit = trial.random.randint(1, 6)
    try:
        call = trial.run(*words, before=unprivileged(NPROC=limit))
    except PermissionError as error:
        raise Skipped("another user may not run the program where it lies") from error
    trial.commands[-1] += f"   # ulimit -u {limit}"
    trial.check(call.code in (0, 1), f"exit code {call.code}: {call.out[:200]}")


def memory_refused(trial):
    """If the system gives no more memory a command ends with an error, exit code 1 and JSON.

    RLIMIT_AS from 1 MB to 400 MB beyond the least that starts the program: with less the system's own library aborts. An
    exit code of 2 is right as well, if the limit is seen before the work.
    """
    words = random_call(trial)
    for megabytes in range(24, 400, 8):
        least = megabytes * 2**20
        done = subprocess.run([trial.knotdock, "--version"], capture_output=True, preexec_fn=limited(AS=least))
        if done.returncode == 0:
            break
    before = set(tree(trial.folder))
    limit = least + int(2 ** trial.random.uniform(20, 28.6))
    call = trial.run(*words, before=limited(AS=limit))
    trial.commands[-1] += f"   # ulimit -v: {limit} bytes"
    if call.code:
        left = sorted(set(tree(trial.folder)) - before)
        trial.check(not left, f"left over: {left[:5]}")
