"""What the tests of bad input share: targets that read it, under a bound on memory.

`make fuzz` sets FUZZ: so many times the inputs, others in each run.
"""

import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings

import targets
from jointwave import cases

#: How many times the inputs of a plain run.
FUZZ = int(os.environ.get("FUZZ", "1"))


@pytest.fixture(scope="session")
def gmsh_files(tmp_path_factory):
    """Return files of a pillar of three blocks of 0.4 x 0.5 m with its rock and joints as groups,
    in the plane and in space, of gmsh's versions 2.2 and 4.1, as text and binary."""
    from jointwave.continuum.mesh.session import gmsh_session

    file, found = tmp_path_factory.mktemp("gmsh") / "pillar.msh", []
    for dim in (2, 3):
        with gmsh_session() as gmsh:
            occ, z = gmsh.model.occ, -0.2 * (dim - 2)
            make, sizes = (
                (occ.addRectangle, (0.4, 0.5)) if dim == 2 else (occ.addBox, (0.4, 0.5, 0.4))
            )
            blocks = [(dim, make(-0.2, 0.5 * i, z, *sizes)) for i in range(3)]
            occ.fragment(blocks[:1], blocks[1:])
            occ.synchronize()
            groups = {"rock": gmsh.model.getEntities(dim), "joint": []}
            for y in (0.5, 1.0):
                box = (-1, y - 1e-3, -1, 1, y + 1e-3, 1)
                groups["joint"] += gmsh.model.getEntitiesInBoundingBox(*box, dim - 1)
            for name, entities in groups.items():
                size, tags = entities[0][0], [tag for _, tag in entities]
                gmsh.model.setPhysicalName(size, gmsh.model.addPhysicalGroup(size, tags), name)
            gmsh.option.setNumber("Mesh.MeshSizeMin", 0.5)
            gmsh.model.mesh.generate(dim)
            for version, binary in ((2.2, 0), (2.2, 1), (4.1, 0), (4.1, 1)):
                gmsh.option.setNumber("Mesh.MshFileVersion", version)
                gmsh.option.setNumber("Mesh.Binary", binary)
                gmsh.write(str(file))
                found.append(file.read_bytes())
    return found


@pytest.fixture
def meets(tmp_path, monkeypatch):
    """Return a function that lets a target meet so many inputs and asserts that some were read and
    some refused."""
    for load in Path(cases.__file__).parent.glob("*/*.csv"):
        (tmp_path / load.name).write_bytes(load.read_bytes())
    monkeypatch.setenv("JOINTWAVE_MEMORY", targets.MEMORY)

    def found(target, inputs, count):
        outcomes = set()

        @settings(
            max_examples=FUZZ * count,
            derandomize=FUZZ == 1,
            suppress_health_check=list(HealthCheck),
        )
        @given(inputs)
        def check(data):
            outcomes.add(targets.met(target, data, tmp_path))

        check()
        assert outcomes == {"read", "refused"}

    return found
