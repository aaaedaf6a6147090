"""How good chances are that were told of runs, beside the base rate: log loss, Brier score, AUC, and shares by bins of the chance.

A sample has for each run its `pair` (index), `success` (0 or 1) and `weight`, which adds up to one for a pair, and the indices of all
`pairs`. Intervals are the middle 95% over pairs drawn anew (bootstrap), of a gain on the same draws; those of shares are Wilson's.
"""

import math

import numpy as np

RESAMPLES = 10000
BINS = 5
HEADER = ("chance by", "log loss", "less than the base rate", "Brier score", "less than the base rate", "AUC")


def log_loss(sample, chances):
    return -np.log(np.where(sample.success > 0, chances, 1 - chances))


def brier_score(sample, chances):
    return (sample.success - chances) ** 2


def comparisons(sample, chances):
    """Of each two runs, first by second: 1 where the first was given the higher chance, 1/2 where both the same, else 0."""
    return 0.5 + 0.5 * np.sign(chances[:, None] - chances)


def measures(sample, table, base):
    """A Markdown table of (name, chances, comparisons or None), gains over the chances `base`."""
    draws = np.random.default_rng(1).multinomial(len(sample.pairs), np.full(len(sample.pairs), 1 / len(sample.pairs)), RESAMPLES)
    lines = [f"| {' | '.join(HEADER)} |", "|---" * len(HEADER) + "|"]
    for label, chances, wins in table:
        cells = []
        for measure in (log_loss, brier_score):
            values, gains = measure(sample, chances), measure(sample, base) - measure(sample, chances)
            cells += [mean_over_pairs(sample, values, draws), mean_over_pairs(sample, gains, draws, "+") if label != "base rate" else ""]
        cells.append("" if wins is None else area(sample, wins, draws))
        lines.append(f"| {label} | {' | '.join(cells)} |")
    return lines


def mean_over_pairs(sample, values, draws, sign=""):
    """Mean over pairs with its interval."""
    of_pairs = np.bincount(sample.pair, sample.weight * values)
    low, high = np.percentile(draws @ of_pairs / len(of_pairs), [2.5, 97.5])
    return f"{of_pairs.mean():{sign}.3f} [{low:{sign}.3f}, {high:{sign}.3f}]"


def area(sample, wins, draws):
    """Share of (success, failure) in which the success was given the higher chance, with its interval."""
    found, missed = sample.success > 0, sample.success == 0
    wins = wins[np.ix_(found, missed)]

    def share(counts):
        weights = counts[:, sample.pair] * sample.weight
        total = weights[:, found].sum(axis=1) * weights[:, missed].sum(axis=1)
        return ((weights[:, found] @ wins) * weights[:, missed]).sum(axis=1)[total > 0] / total[total > 0]

    low, high = np.percentile(share(draws), [2.5, 97.5])
    return f"{share(np.ones((1, len(sample.pairs))))[0]:.2f} [{low:.2f}, {high:.2f}]"


def bins(sample, chances):
    """Of each bin of the chance told that holds runs: its ends, mean chance, share of successes with Wilson's interval, and pairs."""
    place = np.minimum((chances * BINS).astype(int), BINS - 1)
    rows = []
    for number in np.unique(place):
        inside = place == number
        pairs = sample.weight[inside].sum()
        mean, share = (sample.weight[inside] @ values[inside] / pairs for values in (chances, sample.success))
        rows.append((number / BINS, (number + 1) / BINS, mean, share, wilson(share, pairs), pairs))
    return rows


def wilson(share, count, z=1.96):
    """Wilson's 95% interval (J. Am. Stat. Assoc. 22 (1927) 209-212); a pair counts once, however many turns it has."""
    middle = (share + z * z / (2 * count)) / (1 + z * z / count)
    half = z / (1 + z * z / count) * math.sqrt(share * (1 - share) / count + z * z / (4 * count * count))
    return middle - half, middle + half
