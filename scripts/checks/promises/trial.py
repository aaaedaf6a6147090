"""One trial of a promise: its folder, its random numbers, and the calls of the program that it makes.

A trial is fixed by the seed, the promise's name and its number. Each call is checked: it ends by itself, within a
time, with exit code 0, 1 or 2, without a panic, and with --json it writes one JSON object, of a failure with an error.
"""

import json
import os
import random
import resource
import shlex
import subprocess
import threading
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
# Seconds of processor time that any call may take, and of the clock: a busy machine fails nothing.
PATIENCE, CLOCK = 120, 600


@dataclass
class Call:
    """What came of a call: exit code (negative: ended by that signal), output, and peak of resident memory in bytes.

    `seconds` are those of the clock, `cpu_seconds` those of all processors. `peak` is at least that of this script,
    whose copy the process is before it starts the program.
    """

    code: int
    out: str
    err: str
    seconds: float
    cpu_seconds: float
    peak: int
    pid: int

    def object(self):
        """The JSON object on standard output, or None."""
        try:
            return json.loads(self.out)
        except ValueError:
            return None

    def error(self):
        """The error of a failed call with --json: its file, line, message and remedy; empty if there is none."""
        found = self.object()
        error = found.get("error") if isinstance(found, dict) else None
        return error if isinstance(error, dict) else {}


class Skipped(Exception):
    """The platform does not allow what a trial needs."""


class Trial:
    """A trial's state. `full` is false in the short form."""

    def __init__(self, knotdock, promise, number, seed, folder, full):
        self.knotdock, self.folder, self.full = knotdock, folder, full
        self.number = number
        self.random = random.Random(f"{seed}/{promise}/{number}")
        self.failures, self.commands = [], []

    def check(self, holds, words):
        """Notes a failure unless something holds."""
        if not holds:
            self.failures.append(words)
        return bool(holds)

    def start(self, *words, before=None, environment=None):
        """Starts the program in the trial's folder. `before` is called in the new process, before the program."""
        words = [str(word) for word in words]
        settings = [f"{name}={value}" for name, value in (environment or {}).items()]
        self.commands.append(" ".join([*settings, shlex.join(["knotdock", *words])]))
        environment = {**os.environ, "LC_ALL": "C", **(environment or {})}
        # One process of this script is one thread whenever it starts a program, so that `before` may run in the child.
        return subprocess.Popen(
            [self.knotdock, *words],
            cwd=self.folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            preexec_fn=limited_time(before),
        )

    def finish(self, process, watch=None, clock=CLOCK):
        """Waits for a program to end, as long as `clock`; `watch` may end it, and is called with the process."""
        began, output = time.monotonic(), {}

        def read(name, pipe):
            output[name] = pipe.read()

        pipes = {"out": process.stdout, "err": process.stderr}
        readers = [threading.Thread(target=read, args=pair) for pair in pipes.items()]
        timer = threading.Timer(clock, process.kill)
        for thread in [*readers, timer]:
            thread.start()
        if watch:
            watch(process)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        timer.cancel()
        for thread in [*readers, timer]:
            thread.join()
        out, err = (output[name].decode(errors="replace") for name in ("out", "err"))
        process.stdout.close()
        process.stderr.close()
        seconds = time.monotonic() - began
        cpu_seconds = usage.ru_utime + usage.ru_stime
        return Call(process.returncode, out, err, seconds, cpu_seconds, usage.ru_maxrss * 1024, process.pid)

    def run(self, *words, before=None, environment=None, may_fail=True, watch=None, clock=CLOCK):
        """Runs the program to its end and checks what holds for every call."""
        call = self.finish(self.start(*words, before=before, environment=environment), watch, clock)
        self.check_orderly(call, "--json" in words, clock)
        if not may_fail:
            said = (call.out + call.err).strip()[-400:]
            self.check(call.code == 0, f"exit code {call.code}: {said}")
        return call

    def check_orderly(self, call, is_json, clock=CLOCK):
        """Checks what holds for every call, whatever its input."""
        said = call.err.strip()[-300:]
        if call.code < 0 and (call.seconds >= clock or call.cpu_seconds >= PATIENCE - 2):
            self.check(False, f"took {call.cpu_seconds:.0f} s of processors and {call.seconds:.0f} s of the clock")
        else:
            self.check(call.code in (0, 1, 2), f"ended with {call.code}: {said}")
        self.check("panicked" not in call.err + call.out, f"panicked: {said}")
        if is_json and call.code in (0, 1, 2):
            found = call.object()
            self.check(isinstance(found, dict), f"no JSON object: {call.out[:200]!r}")
            if call.code and isinstance(found, dict):
                errors = [pair.get("error") for pair in found.get("pairs", [])] + [found.get("error")]
                whole = [{"file", "line", "message", "remedy"} <= set(error) for error in errors if error]
                self.check(whole and all(whole), f"no JSON error: {call.out[:200]!r}")

    def make(self, name, content):
        """Writes a user's file, with the folders that it needs."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path


def limited_time(before):
    """A function for the new process: what is called before the program, and a limit on processor time."""

    def prepare():
        if before:
            before()
        resource.setrlimit(resource.RLIMIT_CPU, (PATIENCE, PATIENCE))

    return prepare


def limited(**limits):
    """A function for `before` that sets limits of the system, named as in `resource` without RLIMIT_."""

    def before():
        for name, value in limits.items():
            resource.setrlimit(getattr(resource, f"RLIMIT_{name}"), (value, value))

    return before


NOBODY = 65534


def unprivileged(**limits):
    """As `limited`, and root becomes another user, whom permissions and the number of processes bind."""
    set_limits = limited(**limits)

    def before():
        if os.getuid() == 0:
            os.setgroups([])
            os.setgid(NOBODY)
            os.setuid(NOBODY)
        set_limits()

    return before
