"""Words of figures for papers, in English and in Chinese."""

from typing import NamedTuple

from jointwave.compare.engines import names, solver
from jointwave.compare.figures.panels import Panel
from jointwave.compare.figures.units import UNITS, unit_for


class Words(NamedTuple):
    """The words of one language.

    solutions : the field of a solver's words with its label. quantities : by name. place : with
    {quantity} and {at}. static : with {value}, the static state not drawn. parts : of variants'
    names from jointwave; those of the user are not translated. comma : between place and variant.
    """

    solutions: str
    quantities: dict[str, str]
    place: str
    static: str
    time: str
    parts: dict[str, str]
    comma: str

    def solution(self, name: str) -> str:
        """Return the legend label of an engine or exact solution."""
        return getattr(solver(name).words, self.solutions) if name in names() else name

    def title(self, panel: Panel) -> str:
        """Return the title of a panel."""
        quantity = f"{self.quantities[panel.quantity]} {panel.place.component}".strip()
        at = panel.place.at
        where = f"y\u00a0=\u00a0{at[0]:g}" if len(at) == 1 else f"[{at[0]:g},\u00a0{at[1]:g}]"
        found = [self.place.format(quantity=quantity, at=where)]
        if rest := panel.at_rest:
            unit = unit_for(UNITS[panel.quantity], abs(rest))
            found.append(self.static.format(value=f"{rest / unit.size:.4g}\u00a0{unit.name}"))
        variant = [self.parts.get(part, part) for part in panel.variant.split(", ")]
        return self.comma.join([*found, *variant])


ENGLISH = Words(
    solutions="english",
    quantities={
        "stress": "stress",
        "shear": "shear stress",
        "traction": "traction",
        "velocity": "velocity",
        "rotation": "rotation",
    },
    place="{quantity} at {at}\u00a0m",
    static="minus the static {value}",
    time="time (ms)",
    parts={},
    comma=", ",
)

CHINESE = Words(
    solutions="chinese",
    quantities={
        "stress": "应力",
        "shear": "剪应力",
        "traction": "节理面应力",
        "velocity": "速度",
        "rotation": "转角",
    },
    place="{quantity}，{at}\u00a0m",
    static="减去静态值 {value}",
    time="时间 (ms)",
    parts={
        "undamped": "无阻尼",
        "soft layer": "含软弱层",
        "no soft layer": "无软弱层",
        "no tension": "不抗拉",
        "tension": "抗拉",
        "base scene": "原场景",
        "free start": "起端自由",
        "quiet start": "起端吸收",
        "matched start": "起端匹配",
        "fixed start": "起端固定",
        "free": "自由端",
        "quiet": "吸收端",
        "matched": "匹配端",
        "fixed": "固定端",
    },
    comma="，",
)

WORDS = {"en": ENGLISH, "zh": CHINESE}
