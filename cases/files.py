"""Reading the text files that a user names, with one phrase for whatever is wrong."""

from pathlib import Path


def read_text(path: Path, largest: int) -> str:
    """Return the text of a file of at most `largest` bytes.

    Raises ValueError, in one phrase. Only regular files are opened: a pipe would block.
    """
    try:
        if path.is_dir():
            raise ValueError("is a directory, must be a file")
        if path.exists() and not path.is_file():
            raise ValueError("is not a regular file")
        if path.stat().st_size > largest:
            raise ValueError(f"is too large, must hold at most {largest / 1e6:g} MB")
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise ValueError(f"cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ValueError("is not UTF-8 text") from None


def is_number(cell: str) -> bool:
    """Return whether a cell of a table reads as a number."""
    try:
        float(cell)
    except ValueError:
        return False
    return True
