"""Figures for papers: their width, their letters, their fonts, in both languages and formats; they
hold all that is written in them, whole and beside each other."""

import re
import shutil
import subprocess
import warnings
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from matplotlib.colors import to_rgb
from matplotlib.image import imread
from matplotlib.text import Text

from jointwave.cases.errors import SceneError
from jointwave.compare.engines import ENGINES, names
from jointwave.compare.exact.blocks import lattice
from jointwave.compare.figures import fonts
from jointwave.compare.figures.publication import MM, STYLES, draw
from jointwave.compare.figures.publication_file import FigureRequest, make, save
from jointwave.compare.figures.style import style
from jointwave.compare.figures.words import CHINESE, WORDS
from jointwave.compare.misfit.pairs import Comparison
from jointwave.results.dataset import dataset

SCENE = "guo-li-2002/fig-03"
SHORT = {"time__duration": 0.01, "record__velocity": [20.25]}
JOURNAL = STYLES["journal"]
EVERY = names()
FEW = ("dem", "continuum-jointed", "jointed-bar")
LONG = "the same joint after cycle {}"
#: receivers, variants, columns: one, the most of each, and what once was cut off.
SIZES = [(1, 1, 1), (3, 1, 2), (5, 2, 2), (8, 1, 1), (8, 4, 2), (2, 4, 1), (1, 4, 2), (7, 3, 2)]

has_chinese = len(fonts.families()) > 1
needs_chinese = pytest.mark.skipif(not has_chinese, reason="no font with Chinese characters here")
LANGUAGES = ["en", pytest.param("zh", marks=needs_chinese)]
ALSO = "zh" if has_chinese else "en"


@pytest.fixture
def many(pillar):
    """Return a function that gives variants with receivers, each a wave from all solutions named.

    The results have the schema of all; the waves are sines that arrive later at each receiver.
    """

    def comparisons(receivers, variants=1, solutions=EVERY, name="a joint of variant {}", **keys):
        places = [4.0 * (i + 1) for i in range(receivers)]
        scene = pillar(**{"record__stress": places, "record__velocity": []} | keys)
        time = np.linspace(0, scene.time.duration, 101)
        phase = 4 * time / time[-1] - np.arange(len(scene.record.stress))[:, None] / 8
        wave = scene.load.amplitude * np.sin(2 * np.pi * np.clip(phase, 0, 1))
        velocity = np.zeros((len(scene.record.velocity), len(time)))
        called = ["", *(name.replace("{}", str(i)) for i in range(1, variants))]
        scenes = [scene.model_copy(update={"name": one}) for one in called]
        return [
            Comparison(one, {s: dataset(one, s, time, wave, velocity) for s in solutions})
            for one in scenes
        ]

    return comparisons


@pytest.fixture
def comparison(pillar):
    """Return a function that gives a scene solved by its exact chain."""

    def solved(**changes):
        scene = pillar(**SHORT | changes)
        return Comparison(scene, {"lattice": lattice.solve(scene), "dem": lattice.solve(scene)})

    return solved


@pytest.fixture(scope="module")
def files():
    """Return what `written` has written, by kind, language and columns."""
    return {}


@pytest.fixture
def written(comparison, files, tmp_path_factory):
    """Return a function that writes a figure of one scene, once or `anew`, and returns its file."""

    def write(kind, language="en", columns=1, anew=False):
        key = kind, language, columns
        if key in files and not anew:
            return files[key]
        figure = draw([comparison()], JOURNAL, columns, language)
        file = tmp_path_factory.mktemp("figure") / f"figure.{kind}"
        made = save(figure, file, kind, "A title", JOURNAL.dpi)
        return made if anew else files.setdefault(key, made)

    return write


def texts(figure):
    figure.canvas.draw()
    return [t for t in figure.findobj(Text) if t.get_text().strip() and t.get_visible()]


@pytest.mark.parametrize("columns, width", [(1, 90.0), (2, 190.0)])
@pytest.mark.parametrize("language", LANGUAGES)
def test_the_page_is_as_wide_as_the_columns(written, columns, width, language):
    """To 0.1 mm, in every format."""
    box = re.search(
        rb"/MediaBox \[ 0 0 ([\d.]+) [\d.]+ \]", written("pdf", language, columns).read_bytes()
    )
    assert float(box[1]) * 25.4 / 72 == pytest.approx(width, abs=0.1)
    svg = ET.parse(written("svg", language, columns)).getroot()
    assert float(svg.get("width").removesuffix("pt")) * 25.4 / 72 == pytest.approx(width, abs=0.1)
    pixels = imread(written("png", language, columns)).shape[1]
    assert pixels * 25.4 / JOURNAL.dpi == pytest.approx(width, abs=0.1)


@pytest.mark.parametrize("columns", [1, 2])
@pytest.mark.parametrize("language", LANGUAGES)
def test_letters_are_large_enough_and_within_the_page(comparison, collisions, columns, language):
    """At least 7 points, none cut off, none of the legend on a panel."""
    variants = [comparison(), comparison(joints__damping_ratio=0.05, record__velocity=[])]
    figure = draw(variants, JOURNAL, columns, language)
    assert figure.get_figheight() / MM <= JOURNAL.tallest and collisions(figure) == []
    found = texts(figure)
    assert len(found) > 20
    assert min(text.get_fontsize() for text in found) >= 7.0


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_pdf_holds_its_fonts_as_true_type(written, language):
    """A font file for every font, and no letters as single outlines (Type 3)."""
    content = written("pdf", language).read_bytes()
    chinese = {fonts.families()[1].replace(" ", "")} if language == "zh" else set()
    named = {name.decode().partition("+")[2] for name in re.findall(rb"/FontName /(\S+)", content)}
    assert named == {"DejaVuSans"} | chinese
    assert content.count(b"/FontFile2") == content.count(b"/Type /FontDescriptor") > 0
    assert b"/Type3" not in content


@pytest.mark.skipif(
    shutil.which("pdffonts") is None, reason="no pdffonts: apt install poppler-utils"
)
@pytest.mark.parametrize("language", LANGUAGES)
def test_another_program_finds_every_font_of_a_pdf_embedded(written, language):
    done = subprocess.run(("pdffonts", written("pdf", language)), capture_output=True, text=True)
    rows = done.stdout.splitlines()[2:]
    assert rows and done.stderr == ""
    for row in rows:
        assert re.search(r" (CID )?TrueType .* yes +yes +yes ", row)


def test_letters_of_an_svg_are_outlines(written):
    """It needs no installed font."""
    root = ET.parse(written("svg")).getroot()
    assert not list(root.iter("{http://www.w3.org/2000/svg}text"))


@needs_chinese
def test_chinese_labels_have_glyphs(comparison):
    """Every letter of every label that there is, not only of those in one figure."""
    words = [*map(CHINESE.solution, names()), *CHINESE.quantities.values(), *CHINESE.parts.values()]
    text = "".join([*words, CHINESE.time, CHINESE.place, CHINESE.comma])
    assert not fonts.missing(text)
    with warnings.catch_warnings(record=True) as seen:  # matplotlib warns of a letter without glyph
        warnings.simplefilter("always")
        labels = {t.get_text() for t in texts(draw([comparison()], JOURNAL, 1, "zh"))}
    assert not [str(warning.message) for warning in seen if "Glyph" in str(warning.message)]
    assert {"时间 (ms)", "刚性块体（离散元）"} <= labels
    assert any(label.startswith("应力 (") for label in labels)


def test_without_a_font_for_it_one_line_says_which_to_install(comparison, monkeypatch):
    monkeypatch.setattr(fonts, "families", lambda: [fonts.LATIN])
    with pytest.raises(SceneError, match="apt install fonts-wqy-microhei") as error:
        draw([comparison()], JOURNAL, 1, "zh")
    assert str(error.value).startswith("--language: zh: ")


def test_a_letter_that_no_font_has_is_refused(comparison, monkeypatch):
    """A variant's name may be in any script."""
    monkeypatch.setattr(fonts, "families", lambda: [fonts.LATIN])
    found = comparison()
    found.scene = found.scene.model_copy(update={"name": "软弱层"})
    with pytest.raises(SceneError, match=r"no font here has .*层"):
        draw([found], JOURNAL, 1, "en")


def test_every_solution_has_words_and_a_line_of_its_own():
    """In both languages; in grey no two lines are alike, engines are wide and light."""
    for words in WORDS.values():
        assert len({words.solution(name) for name in names()} - {*names()}) == len(names())
    lines = {name: JOURNAL.of_line(name) for name in names()}
    assert len({str(line["linestyle"]) for line in lines.values()}) == len(names())
    for name, line in lines.items():
        assert line["color"] == style(name).colour
        grey = np.dot(to_rgb(line["color"]), (0.299, 0.587, 0.114))
        assert (grey > 0.55 and line["linewidth"] > 1) if name in ENGINES else grey < 0.5


def test_the_same_figure_is_the_same_file(written):
    for kind in ("pdf", "svg", "png"):
        assert written(kind).read_bytes() == written(kind, anew=True).read_bytes()


def test_what_is_asked_for_is_drawn(pillar, tmp_path):
    """By engines and models, and every curve is that of its solution."""
    scene, out = pillar(**SHORT), tmp_path / "figure.svg"
    request = FigureRequest("screen", 2, None, "en", out)
    done = []
    make([scene], [("dem", None), ("exact", "lattice")], [], request, done.append)
    labels = set(re.findall(r"<!-- (.+) -->", out.read_text()))  # of the outlines
    assert {"rigid blocks", "rigid blocks, exact"} <= labels and "jointed rock" not in labels
    assert done == [0.5, 1.0]


@pytest.mark.parametrize(
    "arguments, words",
    [
        (("--out", "figure.doc"), "must end in .pdf, .svg, .png"),
        (("--out", "figure.svg", "--format", "pdf"), "must end in .pdf"),
        (("--out", "figure.pdf", "--columns", "3"), "columns"),
        (("--out", "figure.pdf", "--language", "de"), "de"),
        (("--out", "figure.pdf", "--style", "poster"), "poster"),
        (("--out", "figure.pdf", "--engine", "exact", "--model", "no-tension-chain"), "tension"),
        (("--out", "taken.pdf", "--variant", "", "--engine", "dem"), "would be overwritten"),
        ((), "--out"),
    ],
)
def test_a_mistake_is_one_line(jointwave, tmp_path, monkeypatch, arguments, words):
    """And no file is written or lost."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "taken.pdf").write_text("mine")
    said = jointwave("figure", SCENE, *arguments, code=2).err
    assert said.count("\n") == 1 and words in said
    assert [path.name for path in tmp_path.iterdir()] == ["taken.pdf"]
    assert (tmp_path / "taken.pdf").read_text() == "mine"


def test_the_command_draws_curves_of_others_too(jointwave, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "curve.csv").write_text("time [ms], stress@20 [MPa]\n0, 0\n5, 0.1\n10, 0.2\n")
    options = ["--variant", "", "--engine", "dem", "--set", "time.duration=0.02"]
    said = jointwave("figure", SCENE, *options, "--with", "curve.csv", "--out", "figure.svg")
    assert said == ("wrote figure.svg\n", "")
    assert "curve.csv" in (tmp_path / "figure.svg").read_text()


@pytest.mark.parametrize("receivers, variants, columns", SIZES)
def test_nothing_is_cut_off_or_overprinted(many, collisions, receivers, variants, columns):
    figure = draw(many(receivers, variants, FEW, LONG), JOURNAL, columns, ALSO)
    assert len([ax for ax in figure.axes if ax.get_visible()]) == receivers * variants
    assert collisions(figure) == []
    assert figure.get_figheight() / MM <= JOURNAL.tallest + 1e-6


@pytest.mark.parametrize("columns", [1, 2])
@pytest.mark.parametrize("style", STYLES)
def test_a_legend_of_every_solution_fits(many, collisions, style, columns):
    assert collisions(draw(many(2, 2), STYLES[style], columns, ALSO)) == []


@settings(max_examples=5, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(size=st.floats(-9, 9), duration=st.floats(1e-3, 1e3))
def test_numbers_on_the_axes_stay_apart(many, collisions, size, duration):
    """Whatever they are."""
    keys = {"load__amplitude": 10**size, "time__duration": duration}
    found = many(3, 1, ("dem",), record__interval=duration / 100, **keys)
    assert collisions(draw(found, JOURNAL, 2, "en")) == []


def test_more_panels_than_a_page_holds_are_refused_in_one_line(many):
    with pytest.raises(SceneError, match="32 panels do not fit 240 mm: choose --columns 2, a "):
        draw(many(8, 4, ("dem",)), JOURNAL, 1, "en")


@pytest.mark.parametrize("name", ["a name of several words {}" * 6, "软弱层与节理" * 12])
def test_a_name_of_any_length_is_whole(many, collisions, name):
    if name[0] == "软" and not has_chinese:
        pytest.skip("no font with Chinese characters here")
    figure = draw(many(2, 2, ("dem",), name), JOURNAL, 1, "en")
    assert collisions(figure) == []
    title = figure.axes[-1].get_title(loc="left").replace("\n", "").replace(" ", "")
    assert name.replace("{}", "1").replace(" ", "") in title


def test_times_are_written_once_a_column(many):
    figure = draw(many(5, 2), JOURNAL, 2, "en")
    visible = [ax for ax in figure.axes if ax.get_visible()]
    assert len(visible) == 10 and len({round(ax.get_position().x0, 2) for ax in visible}) == 2
    assert [bool(ax.get_xlabel()) for ax in visible] == [False] * 8 + [True] * 2


def test_the_motion_is_drawn_and_the_title_says_without_what(many):
    """A prestress of ten times the wave neither flattens it nor is forgotten."""
    (found,) = many(2, 1, ("dem", "lattice"))
    waves = 1e-6 * found.results["dem"]["stress"].values
    for result in found.results.values():
        result["stress"] = result["stress"] + 1e7
        result.attrs |= {"starts": "prestressed", "prestress": 1e7}
    figure = draw([found], JOURNAL, 1, "en")
    for ax, wave in zip(figure.axes, waves, strict=True):
        assert "minus the static 10\u00a0MPa" in ax.get_title(loc="left").replace("\n", " ")
        assert ax.get_ylabel() == "stress (MPa)"
        assert ax.lines[1].get_ydata() == pytest.approx(wave, abs=1e-8)
