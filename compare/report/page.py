"""The page's HTML: one file that holds its pictures."""

from base64 import b64encode
from pathlib import Path
from typing import Any

import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from jointwave.compare.engines import in_words, label_of
from jointwave.compare.figures.style import style
from jointwave.compare.text import in_seconds, percent, table_cell, times


def render(page: dict[str, Any], out: Path) -> str:
    """Return the page, which is to stand in `out`, beside the files that it links to.

    page : what the templates show; `compare.report.report` says what there is.
    """
    loader = PackageLoader(__package__)
    environment = Environment(
        loader=loader,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    environment.globals |= {
        "style": Markup(loader.get_source(environment, "page.css")[0]),
        "colour": lambda name: style(name).colour,
        "label": label_of,
        "link": lambda file: file.relative_to(out).as_posix(),
    }
    environment.filters |= {
        "picture": picture,
        "units": unbroken,
        "percent": percent,
        "times": times,
        "in_seconds": in_seconds,
        "rows": rows,
    }
    return environment.get_template("report.html").render(page)


def picture(file: Path) -> str:
    """Return an image, SVG or GIF, as an address of its own."""
    kind = {".svg": "svg+xml", ".gif": "gif"}[file.suffix]
    return f"data:image/{kind};base64,{b64encode(file.read_bytes()).decode('ascii')}"


def unbroken(text: str) -> str:
    """Return text whose numbers do not break from their signs."""
    return text.replace(" %", "\u00a0%").replace("≤ ", "≤\u00a0")


def rows(table: pd.DataFrame) -> Markup:
    """Return a table in HTML, its labels on the left, alike ones together, and numbers on the
    right; solutions and pairs of them are in words."""
    if table.index.nlevels > 1:
        table = pd.concat([rows for _, rows in table.groupby(level=0, sort=False)])
    cells = table.apply(lambda c: c.map(lambda x: in_words(table_cell(x, str(c.name)))))
    cells = cells.rename(index=in_words, columns=in_words)
    named = table.index.names != [None]
    return Markup(cells.to_html(border=0, index=named, justify="unset"))
