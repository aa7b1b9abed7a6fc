"""Markdown for docs/results.md: tables, numbers, and the marked parts that scripts/results rewrites."""

import os
import pathlib
import re

from engine_bench import ROOT, Failed

PAGE = ROOT / "docs" / "results.md"
IMAGES = ROOT / "docs" / "images"


def begin_of(name):
    return f"<!-- {name}: begin; scripts/results writes what follows -->"


def end_of(name):
    return f"<!-- {name}: end -->"


def replaced(page, name, lines):
    """`page` with what stands between the section's two markers replaced; Failed where they are not there once."""
    begin, end = begin_of(name), end_of(name)
    if page.count(begin) != 1 or page.count(end) != 1 or page.index(begin) > page.index(end):
        raise Failed(f"{PAGE.name}: the lines '{begin}' and '{end}' must be there once each, in this order")
    before, rest = page.split(begin)
    text = "\n".join(lines).strip("\n")
    return f"{before}{begin}\n\n{text}\n\n{end}{rest.split(end)[1]}"


def write_section(name, lines, page=PAGE):
    """Rewrites one section; what stands outside of it is a person's and stays."""
    page.write_text(replaced(page.read_text(), name, lines))


def table(head, rows):
    yield "| " + " | ".join(map(str, head)) + " |"
    yield "|" + "---|" * len(head)
    for row in rows:
        yield "| " + " | ".join(map(str, row)) + " |"
    yield ""


def cell(value):
    """Milliseconds and the like: three digits."""
    if value is None:
        return "-"
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def ratio(above, below):
    return "-" if above is None or not below else f"{above / below:.1f}x"


def share(value):
    """A share of pixels: 0 only where it is 0."""
    if value is None:
        return "-"
    return "0" if value == 0 else re.sub(r"e-0", "e-", f"{value:.1e}")


def image(name, what):
    yield f"![{what}](images/{name})"
    yield ""


def shortened(word):
    """Command lines on the page name files, not the folders of one machine."""
    path = pathlib.Path(word)
    return path.name if path.is_absolute() else word


def machine_here():
    """The processor, its cores and how busy they are before we begin."""
    names = re.findall(r"^model name\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.M)
    return f"{names[0] if names else 'unknown processor'}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} before"
