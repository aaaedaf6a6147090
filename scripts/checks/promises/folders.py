"""Content of a folder, byte for byte, and which files belong together."""

import ctypes
import json
import os
import re
import select
import struct
import time


def tree(folder, under=""):
    """Every entry below a folder by its path: bytes of files, targets of links; folders are None."""
    found = {}
    for entry in sorted(os.scandir(folder / under), key=lambda entry: entry.name):
        name = f"{under}/{entry.name}" if under else entry.name
        if entry.is_symlink():
            found[name] = f"link to {os.readlink(entry.path)}"
        elif entry.is_dir():
            found[name] = None
            found |= tree(folder, name)
        elif entry.is_file():
            with open(entry.path, "rb") as file:
                found[name] = file.read()
        else:
            found[name] = "neither file nor folder"
    return found


# Names that the program gives: to files and folders that it is writing, to the lock of a target, and to an older run
# between two renames.
BESIDE = re.compile(r"((?:[^/]+/)*?\.[^/]+\.knotdock-[A-Za-z0-9]{12})(?=/|$)")
LOCK = re.compile(r"(?:^|.*/)\.(?:[^/]+\.)?knotdock-lock$")
OLDER = re.compile(r"^((?:[^/]+/)*?)\.([^/]+)\.knotdock-old(?=/|$)")
# A scratch folder's name depends on where its batch is.
SCRATCH = re.compile(r"(?<=/)knotdock-[0-9a-f]+-(?=[0-9])")


def leftovers(entries):
    """Paths of a tree that commands which were killed have left beside their targets."""
    left = {found[1] for name in entries if (found := BESIDE.match(name))}
    older = [found for name in entries if (found := OLDER.match(name))]
    return sorted(left | {found[0] for found in older if found[1] + found[2] in entries})


def without(entries, paths):
    """A tree without some entries, all below them, and the folders that hold nothing else."""
    is_out = [name for name in entries if any(name == path or name.startswith(f"{path}/") for path in paths)]
    rest = {name: content for name, content in entries.items() if name not in is_out}
    above = {name for name in rest if rest[name] is None and any(path.startswith(f"{name}/") for path in paths)}
    empty = {name for name in above if not any(other.startswith(f"{name}/") for other in rest.keys() - above)}
    return {name: content for name, content in rest.items() if name not in empty}


def with_older_runs(entries):
    """A tree in which an older run that is aside, with nothing in its place, is in its place."""
    found = {}
    for name, content in entries.items():
        older = OLDER.match(name)
        is_aside = older and older[1] + older[2] not in entries
        found[OLDER.sub(r"\1\2", name) if is_aside else name] = content
    return found


def record_less_times(content, folder):
    """A record without what may differ between two runs of the same input: times, the machine, and this folder."""
    record = json.loads(content)
    for entry in ("timing", "machine", "command"):
        record.pop(entry, None)
    return json.dumps(record).replace(f"{folder}/", "").encode()


def comparable(entries, folder):
    """A tree in which two runs of the same input and options are equal.

    Files of a sweep keep only their names, and so do attempts: a pair that a kill cut short is started twice.
    """
    result = {}
    for name, content in entries.items():
        name = SCRATCH.sub("knotdock-HASH-", name)
        if re.search(r"(^|/)(run|ensemble)\.json$", name) and isinstance(content, bytes):
            try:
                content = record_less_times(content, folder)
            except ValueError:
                content = b"no JSON"
        elif re.search(r"(^|/)tradeoff\.(csv|json|svg)$", name):
            content = b"a sweep" if content else b""
        elif re.search(r"(^|/)attempts\.csv$", name) and isinstance(content, bytes):
            content = b"attempts"
        elif re.search(r"(^|/)report\.html$", name) and isinstance(content, bytes):
            # It says how long the run took; its last line says that all of it is there.
            content = b"a report" if content.endswith(b" -->\n") else content
        result[name] = content
    return result


def differences(found, expected):
    """What differs between two trees, in words; at most five entries."""
    words = []
    for name in sorted(set(found) | set(expected)):
        if name not in found:
            words.append(f"{name} is gone")
        elif name not in expected:
            words.append(f"{name} is left over")
        elif found[name] != expected[name]:
            words.append(f"{name} differs")
    return "; ".join(words[:5]) + (f"; {len(words) - 5} more" if len(words) > 5 else "")


def below(entries, unit):
    """The part of a tree that is an entry and all below it."""
    return {name: content for name, content in entries.items() if name == unit or name.startswith(f"{unit}/")}


class Watch:
    """Names that come and go below a folder while a program writes there, by inotify of Linux."""

    CREATED, MOVED_HERE = 0x100, 0x80
    MASK = CREATED | MOVED_HERE | 0x40 | 0x200 | 0x8  # and moved away, deleted, written and closed
    FOLDER = 0x40000000

    def __init__(self, folder):
        self.folder, self.folders, self.names = folder, {}, set()
        self.system = ctypes.CDLL(None, use_errno=True)
        self.file = self.system.inotify_init1(os.O_NONBLOCK)
        if self.file < 0:
            raise OSError("no inotify")
        self.add("")

    def add(self, under):
        """Watches a folder and those below it; names that are there by then are taken too."""
        path = os.fsencode(self.folder / under)
        number = self.system.inotify_add_watch(self.file, path, self.MASK)
        if number < 0:
            return  # it is gone again
        self.folders[number] = under
        try:
            entries = list(os.scandir(self.folder / under))
        except OSError:
            return
        for entry in entries:
            name = f"{under}/{entry.name}" if under else entry.name
            self.names.add(name)
            if entry.is_dir(follow_symlinks=False):
                self.add(name)

    def read(self, seconds):
        """Number of events since the last call, waiting for them no longer than the given seconds."""
        if not select.select([self.file], [], [], seconds)[0]:
            return 0
        data, at, count = os.read(self.file, 65536), 0, 0
        while at < len(data):
            number, mask, _, length = struct.unpack_from("iIII", data, at)
            name = data[at + 16 : at + 16 + length].rstrip(b"\0").decode(errors="replace")
            at += 16 + length
            count += 1
            if not name:
                continue
            under = self.folders.get(number, "")
            name = f"{under}/{name}" if under else name
            self.names.add(name)
            if mask & self.FOLDER and mask & (self.CREATED | self.MOVED_HERE):
                self.add(name)
        return count

    def follow(self, process, until=None):
        """Counts events until a program ends or the given number is reached; the number."""
        count = 0
        while until is None or count < until:
            count += self.read(0.002)
            if has_ended(process):
                break
        if until is None:
            time.sleep(0.001)
            count += self.read(0)
        return count

    def close(self):
        os.close(self.file)


def has_ended(process):
    """Whether a program has ended, without taking its exit status."""
    return os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None
