"""The reliability plot of scripts/calibrate_chance.py as SVG: the chance told against the share that came true."""

from marks import FAINT, disc, frame, line, sheet, text

LEFT, TOP, SIDE = 76, 44, 380
COLOURS = ("#0072b2", "#d55e00", "#999999")
TICKS = range(0, 101, 20)


def draw(series):
    """SVG of named series of bins: (low, high, mean chance, share, (low, high) of the share, pairs)."""
    # Wide enough for the key on the right; the face and its measures are those of `knotdock tradeoff`.
    width, height = LEFT + SIDE + 320, TOP + SIDE + 60
    marks = []
    for tick in TICKS:
        x, y = place(tick / 100, tick / 100)
        marks += [line((x, TOP), (x, TOP + SIDE), FAINT), line((LEFT, y), (LEFT + SIDE, y), FAINT)]
        marks += [text(x, TOP + SIDE + 14, f"{tick}%", "middle"), text(LEFT - 8, y, f"{tick}%", "end")]
    marks.append(frame(LEFT, TOP, SIDE, SIDE))
    marks.append(line(place(0, 0), place(1, 1), "#888888", ' stroke-dasharray="6 4"'))
    marks += [
        text(LEFT + SIDE / 2, TOP - 18, "One of the first ten clusters is acceptable", "middle"),
        text(LEFT + SIDE / 2, TOP + SIDE + 38, "chance told", "middle"),
        text(18, TOP + SIDE / 2, "share of pairs", "middle", f' transform="rotate(-90 18 {TOP + SIDE / 2})"'),
    ]
    key = LEFT + SIDE + 24
    for row, ((label, bins), colour) in enumerate(zip(series, COLOURS)):
        # Series stand a little apart, so that intervals do not hide each other; numbers of the first are on its left.
        shift, side, anchor = ((-7, -9, "end"), (7, 9, "start"), (0, 9, "start"))[row]
        for _, _, mean, share, (low, high), pairs in bins:
            (x, y), (_, bottom), (_, top) = place(mean, share), place(mean, low), place(mean, high)
            x += shift
            marks += [line((x, bottom), (x, top), colour, ' stroke-width="1.5"'), disc(x, y, colour)]
            halo = ' paint-order="stroke" stroke="white" stroke-width="4"'
            marks.append(text(x + side, y, f"{pairs:.0f}", anchor, halo, colour))
        marks += [disc(key, TOP + 12 + 24 * row, colour), text(key + 14, TOP + 12 + 24 * row, label, "start")]
    notes = ("numbers: pairs in the bin", "bars: 95%, Wilson", "dashed: as told")
    marks += [text(key - 5, TOP + 24 * len(series) + 24 + 20 * row, note, "start", fill="#666666") for row, note in enumerate(notes)]
    return sheet(width, height, marks)


def place(chance, share):
    return LEFT + SIDE * chance, TOP + SIDE * (1 - share)

