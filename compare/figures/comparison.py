"""Files of a comparison: its figure, the curves, the distances, and what is read off them."""

from pathlib import Path

from jointwave.compare.figures.charts.waveforms import draw_solutions
from jointwave.compare.figures.export import save
from jointwave.compare.figures.receivers import curve_table
from jointwave.compare.figures.tables import alignment_frame, distance_frame, reading_frame
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.runs import timings
from jointwave.compare.runs.output import write_csv

NAME = "comparison"


def write_comparisons(comparisons: list[Comparison], out: Path) -> None:
    """Write the figure and the tables of a scene's variants into a folder: comparison.csv with the
    curves, comparison-misfits.csv, and where there are velocities or curves of others
    comparison-readings.csv and comparison-alignment.csv."""
    folder, scene = Path(out), comparisons[0].scene
    with timings.measured("tables", scene.kind, len(comparisons)):
        curves = curve_table(comparisons)
        save(draw_solutions(comparisons), folder, NAME, scene.title, curves)
        write_csv(folder / f"{NAME}-misfits.csv", distance_frame(comparisons))
        for name, table in (
            ("readings", reading_frame(comparisons)),
            ("alignment", alignment_frame(comparisons)),
        ):
            if not table.empty:
                write_csv(folder / f"{NAME}-{name}.csv", table)
