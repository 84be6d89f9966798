"""Numbers as the page holds them: smooth curves as second differences, in a fifth of their room.

A packed thing is gzipped bytes: the length of a header in four bytes, little end first, the header
as JSON, then numbers. `n` of them at `at` are four planes of bytes, the least first; each is a
difference of `order`, its sign in its last bit, in steps of `step`, or of the logarithm's where
`log` stands. The script has the other half.
"""

from __future__ import annotations

import gzip
import json
from base64 import b64decode
from typing import Any

import numpy as np
import pandas as pd

RESOLUTION = 1e-6  # of the largest value of a column
DRAWN = 1e-5  # of the largest value of a curve on the screen
FLAT = 1e-3  # the least over the largest of numbers of few decades
COLOURED = 2e-4  # of the largest value of an image
LEVELS = 4000  # values that a column may repeat to be kept as a list of them
UNSAFE = set(',"\n\r')  # would need quotes in a CSV file


class _Body:
    """Bytes that numbers are added to."""

    def __init__(self) -> None:
        self.parts: list[bytes] = []
        self.size = 0

    def add(self, whole: np.ndarray) -> dict[str, int]:
        """Add whole numbers below 2^28; return where they are."""
        differences = [np.diff(whole, n=k, prepend=[0] * k) for k in range(3)]
        order = int(np.argmin([np.log2(1 + np.abs(d)).sum() for d in differences]))
        signed = differences[order].astype(np.int64)
        codes = np.where(signed < 0, -2 * signed - 1, 2 * signed).astype("<u4")
        planes = np.ascontiguousarray(codes.view(np.uint8).reshape(-1, 4).T)
        at, self.size = self.size, self.size + planes.size
        self.parts.append(planes.tobytes())
        return {"at": at, "n": len(whole), "order": order}

    def under(self, header: dict[str, Any]) -> bytes:
        """Return everything, gzipped."""
        text = json.dumps(header, separators=(",", ":"), allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        whole = [len(text).to_bytes(4, "little"), text, *self.parts]
        return gzip.compress(b"".join(whole), mtime=0)


def pack_table(table: pd.DataFrame) -> bytes | None:
    """Return a table, its numbers to a millionth of the largest of their column.

    None where it has text that needs quotes, or infinite numbers.
    """
    body, columns = _Body(), []
    for name in table:
        column = _column(table[name], body)
        if column is None or UNSAFE & set(str(name)):
            return None
        columns.append({"name": str(name), **column})
    return body.under({"rows": len(table), "columns": columns})


def _column(values: pd.Series, body: _Body) -> dict[str, Any] | None:
    codes, levels = pd.factorize(values)
    if not pd.api.types.is_numeric_dtype(values) or values.dtype == bool:
        texts = [str(level) for level in levels]
        return None if UNSAFE & set("".join(texts)) else {"levels": texts, **body.add(codes)}
    if np.isinf(values).any():
        return None
    if len(levels) <= min(LEVELS, len(values) // 4):
        return {"levels": [float(f"{x:.9g}") for x in levels], **body.add(codes)}
    numbers = values.to_numpy(dtype=float)
    if np.isfinite(numbers).all() and _is_even(numbers):
        return {"first": float(numbers[0]), "last": float(numbers[-1])}
    return _quantised(numbers, RESOLUTION, body)


def _is_even(numbers: np.ndarray) -> bool:
    if len(numbers) < 3:
        return False
    even = np.linspace(numbers[0], numbers[-1], len(numbers))
    return bool(np.abs(numbers - even).max() <= 1e-6 * abs(even[1] - even[0]))


def _quantised(numbers: np.ndarray, resolution: float, body: _Body) -> dict[str, Any]:
    """Return where numbers are, to a part of the largest of them.

    Positive ones of many decades are kept to a part of each, by their logarithm. `gaps` are the
    indices of what is no number, `zeros` those of zeros that have no logarithm.
    """
    known = np.isfinite(numbers)
    sizes = np.abs(numbers[known])
    largest, zeros = float(sizes.max(initial=0.0)), np.flatnonzero(numbers == 0)
    found: dict[str, Any] = {} if known.all() else {"gaps": np.flatnonzero(~known).tolist()}
    least = float(sizes[sizes > 0].min(initial=np.inf))
    if (numbers[known] >= 0).all() and least < FLAT * largest and len(zeros) <= len(numbers) // 8:
        found |= {"log": True, "zeros": zeros.tolist()}
        numbers = np.log(np.where(known & (numbers > 0), numbers, least))
        step = 5 * resolution
    else:
        numbers = np.where(known, numbers, 0.0)
        step = resolution * largest or 1.0
    return {"step": step, **found, **body.add(np.rint(numbers / step).astype(np.int64))}


def pack_plot(text: str) -> bytes:
    """Return a figure for plotly.js, of which typed arrays are packed."""
    body = _Body()
    return body.under(_without_arrays(json.loads(text), body))


def _without_arrays(part: Any, body: _Body) -> Any:
    if isinstance(part, list):
        return [_without_arrays(one, body) for one in part]
    if not isinstance(part, dict):
        return part
    if "bdata" not in part:
        return {key: _without_arrays(one, body) for key, one in part.items()}
    numbers = np.frombuffer(b64decode(part["bdata"]), f"<{part['dtype']}").astype(float)
    _, *width = map(int, part.get("shape", "0").split(","))
    packed = _quantised(numbers, COLOURED if width else DRAWN, body)
    return {"packed": packed | ({"width": width[0]} if width else {})}
