"""Scenes and studies that are wrong in any way: read, or refused in one line within 5 s."""

import datetime
import tomllib
from pathlib import Path

import pytest
from hypothesis import strategies as st

from jointwave import cases
from jointwave.compare.studies.study import SHIPPED as STUDIES

SCENE_FILES = sorted(Path(cases.__file__).parent.glob("*/*.toml"))
SCENES = [path.read_text(encoding="utf-8") for path in SCENE_FILES]
STUDY_TEXTS = [p.read_text(encoding="utf-8") for p in sorted(STUDIES.glob("*.toml"))]

ROUND = [2, 3, 10, 0.1, 0.5, 1e-3, 1e-6, 1e-9, 1e6, 1e9, 10**400, -(2**70), 2**63]
EXTREME = [0, -1, 1, 1e-30, 1e30, -1e30, 1e-31, 1e300, 5e-324, float("nan"), float("inf")]
NUMBERS = st.one_of(
    st.sampled_from(EXTREME), st.sampled_from(ROUND), st.floats(), st.integers(-(10**6), 10**6)
)
ODD = ["", "\0", "é\u2028☃", "a" * 5000, "../x", "/dev/zero", "..", "~", "nan", "free"]
SHAPES = ["sine", "ricker", "gabor", "triangle", "step", "table"]
SIDES = ["fixed", "quiet", "matched", "implicit", "periodic", "top", "outline"]
KINDS = ["P", "S", "pressure", "base", "force", "bed", "cut", "merge"]
TEXTS = st.text(max_size=20) | st.sampled_from(ODD) | st.sampled_from(SHAPES + SIDES + KINDS)
TIMES = st.dates() | st.datetimes(max_value=datetime.datetime(9000, 1, 1))
VALUES = st.recursive(
    st.one_of(NUMBERS, TEXTS, st.booleans(), TIMES),
    lambda inner: (
        st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=6), inner, max_size=3)
    ),
    max_leaves=6,
)


def places(table, path=()):
    """Yield the path of every key and every item of a list."""
    items = table.items() if isinstance(table, dict) else enumerate(table)
    for key, value in items:
        yield (*path, key)
        if isinstance(value, dict | list):
            yield from places(value, (*path, key))


@st.composite
def tables(draw, texts):
    """Draw a shipped file's table with one to three keys dropped, added, replaced or scaled."""
    table = tomllib.loads(draw(st.sampled_from(texts)))
    for _ in range(draw(st.integers(1, 3))):
        *above, last = draw(st.sampled_from(list(places(table)) or [("title",)]))
        inner = table
        for key in above:
            inner = inner[key]
        kind = draw(st.sampled_from(["drop", "replace", "number", "scale", "scale", "add"]))
        here = inner.get(last) if isinstance(inner, dict) else inner[last]
        is_number = isinstance(here, int | float) and not isinstance(here, bool)
        if kind == "drop":
            del inner[last]
        elif kind == "scale" and is_number and abs(here) <= 1e290:
            inner[last] = here * 10 ** draw(st.floats(-12, 12))
        else:
            if kind == "add" and isinstance(last, str):
                last = draw(st.text(max_size=8))
            inner[last] = draw(NUMBERS if kind == "number" else VALUES)
    return table


@st.composite
def spoilt(draw, texts, changed):
    """Draw a file as bytes: lines doubled or cut, other encodings, any bytes in between."""
    text = draw(st.sampled_from(texts) | changed)
    kind = draw(st.sampled_from(["lines", "bytes", "encoding", "crlf", "bom", "cut", "nested"]))
    if kind == "lines":
        lines = text.splitlines()
        i, j = (draw(st.integers(0, max(0, len(lines) - 1))) for _ in range(2))
        return "\n".join([*lines[:i], *lines[j:]]).encode()
    if kind == "nested":
        opened = draw(st.sampled_from(["[", "{a=", "a.", '"b".', "a . "]))
        deep = opened * draw(st.integers(1, 3000))
        return (f"{deep}a=1" if "." in opened else f"{text}\nx = {deep}").encode()
    if kind == "encoding":
        return text.encode(draw(st.sampled_from(["utf-16", "utf-32", "latin-1"])), "replace")
    data = text.encode()
    if kind == "crlf":
        return data.replace(b"\n", draw(st.sampled_from([b"\r\n", b"\r", b"\n\r"])))
    at = draw(st.integers(0, len(data)))
    return {
        "bom": b"\xef\xbb\xbf" + data,
        "cut": data[:at],
        "bytes": data[:at] + draw(st.binary(max_size=12)) + data[at:],
    }[kind]


@pytest.mark.parametrize(
    ("target", "texts", "count"), [("scene", SCENES, 300), ("study", STUDY_TEXTS, 150)]
)
def test_a_file_that_is_changed_or_spoilt_is_read_or_refused(meets, in_toml, target, texts, count):
    changed = tables(texts).map(in_toml)
    meets(target, changed.map(str.encode) | spoilt(texts, changed), count)
