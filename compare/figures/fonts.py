"""Fonts of figures: DejaVu Sans, which comes with matplotlib, and an installed one for Chinese."""

from contextlib import suppress
from functools import cache
from pathlib import Path

from matplotlib import font_manager
from matplotlib.figure import Figure
from matplotlib.ft2font import FT2Font
from matplotlib.text import Text

from cases.errors import SceneError

LATIN = "DejaVu Sans"

#: Fonts with Chinese characters, in order of preference: those with TrueType outlines, which can
#: be embedded in every format, come first.
CHINESE = (
    "WenQuanYi Micro Hei",
    "WenQuanYi Zen Hei",
    "Microsoft YaHei",
    "SimHei",
    "Heiti SC",
    "Droid Sans Fallback",
    "Noto Sans CJK SC",
    "Noto Sans CJK JP",
    "Source Han Sans SC",
    "Noto Sans SC",
    "PingFang SC",
)
HINT = "apt install fonts-wqy-microhei (or fonts-noto-cjk, for SVG and PNG)"


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
    known = {letter for family in families() for letter in FT2Font(_file(family)).get_charmap()}
    return {letter for letter in text if not letter.isspace() and ord(letter) not in known}


def refuse_unknown_letters(texts: list[str]) -> None:
    """Raise SceneError if no font has a letter of the users' names."""
    if found := missing("".join(texts)):
        letters = " ".join(sorted(found)[:8])
        raise SceneError("figure", "", None, f"no font here has {letters}; {HINT}")


def refuse_postscript(figure: Figure) -> None:
    """Raise SceneError if a figure has Chinese characters and their font has PostScript outlines,
    which a PDF cannot embed as TrueType."""
    text = "".join(part.get_text() for part in figure.findobj(Text))
    latin = FT2Font(_file(LATIN)).get_charmap()
    is_latin = all(letter.isspace() or ord(letter) in latin for letter in text)
    if not is_latin and is_postscript(_file(family := families()[-1])):
        allowed = (
            f"cannot embed {family}, whose outlines are PostScript: write .svg or .png, or "
            "apt install fonts-wqy-microhei"
        )
        raise SceneError("figure", "", None, allowed)


def is_postscript(file: str) -> bool:
    """Return whether a font, or the first of a collection, has PostScript outlines."""
    content = Path(file).read_bytes()
    start = int.from_bytes(content[12:16], "big") if content[:4] == b"ttcf" else 0
    return content[start : start + 4] == b"OTTO"


def _file(family: str) -> str:
    return str(font_manager.findfont(family, fallback_to_default=False))
