"""Output of `jointwave report`."""

from jointwave.compare.cli.frames import show_frame
from jointwave.compare.cli.terminal import print_json, say
from jointwave.compare.report.report import Report


def show_report(found: Report, as_json: bool) -> None:
    """Print the report's summary and where the page is."""
    page, summary = found.page, found.summary
    if as_json:
        rows = summary.reset_index().values.tolist()
        print_json({"page": str(found.file), "columns": ["what", "pair", *summary], "rows": rows})
        return
    for sentence in page["lead"].values():
        say(sentence)
    if page["about"]:
        say(f"\n{page['about'].sentence}")
    say("\nLargest relative L2 misfit over the variants of each scene, in %:")
    show_frame(summary)
    if claims := page["claims"]:
        holding = sum(claim.holds for _, claim in claims)
        say(f"{holding} of {len(claims)} claims of the paper's figures hold.")
    say(f"report: {found.file}")
