#!/usr/bin/env python3
"""Reference values of the bump function's 3D Fourier transform, by mpmath at 40 digits.

    python3 scripts/reference/kernel_reference.py

psi_a(x) = exp(1 / (1 - x^-a)), psi^(q) = 4 pi int_0^1 x^2 psi(x) sinc(2 q x) dx. Prints the table that stands in
scoring/src/kernel/reference.rs. Needs mpmath (PyPI).
"""

import mpmath as mp

mp.mp.dps = 40


def transform(alpha, q):
    def integrand(x):
        if x == 0 or x == 1:
            return mp.mpf(0)
        u = x**alpha
        z = 2 * mp.pi * q * x
        oscillation = mp.mpf(1) if z == 0 else mp.sin(z) / z
        return 4 * mp.pi * x * x * mp.exp(-u / (1 - u)) * oscillation

    pieces = max(8, int(4 * q) + 1)
    return mp.quad(integrand, mp.linspace(0, 1, pieces + 1))


def main():
    print("pub(crate) const RADIAL_TRANSFORM: [(f64, f64, f64); 15] = [")
    for alpha in ("0.5", "2", "7"):
        for q in ("0", "0.1", "0.75", "3", "20"):
            value = transform(mp.mpf(alpha), mp.mpf(q))
            print(f"    ({float(alpha)!r}, {float(q)!r}, {float(value)!r}),")
    print("];")


if __name__ == "__main__":
    main()
