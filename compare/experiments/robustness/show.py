"""What the study of hard cases has found, on the terminal."""

from __future__ import annotations

from compare.cli.terminal import print_json, say, show_table
from compare.experiments.robustness.section import Found
from compare.experiments.robustness.table import failures, map_sentences, summary, table


def show(found: Found, as_json: bool) -> None:
    """Print every row, the sentences, what failed, and the files."""
    files = [str(file) for file in found.files]
    said = summary(found.rows) + map_sentences(found.maps)
    if as_json:
        rows = [_plain(row._asdict()) for row in found.rows]
        print_json({"rows": rows, "sentences": said, "files": files})
        return
    header, groups = table(found.rows)
    lines = [[case, *cells] for case, rows in groups.items() for cells in rows]
    show_table(["case and criterion", *header], lines)
    for line in [*said, *failures(found.rows)]:
        say(line)
    say(f"written: {', '.join(files)}")


def _plain(facts: dict) -> dict:
    """Return facts as JSON can say them: no number that is not finite."""
    return {
        k: None if isinstance(v, float) and not abs(v) < float("inf") else v
        for k, v in facts.items()
    }
