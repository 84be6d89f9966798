"""Loads, curves, meshes and command lines wrong in any way: read or refused in one line."""

from pathlib import Path

import pytest
from hypothesis import strategies as st

from jointwave import cases

LOADS = [p.read_bytes() for p in sorted(Path(cases.__file__).parent.glob("*/*.csv"))]
ODD = ["", "nan", "inf", "1e400", "-0", "1_0", "0x10", '"', '"1"', " 1 ", "١", "\0", "#"]
CELLS = st.one_of(
    st.floats().map(repr), st.integers().map(str), st.sampled_from(ODD), st.text(max_size=5)
)
UNITS = "time [ms], -stress@20 [MPa], velocity_x@1 [m]\n"
HEADERS = st.sampled_from(["", "time,stress@20\n", UNITS, "t\n", "time,time\n"])


@st.composite
def numbers(draw):
    """Draw a CSV file, right, nearly right or wrong."""
    separator = draw(st.sampled_from([",", ", ", ";", "\t", " "]))
    if draw(st.booleans()):
        times = sorted(draw(st.lists(st.floats(0, 1e30), max_size=6)))
        rows = [[repr(t), repr(draw(st.floats(-1e30, 1e30)))] for t in times]
    else:
        rows = draw(st.lists(st.lists(CELLS, max_size=4), max_size=8))
    ending = draw(st.sampled_from(["\n", "\r\n", "\r"]))
    text = draw(HEADERS) + ending.join(separator.join(row) for row in rows)
    return text.encode(draw(st.sampled_from(["utf-8", "utf-8", "utf-8-sig", "utf-16"])), "replace")


@st.composite
def cut(draw, files):
    """Draw a file with a part left out, doubled or replaced, up to three times."""
    data = draw(st.sampled_from(files))
    for _ in range(draw(st.integers(0, 3))):
        i = draw(st.integers(0, len(data)))
        j = min(len(data), i + draw(st.sampled_from([0, 1, 1, 4, 8, 100, len(data)])))
        new = [b"", b"-1", b"9" * 12, b"1e400", data[i:j] * 2]
        data = data[:i] + draw(st.binary(max_size=8) | st.sampled_from(new)) + data[j:]
    return data


@pytest.mark.parametrize("target", ["load", "curve"])
def test_a_table_of_numbers_is_read_or_refused(meets, target):
    meets(target, numbers() | cut(LOADS), 200)


def test_a_spoilt_mesh_is_read_or_refused(meets, gmsh_files):
    meets("mesh", cut(gmsh_files), 60)


SCENES = ["guo-li-2002/fig-03", "beyond/spall", "gone.toml", ".", "/dev/zero", "\udce9", "a" * 300]
SCENES.append("")
COMMANDS = "run list explain compare effects plan study report rum --help figure animate view new"
COMMANDS = [*COMMANDS.split(), "doctor"]
OPTIONS = "--set --variant --out --engine --model --with --align --json --misfit --seconds"
OPTIONS = [*OPTIONS.split(), "--workers", "--version", "--no-spectral", "-h", "--", "--set="]
SETS = "pillar.length=1e9 pillar.block=1e-9 .=1 ..= = x a.b.c=1 load.file=/dev/zero load=3"
SETS = [*SETS.split(), "load.shape=table", "record.stress=[1,2]", "x=1\ny=2", "title=\x00"]
SETS += [
    "variants=[]",
    "joints={tension=false}",
    "a=[" * 2000,
    "a" * 500 + "=1",
    "pillar.length=" + "9" * 5000,
]
VALUES = ["dem", "continuum", "exact", "jointed", "lattice", "0.01", "-1", "nan", "1e999"]
WORDS = st.sampled_from(COMMANDS + OPTIONS + SETS + SCENES + VALUES) | st.text(max_size=8)


@st.composite
def lines(draw):
    """Draw a command line, one argument a line."""
    words = [draw(st.sampled_from(COMMANDS)), draw(st.sampled_from(SCENES))]
    for _ in range(draw(st.integers(0, 4))):
        option = draw(st.sampled_from(OPTIONS))
        values = {"--set": st.sampled_from(SETS), "--out": st.just("out")}.get(option, WORDS)
        words += [option, draw(values)]
    words = draw(st.one_of(st.just(words), st.permutations(words), st.lists(WORDS, max_size=6)))
    return "\n".join(words).encode("utf-8", "surrogatepass")


def test_a_command_line_is_obeyed_or_refused(meets):
    meets("command", lines(), 150)
