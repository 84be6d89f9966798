"""Output of `jointwave run`."""

from collections.abc import Sequence

from jointwave.compare.cli.terminal import print_json, say, say_warnings, show_facts
from jointwave.compare.engines import label_of
from jointwave.compare.runs.run import Done

LABELS = {"from_y": "from (m)", "to_y": "to (m)", "mass": "mass (kg)", "velocity": "velocity (m/s)"}
LABELS |= {"seconds_stepping": "stepping (s)", "energy_residual": "energy residual (of the work)"}
TOLD_BELOW = ("fragments", "static_out_of_balance", "fields")


def show_runs(done: Sequence[Done], as_json: bool) -> None:
    """Print what was run, what it cost and where it is."""
    say_warnings(f"{d.job.scene.name}: {d.ledger}".lstrip(": ") for d in done if d.ledger)
    if as_json:
        print_json([one.facts for one in done])
        return
    rows = [{key: x for key, x in one.facts.items() if key not in TOLD_BELOW} for one in done]
    show_facts({"runs": [row | {"engine": label_of(row["engine"])} for row in rows]}, LABELS)
    for one in done:
        name, pieces = one.job.scene.name or label_of(one.job.name), one.facts["fragments"]
        if (ratio := one.facts["static_out_of_balance"]) is not None:
            say(f"{name}: starts at rest, out-of-balance force ratio {ratio:.1e}")
        if pieces is not None:
            say(f"{name}: {len(pieces) - 1 or 'no'} joints broke")
            show_facts({"fragments": pieces[1:] and pieces}, LABELS)
        for path in one.facts["fields"]:
            say(f"{name}: snapshots for ParaView, {path}")
        if one.job.scene.record.fields is not None and not one.facts["fields"]:
            say(f"{name}: no snapshots: the solution is known at the receivers only")
