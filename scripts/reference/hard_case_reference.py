#!/usr/bin/env python3
"""Reference values of the kernels at their hard ends, by mpmath at 34 digits.

    python3 scripts/reference/hard_case_reference.py

Prints the tables in tests/hard_cases/, each under its name, in a minute. Needs mpmath (PyPI).

  bump         psi_a(x) = exp(1 / (1 - x^-a)) for x -> 0 and x -> 1, a -> 0 and a -> infinity
               (Behandish & Ilies, CAD 70, 2016, eq. 10)
  ball         transform of the unit ball's indicator, tiny and huge |w|
  transform    psi^(q) = 4 pi int x^2 psi(x) sinc(2 q x) dx for a far from 2, tiny and huge q
  low_passed   int 4 pi w^2 W(w) sigma^3 psi^(w sigma) sinc(2 w d) dw with the C-infinity low-pass W: the ranking
               kernel's slice before its window
"""

import mpmath as mp

mp.mp.dps = 34


def bump(alpha, x):
    u = x**alpha
    return mp.exp(-u / (1 - u))


def sinc(z):
    return mp.mpf(1) if z == 0 else mp.sin(mp.pi * z) / (mp.pi * z)


def ball(q):
    if q == 0:
        return 4 * mp.pi / 3
    with mp.workdps(100):  # sin z - z cos z cancels as z -> 0
        z = 2 * mp.pi * q
        return 4 * mp.pi * (mp.sin(z) - z * mp.cos(z)) / z**3


def transform(alpha, q):
    if alpha == mp.inf:
        return ball(q)

    # x = (1 + tanh(pi/2 sinh t)) / 2 takes in the cusp at 0 and the essential singularity at 1; 1 - u from expm1 on the
    # distance to the nearer end.
    def integrand(t):
        s = mp.pi / 2 * mp.sinh(t)
        end = 1 / (1 + mp.exp(2 * abs(s)))
        log_x = mp.log(end) if s < 0 else mp.log1p(-end)
        x = mp.exp(log_x)
        u = mp.exp(alpha * log_x)
        one_minus_u = -mp.expm1(alpha * log_x)
        if one_minus_u == 0 or u / one_minus_u > 2000:
            return mp.mpf(0)
        slope = mp.pi * mp.cosh(t) * end * (1 - end)
        return 4 * mp.pi * x * x * mp.exp(-u / one_minus_u) * sinc(2 * q * x) * slope

    # The trapezoidal rule in t, halved until two steps agree.
    step, last = mp.mpf(1) / 16, None
    while True:
        count = int(7 / step)
        value = step * mp.fsum(integrand(k * step) for k in range(-count, count + 1))
        if last is not None and abs(value - last) < mp.mpf(10) ** -22:
            return value
        step, last = step / 2, value


def low_pass(w, passes, stop):
    u = (w - passes) / (stop - passes)
    if u <= 0:
        return mp.mpf(1)
    if u >= 1:
        return mp.mpf(0)
    return 1 / (1 + mp.exp(1 / (1 - u) - 1 / u))


def low_passed(alpha, sigma, resolution, pass_length, distances):
    passes, stop = 1 / mp.mpf(pass_length), 1 / mp.mpf(resolution)
    # Even and smooth in w, all derivatives zero at the stop: the trapezoidal rule, at 4 periods beyond sigma + d.
    count = int(16 * stop * (sigma + max(distances))) * 4 + 64
    step = stop / count
    rows = [
        (
            n * step,
            4
            * mp.pi
            * (n * step) ** 2
            * low_pass(n * step, passes, stop)
            * sigma**3
            * transform(alpha, n * step * sigma)
            * step,
        )
        for n in range(count)
    ]
    return [mp.fsum(weight * sinc(2 * w * d) for w, weight in rows) for d in distances]


def table(name, rows):
    print(f"// {name}")
    for row in rows:
        values = []
        for value in row:
            if isinstance(value, str):
                values.append(value)
            elif value == mp.inf:
                values.append("f64::INFINITY")
            else:
                values.append(mp.nstr(value, 17, min_fixed=-5, max_fixed=8))
        print(f"    ({', '.join(values)}),")


def main():
    # All exact in binary.
    powers = [(repr(1 - 2.0**-k), mp.mpf(1 - 2.0**-k)) for k in (1, 3, 6, 10)] + [
        ("1.0 - f64::EPSILON", mp.mpf(1 - 2.0**-52))
    ]
    tiny = [(repr(2.0**-k), mp.mpf(2.0**-k)) for k in (30, 1000)]
    rows = []
    for alpha in (2.0**-10, 0.5, 2.0, 7.0, 1024.0, 2.0**30):
        for text, x in powers + tiny:
            value = bump(mp.mpf(alpha), x)
            rows.append((mp.mpf(alpha), text, value if value > 1e-320 else mp.mpf(0)))
    table("bump: alpha, x, psi", rows)
    table(
        "ball: q, transform",
        [
            (mp.mpf(q), ball(mp.mpf(q)))
            for q in (2.0**-60, 2.0**-20, 2.0**-10, 2.0**-9, 0.125, 1.0, 37.25, 1024.5, 2.0**20)
        ],
    )
    rows = []
    for alpha in (0.125, 1.0, 64.0, 1024.0):
        for q in (2.0**-60, 0.25, 2.5, 20.0, 200.0):
            rows.append((mp.mpf(alpha), mp.mpf(q), transform(mp.mpf(alpha), mp.mpf(q))))
    table("transform: alpha, q, psi^", rows)
    distances = [mp.mpf(d) for d in (0.0, 1.0, 2.5, 4.0, 5.5)]
    for alpha in (mp.mpf("0.125"), mp.mpf(2), mp.mpf(64), mp.inf):
        values = low_passed(alpha, mp.mpf(4), 4, 8, distances)
        table(
            "low_passed at sigma = 4, resolution 4, pass length 8: alpha, d, kernel",
            [(alpha, d, value) for d, value in zip(distances, values)],
        )
    # Gibbs: a sharp ball ten times the resolution, from its middle through its edge.
    distances = [mp.mpf(d) for d in (0, 15, 25, 30, 33, 35, 36, 37, 38, 39, 40, 41, 42, 43, 44, 45, 47, 50)]
    values = low_passed(mp.inf, mp.mpf(40), 4, 8, distances)
    table(
        "low_passed at sigma = 40, resolution 4, pass length 8, alpha infinite: d, kernel", list(zip(distances, values))
    )


if __name__ == "__main__":
    main()
