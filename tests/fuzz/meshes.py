"""Meshes of gmsh that bad input is made of: a coarse pillar in every version and form."""

import tempfile
from pathlib import Path


def meshes() -> list[bytes]:
    """Return a pillar of three blocks of 0.4 x 0.5 m, in the plane and in space, versions 2.2 and
    4.1, text and binary."""
    from jointwave.continuum.mesh.session import gmsh_session

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
