"""Marks of the pictures that these scripts draw as SVG, in the face and measures of `knotdock tradeoff`'s charts."""

import html

INK, FAINT = "#222222", "#dddddd"
# Characters are set this many pixels wide whatever face the reader has, so that nothing runs into anything.
ADVANCE = 8


def sheet(width, height, marks):
    """The whole file."""
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
        'font-family="Noto Sans Mono, DejaVu Sans Mono, Menlo, Consolas, monospace" font-size="13">\n'
        '<rect width="100%" height="100%" fill="white"/>\n'
    )
    return head + "\n".join(marks) + "\n</svg>\n"


def frame(x, y, width, height):
    return f'<rect x="{x}" y="{y}" width="{width}" height="{height}" fill="none" stroke="{INK}"/>'


def line(start, end, colour=FAINT, more=""):
    (x1, y1), (x2, y2) = start, end
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}"{more}/>'


def disc(x, y, colour):
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="{colour}"/>'


def cross(x, y, colour):
    return f'<path d="M{x - 5:.1f} {y - 5:.1f}l10 10m0 -10l-10 10" stroke="{colour}" stroke-width="2"/>'


def text(x, y, words, anchor="start", more="", fill=INK):
    where = f'x="{x:.1f}" y="{y:.1f}" dominant-baseline="central" text-anchor="{anchor}"'
    return f'<text {where} textLength="{ADVANCE * len(words)}" fill="{fill}"{more}>{html.escape(words)}</text>'
