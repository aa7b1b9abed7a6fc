"""Small line and bar charts as SVG, with nothing but the standard library; the same input gives the same file.

A `Chart` is one pair of axes; `write_svg` puts several side by side. Points whose value is None are left out.
"""

import dataclasses
import math
from xml.sax.saxutils import escape

WIDTH, HEIGHT = 380, 270
LEFT, RIGHT, TOP, BOTTOM = 58, 14, 44, 44
PALETTE = ("#d62728", "#1f77b4", "#2ca02c", "#888888", "#9467bd", "#ff7f0e", "#17becf")
LETTER = 5.6  # width of one in the legend, about


@dataclasses.dataclass
class Chart:
    title: str
    x_label: str
    y_label: str
    lines: dict  # name: [(x, y), ...]
    log_x: bool = False
    log_y: bool = False
    names: tuple = ()  # of the x values 0, 1, 2 ... where they are no numbers
    markers: bool = True


def linear_ticks(low, high, wanted=5):
    """Round numbers from the one at or below `low` to the one at or above `high`."""
    if not high > low:
        high = low + 1.0
    raw = (high - low) / wanted
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= raw * 0.999)
    first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
    return [round(i * step, 12) for i in range(first, last + 1)]


def log_ticks(low, high):
    """Powers of ten around [low, high], both above zero; thinned where there are many."""
    first, last = math.floor(math.log10(low) + 1e-9), math.ceil(math.log10(high) - 1e-9)
    last = max(last, first + 1)
    step = 1 + (last - first) // 7
    return [10.0 ** exponent for exponent in range(first, last + 1, step)] + (
        [10.0 ** last] if (last - first) % step else [])


def number(value):
    if value == 0:
        return "0"
    if 1e-3 <= abs(value) < 1e5:
        return f"{value:g}"
    return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e")


class Axis:
    """Maps values to pixels, `begin` to `end`."""

    def __init__(self, values, log, begin, end, from_zero=False):
        above = [value for value in values if value > 0]
        self.log = log and bool(above)
        self.begin, self.end = begin, end
        self.zero_at = None  # on a logarithmic axis a zero has a tick of its own, a step below the others
        if self.log:
            self.ticks = log_ticks(min(above), max(above))
            if min(values) <= 0:
                self.zero_at = self.ticks[0] ** 2 / self.ticks[1]
                self.ticks.insert(0, self.zero_at)
        else:
            low, high = (min(values), max(values)) if values else (0.0, 1.0)
            self.ticks = linear_ticks(min(low, 0.0) if from_zero else low, high)

    def at(self, value):
        low, high = self.ticks[0], self.ticks[-1]
        if self.log:
            above = value if value > 0 else self.zero_at
            share = (math.log10(above) - math.log10(low)) / (math.log10(high) - math.log10(low))
        else:
            share = (value - low) / (high - low)
        return self.begin + share * (self.end - self.begin)


def text(x, y, content, anchor="middle", size=11, extra=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}"{extra}>{escape(str(content))}</text>'


def frame(chart, x_axis, y_axis):
    """Grid, ticks and labels."""
    yield text((LEFT + WIDTH - RIGHT) / 2, 16, chart.title, size=12)
    x_ticks = range(len(chart.names)) if chart.names else x_axis.ticks
    for tick in x_ticks:
        x = x_axis.at(tick)
        yield f'<path d="M{x:.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#ddd"/>'
        yield text(x, HEIGHT - BOTTOM + 14, chart.names[tick] if chart.names else number(tick), size=10)
    for tick in y_axis.ticks:
        y = y_axis.at(tick)
        yield f'<path d="M{LEFT} {y:.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>'
        yield text(LEFT - 5, y + 3.5, "0" if tick == y_axis.zero_at else number(tick), "end", size=10)
    yield text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 10, chart.x_label)
    middle = (TOP + HEIGHT - BOTTOM) / 2
    yield text(13, middle, chart.y_label, extra=f' transform="rotate(-90 13 {middle:.1f})"')


def chart_svg(chart):
    points = {name: [(x, y) for x, y in line if y is not None] for name, line in chart.lines.items()}
    xs = [x for line in points.values() for x, _ in line] + list(range(len(chart.names)))
    ys = [y for line in points.values() for _, y in line]
    x_axis = Axis(xs, chart.log_x, LEFT, WIDTH - RIGHT)
    y_axis = Axis(ys, chart.log_y, HEIGHT - BOTTOM, TOP, from_zero=True)
    yield from frame(chart, x_axis, y_axis)
    legend_x = LEFT
    for place, (name, line) in enumerate(points.items()):
        color = PALETTE[place % len(PALETTE)]
        at = [(x_axis.at(x), y_axis.at(y)) for x, y in line]
        if at:
            # The first is the widest: where lines coincide, each still shows.
            width = max(3.4 - 0.8 * place, 1.0) if chart.markers else 1.0
            path = "L".join(f"{x:.1f} {y:.1f}" for x, y in at)
            yield f'<path d="M{path}" fill="none" stroke="{color}" stroke-width="{width:.1f}"/>'
        if chart.markers:
            yield from (f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.6" fill="{color}"/>' for x, y in at)
        yield f'<path d="M{legend_x:.1f} 30h14" stroke="{color}" stroke-width="2.5"/>'
        yield text(legend_x + 17, 33.5, name, "start", size=10)
        legend_x += 28 + LETTER * len(name)


def document(width, height, content):
    lines = "\n".join(content)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
            f'font-family="sans-serif">\n<rect width="{width}" height="{height}" fill="#fff"/>\n{lines}\n</svg>\n')


def write_svg(file, charts, columns=2):
    """The charts in rows of `columns`."""
    content = []
    for place, chart in enumerate(charts):
        x, y = WIDTH * (place % columns), HEIGHT * (place // columns)
        content += [f'<g transform="translate({x} {y})">', *chart_svg(chart), "</g>"]
    rows = math.ceil(len(charts) / columns)
    file.write_text(document(WIDTH * min(columns, len(charts)), HEIGHT * rows, content))


def write_bars(file, title, x_label, groups, names):
    """Horizontal bars on a logarithmic axis: `groups` is {group: [value or None of each of `names`]}."""
    label_width, bar, gap, width, top, bottom = 150, 9, 8, 700, 44, 40
    group_height = bar * len(names) + gap
    height = top + group_height * len(groups) + bottom
    axis = Axis([value for values in groups.values() for value in values if value], True, label_width, width - 20)
    content = [text(width / 2, 16, title, size=12)]
    for place, name in enumerate(names):
        x = label_width + 130 * place
        content += [f'<rect x="{x}" y="24" width="10" height="10" fill="{PALETTE[place % len(PALETTE)]}"/>',
                    text(x + 14, 33, name, "start", size=10)]
    for tick in axis.ticks:
        x = axis.at(tick)
        content += [f'<path d="M{x:.1f} {top}V{height - bottom}" stroke="#ddd"/>',
                    text(x, height - bottom + 14, number(tick), size=10)]
    for row, (group, values) in enumerate(groups.items()):
        y = top + group_height * row
        content.append(text(label_width - 6, y + group_height / 2, group, "end", size=10))
        for place, value in enumerate(values):
            if value:
                content.append(f'<rect x="{label_width}" y="{y + bar * place:.1f}" height="{bar - 1}" '
                               f'width="{axis.at(value) - label_width:.1f}" fill="{PALETTE[place % len(PALETTE)]}"/>')
    content.append(text(width / 2, height - 8, x_label))
    file.write_text(document(width, height, content))
