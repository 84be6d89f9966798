"""Reading the text files that a user names, with one phrase for whatever is wrong."""

import re
import tomllib
from pathlib import Path
from typing import Any

#: A key of so many parts: tomllib takes time with the third power of their number.
LONG_KEY = re.compile(r"""(?<![\w"'-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){64}""")


def read_text(path: Path, largest: int) -> str:
    """Return the text of a file of at most `largest` bytes.

    Raises ValueError, in one phrase. Only regular files are opened: a pipe would block.
    """
    try:
        if path.is_dir():
            raise ValueError("is a directory, must be a file")
        if path.exists() and not path.is_file():
            raise ValueError("is not a regular file")
        with path.open("rb") as file:
            content = file.read(largest + 1)  # what the system makes up may have no size
        if len(content) > largest:
            raise ValueError(f"is too large, must hold at most {largest / 1e6:g} MB")
        return content.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
    except OSError as error:
        raise ValueError(f"cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ValueError("is not UTF-8 text") from None


def read_toml(path: Path, largest: int) -> dict[str, Any]:
    """Return the tables of a TOML file of at most `largest` bytes; raises ValueError."""
    text = read_text(path, largest)
    try:
        return parse_toml(text)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"is not valid TOML: {error}") from None


def parse_toml(text: str) -> dict[str, Any]:
    """Return the tables of a TOML text; raises ValueError or RecursionError."""
    if LONG_KEY.search(text):
        raise ValueError("a key has more than 64 parts")
    return tomllib.loads(text)


def beside(folder: str | Path, file: str, anywhere: bool = False) -> Path:
    """Return the path of a file that a scene in `folder` names.

    It lies in that folder or below, whatever links are on the way, unless it may be `anywhere`:
    where the user names it. Raises ValueError, in one phrase.
    """
    path = Path(folder, file).absolute()
    try:
        inside = path.resolve().is_relative_to(Path(folder).resolve())
    except (OSError, RuntimeError, ValueError) as error:  # a loop of links, a NUL, too long
        raise ValueError(f"cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if not inside and not anywhere:
        raise ValueError("leaves the folder of the scene, which only --set may do")
    return path


def is_number(cell: str) -> bool:
    """Return whether a cell of a table reads as a number."""
    try:
        float(cell)
    except ValueError:
        return False
    return True
