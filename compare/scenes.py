"""Where scenes are found: a path, or the name of a shipped one."""

from pathlib import Path

import cases

SHIPPED = Path(cases.__file__).parent


def shipped() -> list[Path]:
    """Return the shipped scene files, in order."""
    return sorted(SHIPPED.glob("*/*.toml"))


def find(scene: str) -> Path:
    """Return the file of a scene given by path or by shipped name, `guo-li-2002/fig-03`."""
    path = Path(scene)
    if path.exists() or path.is_symlink():
        return path
    known = (SHIPPED / scene).with_suffix(".toml")
    return known if known.is_file() else path
