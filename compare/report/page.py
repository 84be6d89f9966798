"""The page's HTML: one file that holds its pictures."""

from base64 import b64encode
from pathlib import Path
from typing import Any

import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from jointwave.compare.figures.style import style
from jointwave.compare.text import percent, table_cell


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
        "link": lambda file: file.relative_to(out).as_posix(),
    }
    environment.filters |= {
        "picture": picture,
        "units": unbroken,
        "percent": percent,
        "cell": table_cell,
        "groups": groups,
        "numeric": numeric,
    }
    return environment.get_template("report.html").render(page)


def picture(file: Path) -> str:
    """Return an SVG file as an address of its own."""
    return f"data:image/svg+xml;base64,{b64encode(file.read_bytes()).decode('ascii')}"


def unbroken(text: str) -> str:
    """Return text whose numbers do not break from their signs."""
    return text.replace(" %", "\u00a0%").replace("≤ ", "≤\u00a0")


def numeric(table: pd.DataFrame) -> list[bool]:
    """Return which columns of a table have a number in any cell, and stand at the right."""
    figures = {*"0123456789+-<–±"}
    return table.map(lambda x: not isinstance(x, str) or x[:1] in figures).any().tolist()


def groups(table: pd.DataFrame) -> dict[str, list[tuple[list[str], tuple]]]:
    """Return the rows of a table, labels and values, by the outermost of several levels of its
    index; of a table with one level under no heading, and of one with only numbers no labels."""
    levels = table.index.nlevels
    found: dict[str, list[tuple[list[str], tuple]]] = {}
    for label, *values in table.itertuples(name=None):
        labels = [str(x) for x in (label if levels > 1 else [label])]
        heading, labels = (labels[0], labels[1:]) if levels > 1 else ("", labels)
        if table.index.names == [None]:
            labels = []
        found.setdefault(heading, []).append((labels, values))
    return found
