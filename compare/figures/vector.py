"""A figure drawn once, as SVG and as PDF: most of the time goes into laying out ticks and text.

Both are drawn at 72 dots per inch. Texts are placed by the metrics of the SVG, which are those of
the PDF to a hundredth of a point, of formulas to a point.
"""

import io
from typing import Any, NamedTuple

from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.backends.backend_mixed import MixedModeRenderer
from matplotlib.backends.backend_pdf import PdfFile, RendererPdf
from matplotlib.backends.backend_svg import RendererSVG
from matplotlib.figure import Figure

POINTS = 72  # per inch


class Drawings(NamedTuple):
    """The text of an SVG and the bytes of a PDF."""

    svg: str
    pdf: bytes


def draw_both(figure: Figure, title: str) -> Drawings:
    """Return the drawings of a figure that is laid out already."""
    svg, pdf = io.StringIO(), io.BytesIO()
    files: Any = svg, pdf
    _Canvas(figure)
    figure.savefig(files, format="both", metadata={"Title": title})
    return Drawings(svg.getvalue(), pdf.getvalue())


class _Canvas(FigureCanvasBase):
    """The canvas of the format "both"."""

    fixed_dpi = POINTS

    def print_both(
        self,
        files: tuple[io.StringIO, io.BytesIO],
        *,
        metadata: dict[str, str],
        bbox_inches_restore: Any = None,
        **_: Any,
    ) -> None:
        """Write both files, without dates."""
        figure, dpi = self.figure, self.figure.dpi
        figure.dpi = POINTS
        (width, height), (svg, content) = figure.get_size_inches(), files
        pdf = PdfFile(content, metadata=metadata | {"CreationDate": None})
        try:
            pdf.newPage(width, height)
            both = _Renderer(
                RendererSVG(
                    POINTS * width,
                    POINTS * height,
                    svg,
                    image_dpi=dpi,
                    metadata=metadata | {"Date": None},
                ),
                RendererPdf(pdf, dpi, height, width),
            )
            found: Any = MixedModeRenderer(
                figure, width, height, dpi, both, bbox_inches_restore=bbox_inches_restore
            )
            figure.draw(found)
            found.finalize()
            pdf.finalize()
        finally:
            pdf.close()


class _Renderer:
    """Draws everything on an SVG and on a PDF; what is asked of a renderer, the SVG's answers."""

    def __init__(self, svg: RendererSVG, pdf: RendererPdf) -> None:
        self._svg, self._pdf = svg, pdf
        # The PDF's context has what both need.
        self.new_gc = pdf.new_gc

    def __getattr__(self, name: str) -> Any:
        return getattr(self._svg, name)

    def draw_text(self, gc: Any, x: float, y: float, *text: Any, **more: Any) -> None:
        """Draw a text at x and y from the upper left corner; a PDF counts from the lower one."""
        self._svg.draw_text(gc, x, y, *text, **more)
        self._pdf.draw_text(gc, x, self._svg.height - y, *text, **more)

    def finalize(self) -> None:
        """Complete both."""
        self._svg.finalize()
        self._pdf.finalize()


def _on_both(name: str) -> Any:
    def draw(self: _Renderer, *arguments: Any, **more: Any) -> None:
        getattr(self._svg, name)(*arguments, **more)
        getattr(self._pdf, name)(*arguments, **more)

    return draw


for _name in (
    "draw_path",
    "draw_markers",
    "draw_path_collection",
    "draw_quad_mesh",
    "draw_gouraud_triangles",
    "draw_image",
):
    setattr(_Renderer, _name, _on_both(_name))
