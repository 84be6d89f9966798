"""The scene vocabulary: everything that can be said about a jointed rock pillar and its load.

One pydantic model per TOML table. SI units throughout; y runs along the pillar from the loaded
end. The reference scene is that of Guo & Li (2002), Chin. J. Rock Mech. Eng. 21(8), 1124-1129.
"""

from typing import Annotated, Literal

from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from cases.history import History
from cases.values import NonNegative, Number, Pair, Positive, Table, contradiction

MOST_BLOCKS = 10_000_000  # about 0.4 kB a block: what one machine holds
MOST_SAMPLES = 10_000_000  # 80 MB for each section, point and energy term


class Pillar(Table):
    """A square rock pillar cut by joints into one row of equal blocks (section 3.1)."""

    length: Positive  #: m
    side: Positive  #: m, side of the square section
    block: Positive  #: m, block thickness d = joint spacing S

    @model_validator(mode="after")
    def _whole_blocks(self) -> "Pillar":
        count = self.length / self.block
        if not 1.5 < count <= MOST_BLOCKS:
            raise contradiction(
                "pillar.block", self.block, f"must give 2 to {MOST_BLOCKS:,} blocks, not {count:g}"
            )
        if abs(count - round(count)) > 1e-9 * count:
            raise contradiction(
                "pillar.block",
                self.block,
                f"must divide pillar.length = {self.length:g} into a whole number of blocks",
            )
        return self

    @property
    def block_count(self) -> int:
        """Number of blocks N = length / block."""
        return round(self.length / self.block)

    @property
    def area(self) -> float:
        """Section area A, m2."""
        return self.side**2


class Rock(Table):
    """The rock mass by its two wave speeds or by its two elastic constants, and the intact rock."""

    density: Positive  #: kg/m3
    p_speed: Positive | None = None  #: m/s, unbounded rock mass
    s_speed: Positive | None = None  #: m/s
    equivalent_modulus: Positive | None = None  #: Pa, E_eq of the rock mass
    equivalent_poisson: Annotated[float, Field(gt=-1, lt=0.5)] | None = None
    intact_modulus: Positive | None = None  #: Pa, E of the blocks; needed for the jointed continuum
    intact_poisson: Annotated[float, Field(gt=-1, lt=0.5)] = 0.25

    @model_validator(mode="after")
    def _one_pair(self) -> "Rock":
        pairs = ("p_speed", "s_speed"), ("equivalent_modulus", "equivalent_poisson")
        given = [[key for key in pair if getattr(self, key) is not None] for pair in pairs]
        if sorted(map(len, given)) != [0, 2]:
            raise contradiction(
                "rock",
                given[0] + given[1],
                "give exactly one pair: p_speed and s_speed, "
                "or equivalent_modulus and equivalent_poisson",
            )
        if self.p_speed and self.s_speed and self.p_speed**2 <= 4 / 3 * self.s_speed**2:
            raise contradiction(
                "rock.p_speed",
                self.p_speed,
                f"must exceed sqrt(4/3) times s_speed = {self.s_speed:g} (positive bulk modulus)",
            )
        return self


class JointLaw(Table):
    """What one joint can do. Keys that are absent leave their effect out of the computation."""

    normal_stiffness: Positive | None = None  #: Pa/m, the joint's own K_n; absent: from (4)
    tension: bool | None = None  #: False: a joint that would be pulled apart carries nothing (10)
    damping_ratio: NonNegative | None = None  #: zeta; dashpot c_n = 2 zeta sqrt(m k_n)
    friction_angle: Annotated[float, Field(ge=0, lt=90)] | None = None  #: degrees (3)
    cohesion: NonNegative | None = None  #: Pa (3)
    tensile_strength: Positive | None = None  #: Pa
    fracture_energy: Positive | None = None  #: J/m2
    contact_points: Annotated[int, Field(ge=1, le=16)] | None = None  #: n x n per face
    point_rule: Literal["midpoint", "gauss"] | None = None


class SoftLayer(JointLaw):
    """One joint under a law of its own; keys that are absent are those of [joints]."""

    y: Positive  #: m, on a joint
    spacing_stiffness: Positive | None = None  #: S K_n, Pa; absent: as stiff as the other joints
    thickness: Positive | None = None  #: m

    @model_validator(mode="after")
    def _one_stiffness(self) -> "SoftLayer":
        if self.spacing_stiffness is not None and self.normal_stiffness is not None:
            raise contradiction(
                "soft_layers.spacing_stiffness",
                self.spacing_stiffness,
                "give this or normal_stiffness, not both",
            )
        return self


class Load(Table):
    """The end stress F/A on the loaded end, compression positive."""

    shape: Literal["sine", "ricker", "step", "table"]
    amplitude: Number  #: Pa; a factor on the history's stresses for "table"
    period: Positive | None = None  #: s; for sine and ricker
    cycles: Annotated[int, Field(ge=1, le=1_000_000)] | None = None  #: of the sine, default 1
    file: str | None = None  #: two-column CSV, s and Pa; for "table"
    direction: Annotated[list[Number], Field(min_length=3, max_length=3)] = [0, 1, 0]
    at: Annotated[list[Number], Field(min_length=2, max_length=2)] = [0.0, 0.0]  #: m

    _history: History | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _keys_of_shape(self) -> "Load":
        needs = {"sine": {"period"}, "ricker": {"period"}, "step": set(), "table": {"file"}}
        takes = {"sine": {"cycles"}}
        needed = needs[self.shape]
        for key in ("period", "cycles", "file"):
            given = getattr(self, key) is not None
            if key in needed and not given:
                raise contradiction(
                    f"load.{key}", None, f"is needed for load.shape = '{self.shape}'"
                )
            if given and key not in needed | takes.get(self.shape, set()):
                raise contradiction(
                    f"load.{key}", getattr(self, key), f"has no meaning for shape '{self.shape}'"
                )
        if abs(sum(x * x for x in self.direction) - 1) > 1e-9:
            raise contradiction("load.direction", self.direction, "must be a unit vector")
        return self

    @model_validator(mode="after")
    def _read_history(self, info: ValidationInfo) -> "Load":
        if self.file is not None:
            folder = (info.context or {}).get("folder", ".")
            try:
                self._history = History.from_csv(folder, self.file)
            except ValueError as error:
                raise contradiction("load.file", self.file, str(error)) from None
        return self

    @property
    def history(self) -> History | None:
        """The recorded load history of shape "table", else None."""
        return self._history


class Ends(Table):
    """What holds the two ends: quiet is (9) on the end block, matched the same dashpot behind the
    end block's half-block spring."""

    start: Literal["free", "quiet", "matched", "fixed"] = "free"
    end: Literal["free", "quiet", "matched", "fixed"] = "free"


class Gravity(Table):
    """Body force, applied before the load."""

    direction: Annotated[list[Number], Field(min_length=3, max_length=3)]
    acceleration: NonNegative = 9.81  #: m/s2


class Prestress(Table):
    """Normal stress that the joints carry before the load."""

    normal: Number  #: Pa, compression positive


class Time(Table):
    """How long the scene lasts."""

    duration: Positive  #: s


class DemNumerics(Table):
    """How the rigid blocks are stepped; the default step is for accuracy, not only stability."""

    step_fraction: Positive = 0.05  #: of the critical step
    scheme: Literal["leapfrog"] = "leapfrog"
    allow_unstable: bool = False  #: go on with a step above the critical one


class ContinuumNumerics(Table):
    """How the deformable rock is discretised and stepped."""

    order: Annotated[int, Field(ge=1, le=4)] = 2  #: of the Gauss-Lobatto-Legendre elements
    #: absent: as many as the load needs, see continuum.mesh.elements_in_block
    elements_per_block: Annotated[int, Field(ge=1, le=1000)] | None = None
    scheme: Literal["auto", "explicit", "implicit"] = "auto"
    step_fraction: Positive = 0.2  #: of the critical step
    allow_unstable: bool = False


class Numerics(Table):
    """How, not what: every key has a default that is chosen for accuracy."""

    dem: DemNumerics = DemNumerics()
    continuum: ContinuumNumerics = ContinuumNumerics()


class Record(Table):
    """What is kept of a run."""

    stress: list[NonNegative] = []  #: m, sections
    velocity: list[NonNegative] = []  #: m, points
    interval: Positive | None = None  #: s; default a 200th of the period, or duration / 2000
    energy: bool = True  #: keep the energy ledger


class Scene(Table):
    """A whole scene: one pillar, its joints, its load, and what is recorded."""

    title: str
    source: str | None = None
    pillar: Pillar
    rock: Rock
    joints: JointLaw = JointLaw()
    soft_layers: list[SoftLayer] = []
    load: Load
    ends: Ends = Ends()
    gravity: Gravity | None = None
    prestress: Prestress | None = None
    time: Time
    numerics: Numerics = Numerics()
    record: Record
    expect: dict[Pair, Positive] = {}  #: bounds on the relative L2 misfit of pairs
    name: str = ""  #: of the variant; empty for the scene as it stands

    _where: str = PrivateAttr(default="")

    @model_validator(mode="after")
    def _fits_together(self) -> "Scene":
        self._check_layers()
        self._check_receivers()
        self._check_rock()
        self._check_time()
        return self

    @property
    def where(self) -> str:
        """The file and variant that the scene was read from, else its title: for messages."""
        return self._where or self.title

    @property
    def interval(self) -> float:
        """Time between samples, s."""
        return self.record.interval or (
            self.load.period / 200 if self.load.period else self.time.duration / 2000
        )

    def _check_layers(self) -> None:
        pillar, seen = self.pillar, set()
        for i, layer in enumerate(self.soft_layers):
            joint = layer.y / pillar.block
            if abs(joint - round(joint)) > 1e-6 or not 1 <= round(joint) < pillar.block_count:
                last = pillar.length - pillar.block
                raise contradiction(
                    f"soft_layers[{i}].y",
                    layer.y,
                    f"must be on a joint: a multiple of {pillar.block:g} "
                    f"from {pillar.block:g} to {last:g}",
                )
            if round(joint) in seen:
                raise contradiction(f"soft_layers[{i}].y", layer.y, "has a soft layer already")
            seen.add(round(joint))

    def _check_receivers(self) -> None:
        if not self.record.stress and not self.record.velocity:
            raise contradiction("record", None, "give at least one of record.stress and velocity")
        for key in ("stress", "velocity"):
            places = getattr(self.record, key)
            for y in places:
                if y > self.pillar.length:
                    raise contradiction(
                        f"record.{key}", y, f"must lie between 0 and {self.pillar.length:g} m"
                    )
            if len(set(places)) < len(places):
                raise contradiction(f"record.{key}", places, "must not name a place twice")

    def _check_rock(self) -> None:
        rock = self.rock
        if rock.equivalent_modulus and rock.intact_modulus:
            modulus = rock.equivalent_modulus
        elif rock.intact_modulus:
            from cases.calibrate import modulus_from_speeds

            assert rock.p_speed and rock.s_speed
            modulus, _ = modulus_from_speeds(rock.p_speed, rock.s_speed, rock.density)
        else:
            return
        if rock.intact_modulus <= modulus:
            raise contradiction(
                "rock.intact_modulus",
                rock.intact_modulus,
                f"must exceed the rock mass's equivalent modulus {modulus:.4g}",
            )

    def _check_time(self) -> None:
        if self.interval > self.time.duration:
            raise contradiction(
                "record.interval",
                self.interval,
                f"must not exceed time.duration = {self.time.duration:g}",
            )
        if self.time.duration / self.interval > MOST_SAMPLES:
            raise contradiction(
                "record.interval", self.interval, f"must give at most {MOST_SAMPLES:,} samples"
            )
