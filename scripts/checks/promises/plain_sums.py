"""Scores as plain sums over pairs of balls, in double precision, by the formulae of docs/research/effects.md.

Distances in Å, frequencies in cycles per Å; lambda = 9, offset r0 = 2.2, resolution 4.5 and alpha = 2:

    slice(rho)  = sum_ij kappa(d_ij, r_i + s_j + rho), kappa^(w) = W(w) sigma^3 psi^(w sigma), times a window V(d)
    shape       = -lambda^2 slice(0) + 2 lambda slice(r0) - slice(2 r0)
    unfiltered  = the same with kappa(d, sigma) = psi(d / sigma): Behandish and Ilies' own sum

It shares no code with the program, nor with scripts/reference/pair_sum.py, which needs NumPy and has the other effects.
"""

import functools
import math

LAMBDA, OFFSET = 9.0, 2.2
STOP, PASS = 1 / 4.5, 1 / 9.0
WEIGHTS = (-(LAMBDA**2), 2 * LAMBDA, -1.0)


def psi(x):
    """The bump of B&I eq. (10)."""
    square = x * x
    return math.exp(-square / (1 - square)) if square < 1 else 0.0


def step_down(x, start, stop):
    """C-infinity step from 1 at `start` to 0 at `stop`."""
    if x <= start:
        return 1.0
    if x >= stop:
        return 0.0
    u = min(max((x - start) / (stop - start), 1e-3), 1 - 1e-3)
    return 1 / (1 + math.exp(min(1 / (1 - u) - 1 / u, 700)))


@functools.cache
def bump_transform(frequency):
    """4 pi int x^2 psi(x) sinc(2 w x) dx of the unit bump, by the trapezoidal rule."""
    count = 2000
    total = 0.0
    for i in range(1, count):
        x = i / count
        phase = 2 * math.pi * frequency * x
        total += x * x * psi(x) * (math.sin(phase) / phase if phase else 1.0)
    return 4 * math.pi * total / count


@functools.cache
def kernel(sigma, reach):
    """Values of kappa(d, sigma) as a function of d, for kernels that end at `reach`."""
    ring = 1 / (STOP - PASS)
    window = (reach + 0.15 * ring, reach + 1.30 * ring)
    step = 1 / (8 * window[1])
    frequencies = [i * step for i in range(math.ceil(STOP / step)) if i * step < STOP]
    parts = [
        (w, 4 * math.pi * w * w * step_down(w, PASS, STOP) * step * sigma**3 * bump_transform(w * sigma))
        for w in frequencies
    ]

    def value(d):
        if d >= window[1]:
            return 0.0
        total = 0.0
        for w, weight in parts:
            phase = 2 * math.pi * w * d
            total += weight * (math.sin(phase) / phase if phase else 1.0)
        return total * step_down(d, *window)

    return value


def rotated(quaternion, x):
    """R(q) x for a unit quaternion (w, x, y, z)."""
    w, a, b, c = quaternion
    rows = (
        (1 - 2 * (b * b + c * c), 2 * (a * b - w * c), 2 * (a * c + w * b)),
        (2 * (a * b + w * c), 1 - 2 * (a * a + c * c), 2 * (b * c - w * a)),
        (2 * (a * c - w * b), 2 * (b * c + w * a), 1 - 2 * (a * a + b * b)),
    )
    return [sum(row[k] * x[k] for k in range(3)) for row in rows]


def placed(ligand, quaternion, translation):
    """Balls (x, y, z, radius) of a ligand at a pose."""
    moved = []
    for *x, radius in ligand:
        y = rotated(quaternion, x)
        moved.append((*(y[k] + translation[k] for k in range(3)), radius))
    return moved


def sums(receptor, ligand):
    """Columns of poses.csv for balls (x, y, z, radius) where they are, and the largest magnitude that was added."""
    reach = max(ball[3] for ball in receptor) + max(ball[3] for ball in ligand) + 2 * OFFSET
    slices, unfiltered, size = [0.0] * 3, 0.0, 0.0
    for a in receptor:
        for b in ligand:
            d = math.dist(a[:3], b[:3])
            for k in range(3):
                sigma = round(a[3] + b[3] + k * OFFSET, 9)
                value = kernel(sigma, reach)(d)
                slices[k] += value
                size += abs(WEIGHTS[k] * value)
                unfiltered += WEIGHTS[k] * psi(d / sigma)
    shape = sum(weight * value for weight, value in zip(WEIGHTS, slices))
    names = ("slice_0", "slice_r0", "slice_2r0")
    return {"shape": shape, "score_unfiltered": unfiltered, **dict(zip(names, slices))}, max(size, 1.0)
