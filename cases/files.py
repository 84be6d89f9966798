"""Read user-supplied text files; errors are one phrase.

The memory that a file needs is estimated from its size before it is read.
"""

import json
import re
import tomllib
from pathlib import Path
from typing import Any

from jointwave.cases.size import excess

#: Dotted keys of more than 64 parts: tomllib needs time cubic in their number.
LONG_KEY = re.compile(r"""(?<![\w"'-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){64}""")

#: Most bytes of memory per byte of a file: as text of four bytes a character with its copies, as
#: TOML with a table per `a=1`, as JSON with a list per `[],`.
TEXT, TOML, JSON = 12, 120, 40
SMALL = 10_000_000  # bytes: smaller files are always read


def read_bytes(path: Path, largest: int, times: int) -> bytes:
    """Return the content of a file of at most `largest` bytes.

    times : bytes of memory needed per byte of the file. Raises ValueError, in one phrase.
    """
    size = size_of(path)
    try:
        if size <= largest:
            if times * size > SMALL and (why := excess(times * size)):
                raise ValueError(why)
            with path.open("rb") as file:
                content = file.read(largest + 1)  # virtual files may report no size
            if len(content) <= largest:
                return content
    except OSError as error:
        raise ValueError(f"cannot be read: {error.strerror}") from None
    raise ValueError(f"is too large: at most {largest / 1e6:g} MB")


def size_of(path: Path) -> int:
    """Return the size of a regular file, bytes. Raises ValueError, in one phrase, for anything
    else, as reading a pipe would block."""
    try:
        if path.is_dir():
            raise ValueError("is a directory, must be a file")
        if path.exists() and not path.is_file():
            raise ValueError("is not a regular file")
        return path.stat().st_size
    except OSError as error:
        raise ValueError(f"cannot be read: {error.strerror}") from None


def read_text(path: Path, largest: int, times: int = TEXT) -> str:
    """Return the text of a file; see `read_bytes`."""
    content = read_bytes(path, largest, times)
    try:
        return content.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError:
        raise ValueError("is not UTF-8 text") from None


def read_toml(path: Path, largest: int) -> dict[str, Any]:
    """Return the tables of a TOML file of at most `largest` bytes. Raises ValueError."""
    text = read_text(path, largest, TOML)
    try:
        return parse_toml(text)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"is not valid TOML: {error}") from None


def read_json(path: Path, largest: int) -> Any:
    """Return the value of a JSON file of at most `largest` bytes. Raises ValueError."""
    text = read_text(path, largest, JSON)
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        raise ValueError("is not valid JSON") from None


def parse_toml(text: str) -> dict[str, Any]:
    """Return the tables of a TOML text. Raises ValueError or RecursionError."""
    if LONG_KEY.search(text):
        raise ValueError("a key has more than 64 parts")
    return tomllib.loads(text)


def beside(folder: str | Path, file: str, anywhere: bool) -> Path:
    """Return the path of a regular file named by a scene in `folder`.

    It must lie in that folder or below, with links resolved, unless it may be `anywhere` (named by
    the user). Raises ValueError, in one phrase.
    """
    path = Path(folder, file).absolute()
    try:
        inside = path.resolve().is_relative_to(Path(folder).resolve())
    except (OSError, RuntimeError, ValueError) as error:  # a loop of links, a NUL, too long
        raise ValueError(f"cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if not inside and not anywhere:
        raise ValueError("is outside the scene's folder, which only --set may name")
    size_of(path)
    return path


def is_number(cell: str) -> bool:
    """Return whether a table cell reads as a number."""
    try:
        float(cell)
    except ValueError:
        return False
    return True
