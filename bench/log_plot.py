"""Line plots with logarithmic scales as SVG text, side by side; needs nothing but Python."""

import html
import math
from typing import NamedTuple

WIDTH, ACROSS, PANEL_HEIGHT = 800, 2, 300  # pixels
LEFT, TOP, PLOT_WIDTH, PLOT_HEIGHT = 48, 30, 245, 220  # of a panel; right of it stand the labels
LABEL_HEIGHT = 13


class Line(NamedTuple):
    label: str
    color: str
    points: list  # (x, y), both above 0


class Panel(NamedTuple):
    title: str
    x_label: str
    lines: list


def ticks(low, high):
    """1, 2, 5, 10, ... from at or below a range to at or above it; powers of ten alone where these are many."""
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 2)
    for steps in ((1, 2, 5), (1,)):
        marks = [step * 10.0**power for power in powers for step in steps]
        below = [mark for mark in marks if mark <= low] or marks[:1]
        above = [mark for mark in marks if mark >= high and mark > below[-1]]
        marks = [mark for mark in marks if below[-1] <= mark <= above[0]]
        if len(marks) <= 9:
            break
    return marks


def brief(number):
    """1500 as 1.5k."""
    for unit, letter in ((1e6, "M"), (1e3, "k")):
        if number >= unit:
            return f"{number / unit:.3g}{letter}"
    return f"{number:.3g}"


def scale(low, high, begin, end):
    """Maps low to begin and high to end, by logarithms."""
    span = math.log(high / low) or 1
    return lambda value: begin + (end - begin) * math.log(value / low) / span


def draw_axes(panel, to_x, to_y, marks):
    bottom = TOP + PLOT_HEIGHT
    yield f'<rect x="{LEFT}" y="{TOP}" width="{PLOT_WIDTH}" height="{PLOT_HEIGHT}" fill="#fff" stroke="#ccc"/>'
    for mark in marks:
        yield f'<path d="M{LEFT} {to_y(mark):.1f}h{PLOT_WIDTH}" stroke="#e8e8e8"/>'
        yield f'<text x="{LEFT - 5}" y="{to_y(mark) + 4:.1f}" text-anchor="end">{brief(mark)}</text>'
    for x in sorted({x for line in panel.lines for x, _ in line.points}):
        yield f'<path d="M{to_x(x):.1f} {bottom}v4" stroke="#888"/>'
        yield f'<text x="{to_x(x):.1f}" y="{bottom + 16}" text-anchor="middle">{brief(x)}</text>'
    yield f'<text x="{LEFT + PLOT_WIDTH / 2}" y="{bottom + 32}" text-anchor="middle">{html.escape(panel.x_label)}</text>'


def draw_panel(panel):
    """A panel's SVG, its corner at 0, 0. Labels stand at the lines' ends, moved down where they would overlap."""
    yield f'<text x="{LEFT}" y="18" font-weight="bold">{html.escape(panel.title)}</text>'
    points = [point for line in panel.lines for point in line.points]
    if not points:
        yield f'<text x="{LEFT}" y="{TOP + 20}">nothing to compare</text>'
        return
    (left, low), (right, high) = (tuple(pick(values) for values in zip(*points)) for pick in (min, max))
    marks = ticks(low, high)
    to_x = scale(left, right, LEFT + 12, LEFT + PLOT_WIDTH - 12)
    to_y = scale(marks[0], marks[-1], TOP + PLOT_HEIGHT, TOP)
    yield from draw_axes(panel, to_x, to_y, marks)
    label_y = -math.inf
    for number, line in enumerate(sorted(panel.lines, key=lambda line: -line.points[-1][1])):
        places = [(f"{to_x(x):.1f}", f"{to_y(y):.1f}") for x, y in line.points]
        yield f'<polyline points="{" ".join(map(",".join, places))}" fill="none" stroke="{line.color}" stroke-width="1.8"/>'
        yield from (f'<circle cx="{x}" cy="{y}" r="2.4" fill="{line.color}"/>' for x, y in places)
        room = TOP + PLOT_HEIGHT - LABEL_HEIGHT * (len(panel.lines) - 1 - number)  # for those that follow
        label_y = max(min(to_y(line.points[-1][1]) + 4, room), label_y + LABEL_HEIGHT)
        x = LEFT + PLOT_WIDTH + 6
        yield f'<text x="{x}" y="{label_y:.1f}" fill="{line.color}">{html.escape(line.label)}</text>'


def svg(panels, note):
    """The panels in rows, left to right, and a line of text below them."""
    height = PANEL_HEIGHT * math.ceil(len(panels) / ACROSS) + 24
    size = f'width="{WIDTH}" height="{height}"'
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" {size} font-family="sans-serif" '
             'font-size="11" fill="#222">', f'<rect {size} fill="#fafafa"/>']  # fmt: skip
    for i, panel in enumerate(panels):
        corner = f"{WIDTH / ACROSS * (i % ACROSS):g} {PANEL_HEIGHT * (i // ACROSS)}"
        parts += [f'<g transform="translate({corner})">', *draw_panel(panel), "</g>"]
    parts.append(f'<text x="{LEFT}" y="{height - 8}">{html.escape(note)}</text>')
    return "\n".join([*parts, "</svg>\n"])
