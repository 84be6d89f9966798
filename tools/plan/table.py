"""The table of plans: a line each, misses included, what they say together, and all as CSV."""

from pathlib import Path

import pandas as pd

from compare.runs.output import write_csv

WITHIN = 1.5  # times the cheapest of the study
COLUMNS = (
    *("scene", "variant", "asked", "reference", "reference_error", "chosen", "met", "ratio"),
    *("modelling", "predicted_misfit", "misfit"),
    *("predicted_seconds", "obtained_seconds", "seconds"),
    *("best", "best_misfit", "best_seconds", "points", "trials", "planning", "message"),
)


def line(row: dict) -> str:
    """Return a row of the printed table."""
    name = f"{row['scene']} {row['variant']}".strip()
    verdict = "met" if row["met"] else "missed"
    if not row.get("chosen"):
        best = f"; the study's best: {row['best']}" if "best" in row else "; nor does the study"
        return f"{name:55s} {verdict:7s} {row['message']}{best}"
    ratio = f"{row['ratio']:5.2f}" if "best" in row else "    –"
    return (
        f"{name:55s} {verdict:7s}{100 * row['predicted_misfit']:8.3g}{100 * row['misfit']:8.3g} "
        f"{1e3 * row['predicted_seconds']:8.3g}{1e3 * row['seconds']:8.3g} {ratio} "
        f"{row['planning']:7.1f}{row['trials']:4d}  {row['chosen']}"
        + ("" if row["ratio"] == 1 or "best" not in row else f" | {row['best']}")
    )


def show(rows: list[dict], misfit: float) -> None:
    """Print the rows of a misfit, and what they say in a sentence."""
    mine = [row for row in rows if row["asked"] == misfit]
    print(
        f"\n{'asked: ' + format(100 * misfit, 'g') + ' %':55s} {'':7s}{'misfit, %':>16s} ", end=""
    )
    print(f"{'stepping, ms':>16s} {'ratio':>5s} {'planning, s, runs':>11s}  chosen | study's best")
    print(f"{'':62s}{'told':>8s}{'found':>8s} {'told':>8s}{'found':>8s}")
    for row in mine:
        print(line(row))
    print(sentence(mine, misfit))


def sentence(rows: list[dict], misfit: float) -> str:
    """Return what the rows of a misfit say."""
    met = sum(row["met"] for row in rows)
    near = sum(row["met"] and not row["ratio"] > WITHIN for row in rows)  # nan: the study does not
    beyond = sum("best" not in row for row in rows)
    return (
        f"{100 * misfit:g} %: met in {met} of {len(rows)} scenes, at no more than {WITHIN} times "
        f"the cheapest of the full study in {near}; no configuration of the study meets it in "
        f"{beyond}"
    )


def write(path: Path, rows: list[dict]) -> None:
    """Write the rows as CSV; a value that a row does not have stays empty."""
    write_csv(path, pd.DataFrame(rows, columns=list(COLUMNS)))
