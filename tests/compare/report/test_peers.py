"""The table of other codes as the report shows it: ratios, what is missing, and bad files."""

import pandas as pd
import pytest

from jointwave.cases.errors import SceneError
from jointwave.compare.report import peers

DONE = {"settings": '{"elements_per_block": 2}', "state": "done", "misfit": 0.01}
SECONDS = {"total_misfit": 0.04, "seconds": 0.001, "whole": 0.8, "rate": 1e9}
OURS = {"curve": "jointwave blocks", "solves": "rigid blocks", **DONE, **SECONDS}
OTHER = {"curve": "Code", "solves": "points", "beside": "jointwave blocks", **DONE, **SECONDS}
MISSING = {"curve": "Gone", "solves": "spheres", "state": "missing", "message": "no apt here"}


@pytest.fixture
def file(tmp_path):
    """Return the table of two runs of another code, one of jointwave, and a missing one."""
    slow = OTHER | {"stepping_over_ours": 124.4, "whole_over_ours": 2.68}
    quick = OTHER | {"stepping_over_ours": 5.81, "whole_over_ours": 0.132}
    table = pd.DataFrame([OURS, slow, quick, MISSING], columns=[*peers.TEXTS, *peers.NUMBERS])
    table.to_csv(tmp_path / "points.csv", index=False)
    return tmp_path / "points.csv"


def test_ratios_are_in_sentences_and_the_missing_code_says_why(file, tmp_path):
    read = peers.read(file)
    found = peers.summarise(read, tmp_path)
    (sentence,) = found.sentences
    assert sentence.startswith("Code beside jointwave blocks: stepping 5.81 to 124 times, whole")
    assert found.failed == ["Gone (spheres): no apt here"]
    assert "unnamed machine" in found.about
    table = found.table.reset_index()
    assert list(table["curve"]) == ["jointwave blocks: rigid blocks", *["Code: points"] * 2]
    assert table["settings"].eq("elements per block: 2").all()
    assert list(table["stepping over ours"])[1:] == [124.4, 5.81]
    assert table["own model (%)"].eq(1).all() and table["finest physics (%)"].eq(4).all()
    svg = found.figure.file("svg").read_text(encoding="utf-8")
    assert "Code: points" in svg and "Gone" not in svg
    assert "No other code ran" in peers.sentences(read[read["curve"] != "Code"])[0]


@pytest.mark.parametrize(
    ("text", "message"),
    [("", "No columns"), ("time,stress\n0,1\n", "columns expected but not found")],
)
def test_a_file_that_is_no_such_table_is_refused(tmp_path, text, message):
    (file := tmp_path / "points.csv").write_text(text)
    with pytest.raises(SceneError, match=message) as error:
        peers.read(file)
    assert "is not a table of make bench-peers" in str(error.value)


def test_the_table_is_looked_for_where_it_is_written(file, tmp_path, monkeypatch, jointwave):
    """One that is named and not there is a line, before anything is solved or written."""
    monkeypatch.chdir(tmp_path)
    assert peers.read(None) is None
    peers.PLACE.parent.mkdir(parents=True)
    file.rename(peers.PLACE)
    assert len(peers.read(None)) == 4
    said = jointwave("report", "--peers", "none.csv", code=2).err
    assert said.count("\n") == 1 and "none.csv" in said and "cannot be read" in said
    assert "is not a table of make bench-peers" in said
    assert not (tmp_path / "report").exists()
