"""The promises that scripts/checks/trust.py tests: one function each, and one line here."""

from dataclasses import dataclass
from typing import Callable

from promises import (
    exact_scores,
    hostile_input,
    hostile_sizes,
    kills,
    memory,
    names,
    ranks,
    same_bytes,
    shards,
    system_limits,
    two_at_once,
    users_files,
    write_failures,
)


@dataclass
class Promise:
    """A promise. The first paragraph of the function's comment is what is promised, the rest how it is tested."""

    trial: Callable
    short: int  # trials in the short form
    full: int

    @property
    def name(self):
        return self.trial.__name__

    @property
    def words(self):
        """What is promised, and how it is tested."""
        first, _, rest = (self.trial.__doc__ or "").partition("\n\n")
        return " ".join(first.split()), " ".join(rest.split())


PROMISES = [
    Promise(users_files.names_on_the_way, 8, 200),
    Promise(users_files.links_for_outputs, 6, 150),
    Promise(users_files.special_files, 6, 150),
    Promise(users_files.foreign_files, 6, 100),
    Promise(users_files.other_folders, 4, 60),
    Promise(users_files.edited_files, 6, 100),
    Promise(two_at_once.docks_at_once, 2, 40),
    Promise(two_at_once.batches_at_once, 3, 60),
    Promise(kills.kills, 14, 500),
    Promise(shards.killed_shards, 3, 60),
    Promise(shards.shards_on_full_disks, 2, 40),
    Promise(shards.damaged_shards, 3, 80),
    Promise(shards.reserved_names, 1, 20),
    Promise(write_failures.file_size_limit, 10, 200),
    Promise(write_failures.full_disk, 6, 100),
    Promise(write_failures.no_permission, 6, 40),
    Promise(system_limits.threads_refused, 4, 60),
    Promise(system_limits.memory_refused, 4, 100),
    Promise(memory.refusals, 3, 45),
    Promise(same_bytes.any_threads, 6, 150),
    Promise(same_bytes.again, 4, 80),
    Promise(exact_scores.docked_scores, 4, 120),
    Promise(exact_scores.gradients, 3, 40),
    Promise(exact_scores.distances, 4, 100),
    Promise(ranks.noise, 1, 30),
    Promise(ranks.frames, 1, 20),
    Promise(hostile_input.damaged_files, 60, 1500),
    Promise(hostile_sizes.bounded_time, 11, 22),
    Promise(names.spreadsheet_cells, 3, 40),
    Promise(names.control_characters, 6, 100),
]
