"""Figures for papers: their width, their letters, their fonts, in both languages and formats."""

import re
import shutil
import subprocess
import warnings
import xml.etree.ElementTree as ET
from base64 import b64decode
from io import BytesIO
from itertools import combinations

import numpy as np
import pytest
from fontTools.ttLib import TTFont
from matplotlib.colors import to_rgb
from matplotlib.image import imread
from matplotlib.text import Text

from cases.errors import SceneError
from compare.engines import ENGINES, names
from compare.exact.blocks import lattice
from compare.figures import fonts
from compare.figures.print.draw import CHINESE, WORDS, draw
from compare.figures.print.layout import MM, STYLES
from compare.figures.print.make import FigureRequest, make, save
from compare.figures.style import style
from compare.misfit.pairs import Comparison

SCENE = "guo-li-2002/fig-03"
SHORT = {"time__duration": 0.01, "record__velocity": [20.25]}
FACE = re.compile(r"font-family:'([^']+)';src:url\(data:font/woff;base64,([^)]+)\)")
JOURNAL = STYLES["journal"]

needs_chinese = pytest.mark.skipif(
    fonts.chinese_font() is None, reason="no font with Chinese characters here"
)
LANGUAGES = ["en", pytest.param("zh", marks=needs_chinese)]


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
def test_letters_are_large_enough_and_within_the_page(comparison, columns, language):
    """At least 7 points, none cut off, none of the legend on a panel."""
    variants = [comparison(), comparison(joints__damping_ratio=0.05, record__velocity=[])]
    figure = draw(variants, JOURNAL, columns, language)
    width, height = figure.canvas.get_width_height()
    assert height / figure.dpi / MM <= JOURNAL.tallest
    found = texts(figure)
    assert len(found) > 20
    assert min(text.get_fontsize() for text in found) >= 7.0
    (legend,) = figure.legends
    top = legend.get_window_extent()
    parts = [top, *(ax.get_tightbbox() for ax in figure.axes if ax.get_visible())]
    for box in parts:
        assert box.x0 >= 0 and box.x1 <= width and box.y0 >= 0 and box.y1 <= height
    assert max(box.y1 for box in parts[1:]) <= top.y0
    for one, other in combinations(parts[1:], 2):
        assert not one.overlaps(other)


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_pdf_holds_its_fonts_as_true_type(written, language):
    """A font file for every font, and no letters as single outlines (Type 3)."""
    content = written("pdf", language).read_bytes()
    chinese = {fonts.chinese_font().name.replace(" ", "")} if language == "zh" else set()
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


@pytest.mark.parametrize("language", LANGUAGES)
def test_an_svg_holds_a_glyph_for_every_letter(written, language):
    """Its fonts are embedded and contain all letters of its texts."""
    svg = written("svg", language).read_text(encoding="utf-8")
    held = {}
    for family, data in FACE.findall(svg):
        held[family] = set(TTFont(BytesIO(b64decode(data))).getBestCmap())
    root = ET.fromstring(svg)
    words = [e for e in root.iter("{http://www.w3.org/2000/svg}text")]
    assert len(words) > 10
    for word in words:
        families = re.findall(r"'([^']+)'", word.get("style"))
        needed = {ord(letter) for letter in "".join(word.itertext()) if not letter.isspace()}
        assert needed and not needed - set().union(*(held.get(f, set()) for f in families))


@needs_chinese
def test_chinese_labels_have_glyphs(comparison):
    """Every letter of every label that there is, not only of those in one figure."""
    words = [*map(CHINESE.solution, names()), *CHINESE.quantities.values(), *CHINESE.parts.values()]
    text = "".join([*words, CHINESE.time, CHINESE.place, CHINESE.comma])
    left = fonts.missing(fonts.file_of("DejaVu Sans"), text)
    assert left and not fonts.missing(fonts.chinese_font().fname, "".join(left))
    labels = {t.get_text() for t in texts(draw([comparison()], JOURNAL, 1, "zh"))}
    assert {"时间 (ms)", "刚性块体（离散元）"} <= labels
    assert any(label.startswith("应力 (") for label in labels)


@needs_chinese
def test_a_chinese_glyph_is_drawn_and_not_a_box(comparison):
    """matplotlib warns of letters that it has no glyph for."""
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        draw([comparison()], JOURNAL, 1, "zh").canvas.draw()
    assert not [str(warning.message) for warning in seen if "Glyph" in str(warning.message)]


def test_without_a_font_for_it_one_line_says_which_to_install(comparison, monkeypatch):
    monkeypatch.setattr(fonts, "chinese_font", lambda: None)
    with pytest.raises(SceneError, match="apt install fonts-wqy-microhei") as error:
        draw([comparison()], JOURNAL, 1, "zh")
    assert str(error.value).startswith("--language: zh: ")


def test_a_letter_that_no_font_has_is_refused(comparison, monkeypatch):
    """A variant's name may be in any script."""
    monkeypatch.setattr(fonts, "chinese_font", lambda: None)
    found = comparison()
    found.scene = found.scene.model_copy(update={"name": "软弱层"})
    with pytest.raises(SceneError, match=r"no font here has .*层"):
        draw([found], JOURNAL, 1, "en")


def test_postscript_outlines_are_refused_in_a_pdf(written, monkeypatch):
    monkeypatch.setattr(fonts, "is_true_type", lambda family: False)
    with pytest.raises(SceneError, match="outlines are PostScript"):
        written("pdf", anew=True)
    assert written("svg", anew=True).is_file()


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


def test_panels_stand_beside_each_other_in_two_columns(comparison):
    one, two = (draw([comparison()], JOURNAL, columns, "en") for columns in (1, 2))
    assert len({round(ax.get_position().x0, 2) for ax in one.axes}) == 1
    assert len({round(ax.get_position().x0, 2) for ax in two.axes}) == 2
    assert two.get_figheight() < one.get_figheight()


def test_the_same_figure_is_the_same_file(written):
    for kind in ("pdf", "svg", "png"):
        assert written(kind).read_bytes() == written(kind, anew=True).read_bytes()


def test_what_is_asked_for_is_drawn(pillar, tmp_path):
    """By engines and models, and every curve is that of its solution."""
    scene, out = pillar(**SHORT), tmp_path / "figure.svg"
    request = FigureRequest("screen", 2, None, "en", out)
    done = []
    make([scene], [("dem", None), ("exact", "lattice")], [], request, done.append)
    labels = set(re.findall(r">([^<>]+)</text>", out.read_text()))
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
