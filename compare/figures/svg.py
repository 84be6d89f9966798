"""An SVG of matplotlib as a page can hold many of: its ids its own, and no more than is seen.

Of the paper's figures matplotlib writes 8 MB. Palettes for images take 1.6 MB of them away, two
decimals of a point 1.1, and steps between the points of a path 1.8: the page would be too large
without. All of it takes 0.7 s for a scene whose drawing takes 22.
"""

import base64
import io
import re

from PIL import Image

PLACE = re.compile(r"([ML]) (-?[\d.]+(?:e-?\d+)?) (-?[\d.]+(?:e-?\d+)?) ?\n?")


def compact(svg: str, name: str) -> str:
    """Return an SVG without what nobody sees; coordinates are to a hundredth of a point.

    name : what all ids begin with.
    """
    svg = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", svg, flags=re.DOTALL)
    svg = re.sub(r'(?<= d=")[^"]+', lambda match: _relative(match[0]), svg)
    svg = re.sub(r"(\d\.\d\d)\d+", r"\1", svg)
    svg = re.sub(r"image-rendering:[^;\"]*;?", "", svg)  # viewers smooth images unless told not to
    svg = re.sub(rf'\bid="(?!{name})', f'id="{name}-', svg)
    svg = re.sub(rf'(url\(#|href="#)(?!{name})', rf"\g<1>{name}-", svg)
    svg = re.sub(r"\s+\n|\n\s+", "\n", _without_repeated_ids(svg))
    return re.sub(r'(?<=data:image/png;base64,)[^"]+', lambda match: _with_palette(match[0]), svg)


def _relative(path: str) -> str:
    """Return a path of moves and lines by the steps between its rounded points; others as is."""
    points = PLACE.findall(path)
    if len(points) < 2 or PLACE.sub("", path).strip(" \nz"):
        return path
    found, at = [], (0, 0)
    for letter, *place in points:
        x, y = (round(100 * float(number)) for number in place)
        found.append(f"{letter.lower()}{(x - at[0]) / 100:g} {(y - at[1]) / 100:g}")
        at = x, y
    return "".join(found) + ("z" if path.rstrip().endswith("z") else "")


def _without_repeated_ids(svg: str) -> str:
    """Return an SVG in which only the first of several equal ids is left."""
    seen: set[str] = set()

    def once(match: re.Match) -> str:
        found = "" if match[1] in seen else match[0]
        seen.add(match[1])
        return found

    return re.sub(r' id="([^"]+)"', once, svg)


def _with_palette(png: str) -> str:
    """Return a PNG in base64 with a palette where it has few colours: a tenth of the bytes."""
    image = Image.open(io.BytesIO(base64.b64decode(png))).convert("RGB")
    if image.getcolors(256) is None:
        return png
    buffer = io.BytesIO()
    image.convert("P", palette=Image.Palette.ADAPTIVE, colors=256).save(
        buffer, "PNG", optimize=True
    )
    return base64.b64encode(buffer.getvalue()).decode("ascii")
