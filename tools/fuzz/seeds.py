"""What the fuzzer starts from: the shipped files, a coarse mesh in every version, commands."""

import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]

COMMANDS = (
    "list",
    "list --json",
    "--version",
    "run guo-li-2002/fig-03 --engine dem --engine exact --model lattice --out out --json",
    "run guo-li-2002/fig-03 --set pillar.length=40.0 --variant zeta",
    "explain beyond/spall --set record.stress=[1.0,2.0]",
    "compare guo-li-2002/fig-05 --with load.csv:stress@20 --align --no-spectral",
    "effects beyond/torsion --variant",
    "plan guo-li-2002/fig-02 --misfit 0.01 --seconds 3",
    "study series --workers 2 --out out",
    "report --out page",
    "run rock-mass/tunnel --engine continuum --model jointed --sweep joint_sets.0.dip=10:30:3",
    "compare rock-mass/one-joint --with load.csv:velocity_x@24,12",
    "plan rock-mass/blast-hole --set numerics.dem.block=0.5 --misfit 0.2",
)


def seeds(target: str) -> list[bytes]:
    """Return the inputs that a target's corpus begins with."""
    if target == "command":
        return [line.replace(" ", "\n").encode() for line in COMMANDS]
    if target == "mesh":
        return meshes()
    if target == "curve":
        own = b"time [ms], stress@20 [MPa], -velocity_x@20.25 [mm/s]\n0,0,1\n1,2,3\n2,1e-3,0\n"
        return [own, own.replace(b",", b";"), *seeds("load"), result()]
    where = {
        "scene": "cases/*/*.toml",
        "load": "cases/*/*.csv",
        "study": "compare/experiments/study/shipped/*.toml",
    }
    return [path.read_bytes() for path in sorted(ROOT.glob(where[target]))]


def result() -> bytes:
    """Return a short result as NetCDF."""
    import cases
    from compare.exact.bar import series
    from compare.runs.output import fields_of, write_fields

    changes = {"variants": [], "time.duration": 2e-3}
    scene = cases.load_variant(ROOT / "cases" / "guo-li-2002" / "fig-03.toml", "", changes)
    with tempfile.TemporaryDirectory() as folder:
        answer = fields_of(series.solve(scene, 2))
        return write_fields(Path(folder, "series.nc"), answer).read_bytes()


def meshes() -> list[bytes]:
    """Return a pillar of three blocks of 0.4 x 0.5 m, in the plane and in space, versions 2.2 and
    4.1, text and binary."""
    from continuum.mesh.session import gmsh_session

    found = []
    for dim in (2, 3):
        with gmsh_session() as gmsh, tempfile.TemporaryDirectory() as folder:
            _pillar(gmsh, dim)
            for version, binary in ((2.2, 0), (2.2, 1), (4.1, 0), (4.1, 1)):
                gmsh.option.setNumber("Mesh.MshFileVersion", version)
                gmsh.option.setNumber("Mesh.Binary", binary)
                gmsh.write(f"{folder}/pillar.msh")
                found.append(Path(folder, "pillar.msh").read_bytes())
    return found


def _pillar(gmsh, dim: int) -> None:
    """Make a coarse pillar with its rock and joints as groups."""
    occ = gmsh.model.occ
    blocks = [
        occ.addRectangle(-0.2, 0.5 * i, 0.0, 0.4, 0.5)
        if dim == 2
        else occ.addBox(-0.2, 0.5 * i, -0.2, 0.4, 0.5, 0.4)
        for i in range(3)
    ]
    occ.fragment([(dim, blocks[0])], [(dim, tag) for tag in blocks[1:]])
    occ.synchronize()
    joints = [tag for _, tag in gmsh.model.getEntities(dim - 1) if _is_joint(gmsh, dim - 1, tag)]
    rock = [tag for _, tag in gmsh.model.getEntities(dim)]
    for size, tags, name in ((dim, rock, "rock"), (dim - 1, joints, "joint")):
        gmsh.model.setPhysicalName(size, gmsh.model.addPhysicalGroup(size, tags), name)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 0.5)
    gmsh.model.mesh.generate(dim)


def _is_joint(gmsh, dim: int, tag: int) -> bool:
    _, low, _, _, high, _ = gmsh.model.getBoundingBox(dim, tag)
    return high - low < 1e-3 and 0.4 < low < 1.1
