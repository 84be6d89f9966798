"""Tables of pandas on the terminal."""

from itertools import pairwise

import pandas as pd

from jointwave.compare.cli.terminal import LONGEST, say, show_table
from jointwave.compare.engines import in_words
from jointwave.compare.text import table_cell


def show_frame(table: pd.DataFrame) -> None:
    """Print a table, if it has rows; what labels them comes first, an outermost label once;
    solutions and pairs of them are in words. Long labels stand above the rows that have them."""
    if table.index.nlevels > 1 and max(map(len, map(str, table.index.unique(0)))) > LONGEST:
        for heading, rows in table.groupby(level=0, sort=False):
            say(str(heading))
            show_frame(rows.droplevel(0))
        return
    named = table if isinstance(table.index, pd.RangeIndex) else table.reset_index()
    columns = [*map(in_words, named.columns)]
    cells = (map(table_cell, row, columns) for row in named.itertuples(False, None))
    rows = [list(map(in_words, row)) for row in cells]
    if table.index.nlevels > 1:
        for before, row in reversed(list(pairwise(rows))):
            row[0] = "" if row[0] == before[0] else row[0]
    if rows:
        show_table(columns, rows)
