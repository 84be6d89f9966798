"""The table of other codes as the report shows it: ratios, what is missing, and bad files."""

import pandas as pd
import pytest

from cases.errors import SceneError
from compare.report import peers

DONE = {"settings": '{"elements_per_block": 2}', "state": "done", "misfit": 0.01, "work": 1e6}
SECONDS = {"total_misfit": 0.04, "seconds": 0.001, "whole": 0.8, "rate": 1e9}
OURS = {"curve": "jointwave blocks", "solves": "rigid blocks", **DONE, **SECONDS}
OTHER = {"curve": "Code", "solves": "points", "beside": "jointwave blocks", **DONE, **SECONDS}
MISSING = {"curve": "Gone", "solves": "spheres", "state": "missing", "message": "no apt here"}


@pytest.fixture
def rows():
    """Return the table of two runs of another code, one of jointwave, and a missing one."""
    slow = OTHER | {"stepping_over_ours": 124.4, "whole_over_ours": 2.68}
    quick = OTHER | {"stepping_over_ours": 5.81, "whole_over_ours": 0.132}
    return pd.DataFrame([OURS, slow, quick, MISSING], columns=[*peers.NEEDED, "machine"])


def test_sentences_are_of_the_extremes(rows):
    whole, one = peers.sentences(rows)
    assert "stepping takes 5.81 (Code) to 124 times (Code)" in whole and "0.13 to 2.7" in whole
    assert one.startswith("Code beside jointwave blocks: stepping 5.8 to 124 times")


def test_no_other_code_is_said(rows):
    assert "No other code ran" in peers.sentences(rows[rows["curve"] != "Code"])[0]


def test_every_row_is_in_the_table_and_the_missing_one_says_why(rows, tmp_path):
    groups = peers.table(rows).groups
    assert list(groups) == ["jointwave blocks: rigid blocks", "Code: points", "Gone: spheres"]
    assert groups["jointwave blocks: rigid blocks"][0][:5] == [
        *("elements per block 2", "1.00", "4.00", "", "")
    ]
    assert [row[3] for row in groups["Code: points"]] == ["124", "5.81"]
    assert groups["Gone: spheres"][0][0] == "missing: no apt here"
    section = peers.write_section(tmp_path, rows)
    assert section.failed == ["Gone (spheres): missing, no apt here"]
    assert "unnamed machine" in section.about
    assert peers.read(tmp_path / "peers.csv").shape == rows.shape
    svg = section.figure.file("svg").read_text(encoding="utf-8")
    assert "Code: points" in svg and "Gone" not in svg


def test_machine_is_named(rows, tmp_path):
    assert peers.write_section(tmp_path, rows.assign(machine="this one")).about == "this one"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "cannot be read"),
        ("", "cannot be read"),
        ("time,stress\n0,1\n", "is not a table of make bench-peers: it has no column curve"),
    ],
)
def test_a_file_that_is_no_such_table_is_refused(tmp_path, text, message):
    file = tmp_path / "points.csv"
    if text is not None:
        file.write_text(text)
    with pytest.raises(SceneError, match=message):
        peers.read(file)


def test_without_a_name_the_table_is_looked_for_where_it_is_written(tmp_path, monkeypatch, rows):
    monkeypatch.chdir(tmp_path)
    assert peers.read(None) is None
    peers.PLACE.parent.mkdir(parents=True)
    rows.to_csv(peers.PLACE, index=False)
    assert peers.read(None).shape == rows.shape
