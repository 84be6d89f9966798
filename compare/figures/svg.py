"""An SVG of matplotlib as a page can hold many of: small, and with ids that no other one has."""

import base64
import io
import re

from PIL import Image

#: What matplotlib calls groups that nothing refers to.
UNNAMED = re.compile(
    r' id="(?:figure|subfigures|axes|patch|text|line2d|legend|[xy]tick|matplotlib\.axis'
    r'|FillBetween\w*|\w+Collection|QuadMesh)_\d+"'
)
PLACE = re.compile(r"([ML]) (-?[\d.]+(?:e-?\d+)?) (-?[\d.]+(?:e-?\d+)?) ?\n?")


def compact(svg: str, name: str) -> str:
    """Return an SVG without what nobody sees: coordinates are to a hundredth of a point.

    name : what all ids begin with.
    """
    svg = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", svg, flags=re.DOTALL)
    svg = _said_once(UNNAMED.sub("", svg))
    svg = re.sub(r'(?<= d=")[^"]+', lambda match: _relative(match[0]), svg)
    svg = re.sub(r"(\d\.\d\d)\d+", r"\1", svg)
    svg = re.sub(
        r"image-rendering:[^;\"]*;?", "", svg
    )  # viewers smooth an image unless told not to
    svg = re.sub(r">\s+<", ">\n<", svg)
    svg = re.sub(rf'\bid="(?!{name})', f'id="{name}-', svg)
    svg = _named_once(svg)
    svg = re.sub(rf'(url\(#|href="#)(?!{name})', rf"\g<1>{name}-", svg)
    return re.sub(r'(?<=data:image/png;base64,)[^"]+', lambda match: _with_palette(match[0]), svg)


def _named_once(svg: str) -> str:
    """Return an SVG in which only the first of several equal ids is left."""
    seen: set[str] = set()

    def once(match: re.Match) -> str:
        found = "" if match[1] in seen else match[0]
        seen.add(match[1])
        return found

    return re.sub(r' id="([^"]+)"', once, svg)


def _said_once(svg: str) -> str:
    """Return an SVG that names its font once, and does not repeat what its markers look like."""
    family = re.search(r" font-family: ([^;\"]*,[^;\"]*)", svg)
    if family:
        svg = svg.replace(family[0] + ";", "").replace(
            "<svg ", f'<svg font-family="{family[1]}" ', 1
        )
    looks = dict(re.findall(r'<path id="([^"]+)"[^>]*?style="([^"]*)"', svg))
    svg = re.sub(
        r'(<use xlink:href="#([^"]+)"[^>]*?) style="([^"]*)"',
        lambda use: use[1] if looks.get(use[2]) == use[3] else use[0],
        svg,
    )
    return re.sub(r' transform="rotate\(-?0 [^)]*\)"', "", svg)


def _relative(path: str) -> str:
    """Return a path of moves and lines by the steps between its points; any other as it is."""
    places = PLACE.findall(path)
    if len(places) < 2 or PLACE.sub("", path).strip(" \nz"):
        return " ".join(path.split())
    points = [(letter, round(100 * float(x)), round(100 * float(y))) for letter, x, y in places]
    found, at = [], (0, 0)
    for letter, x, y in points:
        step = _number(x - at[0]), _number(y - at[1])
        found.append(f"{letter.lower()}{step[0]}{'' if step[1].startswith('-') else ' '}{step[1]}")
        at = x, y
    return "".join(found) + ("z" if path.rstrip().endswith("z") else "")


def _number(hundredths: int) -> str:
    text = f"{hundredths / 100:.2f}".rstrip("0").rstrip(".")
    return re.sub(r"^(-?)0\.", r"\1.", text) if text != "-0" else "0"


def _with_palette(png: str) -> str:
    """Return a PNG in base64 with a palette, where it has so few colours: a tenth of the room."""
    image = Image.open(io.BytesIO(base64.b64decode(png))).convert("RGB")
    if image.getcolors(256) is None:
        return png
    buffer = io.BytesIO()
    image.convert("P", palette=Image.Palette.ADAPTIVE, colors=256).save(
        buffer, "PNG", optimize=True
    )
    return base64.b64encode(buffer.getvalue()).decode("ascii")
