"""`jointwave report`: the page, and its findings on the terminal."""

from jointwave.compare.cli import terminal
from jointwave.compare.cli.commands import Report
from jointwave.compare.cli.forecast import show_forecasts
from jointwave.compare.cli.inputs import load, results_of
from jointwave.compare.cli.options import SceneOptions
from jointwave.compare.report import report as pages
from jointwave.compare.runs.checkpoint.lock import locked
from jointwave.compare.runs.reuse import ResultFolder


def report(asked: Report) -> None:
    """Write the page and print what it begins with, or what it would cost."""
    scenes, out = asked.scenes or [], asked.out
    for name in scenes:
        load(SceneOptions(scene=name, changes=[], variant=None, strict=asked.strict))
    stored = ResultFolder(results_of(), asked.fresh)
    if asked.dry:
        runs, parts = pages.planned(out, scenes, stored)
        show_forecasts(runs, asked.as_json, parts)
        return
    with (
        locked(out, out / "figures", out / "studies"),
        terminal.progress("report") as advance,
    ):
        found = pages.build(out, advance, scenes=scenes, peers_table=asked.peers, stored=stored)
    page, summary = found.page, found.summary
    if asked.as_json:
        rows, columns = summary.reset_index().values.tolist(), ["what", "pair", *summary]
        terminal.print_json({"page": str(found.file), "columns": columns, "rows": rows})
        return
    for sentence in page["lead"].values():
        terminal.say(sentence)
    if page["about"]:
        terminal.say(f"\n{page['about'].sentence}")
    terminal.say("\nLargest relative L2 misfit over the variants of each scene, in %:")
    terminal.show_frame(summary)
    if claims := page["claims"]:
        holding = sum(claim.holds for _, claim in claims)
        terminal.say(f"{holding} of {len(claims)} claims of the paper's figures hold.")
    terminal.say(f"report: {found.file}")
