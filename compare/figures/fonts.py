"""Fonts of figures: DejaVu Sans, which comes with matplotlib, and an installed one for Chinese."""

from contextlib import suppress
from functools import cache

from matplotlib import font_manager
from matplotlib.ft2font import FT2Font

from jointwave.cases.errors import SceneError

LATIN = "DejaVu Sans"
#: Fonts with Chinese characters and TrueType outlines, which can be embedded in every format.
CHINESE = (
    *("WenQuanYi Micro Hei", "WenQuanYi Zen Hei", "Microsoft YaHei", "SimHei", "Heiti SC"),
    "Droid Sans Fallback",
)
HINT = "apt install fonts-wqy-microhei"


@cache
def families() -> list[str]:
    """Return the font families of text: Latin letters, then Chinese ones if installed."""
    manager = font_manager.fontManager
    for path in set(font_manager.findSystemFonts()) - {entry.fname for entry in manager.ttflist}:
        with suppress(RuntimeError, OSError):  # matplotlib cannot read every font
            manager.addfont(path)  # installed after matplotlib built its list
    installed = set(manager.get_font_names())
    return [LATIN, *(name for name in CHINESE if name in installed)][:2]


def families_of(language: str) -> list[str]:
    """Return the font families of a language; raises SceneError if none is installed."""
    found = families()
    if language == "zh" and len(found) == 1:
        allowed = f"needs a font with Chinese characters: {HINT}"
        raise SceneError("--language", "zh", None, allowed)
    return found


def missing(text: str) -> set[str]:
    """Return the characters of a text for which no font of ours has a glyph."""
    files = (font_manager.findfont(family, fallback_to_default=False) for family in families())
    known = {letter for file in files for letter in FT2Font(str(file)).get_charmap()}
    return {letter for letter in text if not letter.isspace() and ord(letter) not in known}


def refuse_unknown_letters(texts: list[str]) -> None:
    """Raise SceneError if no font has a letter of the users' names."""
    if found := missing("".join(texts)):
        letters = " ".join(sorted(found)[:8])
        raise SceneError("figure", "", None, f"no font here has {letters}; {HINT}")
