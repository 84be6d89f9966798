"""Scenes and studies that are wrong in any way: read, or refused in one line within 5 s."""

import copy
import datetime
import json
import tomllib
from pathlib import Path

import pytest
from hypothesis import strategies as st

from jointwave import cases
from jointwave.compare.studies import SHIPPED as STUDIES

SCENES = [
    p.read_text(encoding="utf-8") for p in sorted(Path(cases.__file__).parent.glob("*/*.toml"))
]
STUDY_TEXTS = [p.read_text(encoding="utf-8") for p in sorted(STUDIES.glob("*.toml"))]
FEW, MANY = 150, 2000  # examples

NUMBERS = st.one_of(
    st.sampled_from(
        [0, -1, 1, 1e-30, 1e30, -1e30, 1e-31, 1e300, 5e-324, float("nan"), float("inf"), 2**63]
    ),
    st.sampled_from([2, 3, 10, 0.1, 0.5, 1e-3, 1e-6, 1e-9, 1e6, 1e9, 10**400, -(2**70)]),
    st.floats(),
    st.integers(-(10**6), 10**6),
)
TEXTS = st.one_of(
    st.text(max_size=20),
    st.sampled_from(
        ["", "\0", "é\u2028☃", "a" * 5000, "../x", "/dev/zero", "..", "~", "nan", "free"]
    ),
    st.sampled_from(["sine", "ricker", "gabor", "triangle", "step", "table"]),
    st.sampled_from(["fixed", "quiet", "matched", "implicit", "periodic", "top", "outline"]),
    st.sampled_from(["P", "S", "pressure", "base", "force", "bed", "cut", "merge"]),
)
SCALARS = st.one_of(
    NUMBERS, TEXTS, st.booleans(), st.dates(), st.datetimes(max_value=datetime.datetime(9000, 1, 1))
)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4), st.dictionaries(st.text(max_size=6), inner, max_size=3)
    ),
    max_leaves=6,
)


def toml(value, depth=0):
    """Return a value as TOML, tables inline."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(k)} = {toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value)
    return value.isoformat() if isinstance(value, datetime.date) else repr(value)


def document(table):
    """Return a table as a TOML document, a key a line."""
    return "\n".join(f"{json.dumps(key)} = {toml(value)}" for key, value in table.items())


def places(table, path=()):
    """Yield the path of every key and every item of a list."""
    items = table.items() if isinstance(table, dict) else enumerate(table)
    for key, value in items:
        yield (*path, key)
        if isinstance(value, dict | list):
            yield from places(value, (*path, key))


def changed(table, path, value):
    """Return a table with another value at a path; None drops it."""
    table = copy.deepcopy(table)
    inner = table
    for key in path[:-1]:
        inner = inner[key]
    if value is None:
        del inner[path[-1]]
    else:
        inner[path[-1]] = value
    return table


@st.composite
def tables(draw, texts):
    """Draw a shipped file's table with one to three keys dropped, added, replaced or scaled."""
    table = tomllib.loads(draw(st.sampled_from(texts)))
    for _ in range(draw(st.integers(1, 3))):
        path = draw(st.sampled_from(list(places(table)) or [("title",)]))
        kind = draw(st.sampled_from(["drop", "replace", "number", "scale", "scale", "add"]))
        if kind == "add":
            path = (*path[:-1], draw(st.text(max_size=8))) if isinstance(path[-1], str) else path
        value = {"drop": st.none(), "number": NUMBERS}.get(kind, VALUES)
        if kind == "scale":
            here = table
            for key in path:
                here = here[key]
            value = st.floats(-12, 12).map(lambda x, here=here: here * 10**x)
            if isinstance(here, bool) or not isinstance(here, int | float) or abs(here) > 1e290:
                value = VALUES
        table = changed(table, path, draw(value))
    return document(table)


@st.composite
def spoilt(draw, texts):
    """Draw a file as bytes: lines doubled or cut, other encodings, any bytes in between."""
    text = draw(st.one_of(st.sampled_from(texts), tables(texts)))
    kind = draw(st.sampled_from(["lines", "bytes", "encoding", "crlf", "bom", "cut", "nested"]))
    if kind == "lines":
        lines = text.splitlines()
        i, j = (draw(st.integers(0, max(0, len(lines) - 1))) for _ in range(2))
        return "\n".join([*lines[:i], *lines[j:]]).encode()
    if kind == "nested":
        deep = draw(st.integers(1, 3000))
        opened = draw(st.sampled_from(["[", "{a=", "a.", '"b".', "a . "]))
        return (
            f"{text}\nx = {opened * deep}".encode()
            if "." not in opened
            else (opened * deep + "a=1").encode()
        )
    data = text.encode(draw(st.sampled_from(["utf-16", "utf-32", "latin-1"])), "replace")
    if kind == "encoding":
        return data
    data = text.encode()
    if kind == "crlf":
        return data.replace(b"\n", draw(st.sampled_from([b"\r\n", b"\r", b"\n\r"])))
    at = draw(st.integers(0, len(data)))
    return {
        "bom": b"\xef\xbb\xbf" + data,
        "cut": data[:at],
        "bytes": data[:at] + draw(st.binary(max_size=12)) + data[at:],
    }[kind]


def test_a_scene_with_changed_keys_is_read_or_refused(meets):
    meets("scene", tables(SCENES).map(str.encode), FEW)


def test_a_spoilt_scene_file_is_read_or_refused(meets):
    meets("scene", spoilt(SCENES), FEW)


def test_a_study_with_changed_keys_is_read_or_refused(meets):
    meets("study", st.one_of(tables(STUDY_TEXTS).map(str.encode), spoilt(STUDY_TEXTS)), FEW)


@pytest.mark.slow
@pytest.mark.parametrize("name, texts", [("scene", SCENES), ("study", STUDY_TEXTS)])
def test_thousands_of_files_are_read_or_refused(meets, name, texts):
    meets(name, st.one_of(tables(texts).map(str.encode), spoilt(texts)), MANY)
