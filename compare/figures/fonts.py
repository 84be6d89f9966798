"""Fonts for Chinese labels: an installed one that has the characters.

matplotlib reads only the first face of a font collection; for Noto and WenQuanYi that is a
sans-serif face with all characters of the labels.
"""

from functools import cache

from matplotlib import font_manager
from matplotlib.ft2font import FT2Font

LATIN = "DejaVu Sans"  # comes with matplotlib

#: In order of preference: TrueType outlines can be embedded in every format unchanged.
CHINESE = (
    "WenQuanYi Micro Hei",
    "WenQuanYi Zen Hei",
    "Noto Sans CJK SC",
    "Noto Sans CJK JP",
    "Source Han Sans SC",
    "Source Han Sans CN",
    "Noto Sans SC",
    "Microsoft YaHei",
    "SimHei",
    "PingFang SC",
    "Heiti SC",
    "Droid Sans Fallback",
)
HINT = "apt install fonts-wqy-microhei (or fonts-noto-cjk, for SVG and PNG)"
NEEDED = "应力时间刚性块体"  # characters that a font for Chinese has


def families() -> list[str]:
    """Return the font families of text: Latin letters, then Chinese ones if installed."""
    chinese = chinese_font()
    return [LATIN] if chinese is None else [LATIN, chinese.name]


@cache
def chinese_font() -> font_manager.FontEntry | None:
    """Return the font for Chinese labels; None if none is installed."""
    _look_again()
    installed: dict[str, font_manager.FontEntry] = {}
    for entry in font_manager.fontManager.ttflist:
        if entry.name in CHINESE and entry.weight in (400, "normal", "regular"):
            installed.setdefault(entry.name, entry)
    known = (installed[name] for name in CHINESE if name in installed)
    return next((entry for entry in known if not missing(entry.fname, NEEDED)), None)


def _look_again() -> None:
    """Add fonts installed after matplotlib built its list of them."""
    known = {entry.fname for entry in font_manager.fontManager.ttflist}
    for path in font_manager.findSystemFonts():
        if path not in known and any(part in path.lower() for part in ("cjk", "wqy", "han", "hei")):
            font_manager.fontManager.addfont(path)


def file_of(family: str) -> str:
    """Return the file of the regular face of an installed family."""
    return str(font_manager.findfont(family, fallback_to_default=False))


def number_of(family: str) -> int:
    """Return the index of a family's face in its file: matplotlib may know only the first."""
    return int(getattr(font_manager.findfont(family, fallback_to_default=False), "face_index", 0))


def is_true_type(family: str) -> bool:
    """Return whether a family's outlines are TrueType's, not PostScript's."""
    from fontTools.ttLib import TTFont

    with TTFont(file_of(family), fontNumber=number_of(family), lazy=True) as font:
        return "glyf" in font


def missing(file: str, text: str) -> set[str]:
    """Return the characters of a text for which a font file has no glyph."""
    glyphs = FT2Font(file).get_charmap()
    return {letter for letter in text if not letter.isspace() and ord(letter) not in glyphs}
