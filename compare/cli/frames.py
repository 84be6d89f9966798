"""Tables of pandas on the terminal."""

import pandas as pd

from jointwave.compare.cli.terminal import say, show_numbers, show_table
from jointwave.compare.text import table_cell

LONGEST = 40  # characters of a cell that is not wrapped


def show_frame(table: pd.DataFrame) -> None:
    """Print a table; the first level of its index has the headings of groups, the others label the
    rows. With sentences in its cells each group is a table of its own, whose cells are wrapped."""
    groups: dict[str, list[list[str]]] = {}
    for (heading, *labels), *values in table.itertuples(name=None):
        cells = [table_cell(x, name) for x, name in zip(values, table.columns, strict=True)]
        groups.setdefault(heading, []).append([*map(str, labels), *cells])
    header = [*map(str, table.index.names[1:]), *map(str, table.columns)]
    lengths = (
        len(cell)
        for rows in groups.values()
        for row in rows
        for cell in row[table.index.nlevels - 1 :]
    )
    if max(lengths, default=0) <= LONGEST:
        show_numbers(header, groups)
        return
    for heading, rows in groups.items():
        say(heading, "bold")
        show_table(header, rows)
