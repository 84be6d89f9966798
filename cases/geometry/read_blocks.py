"""Read the user's blocks from VTU, gmsh, COMPAS and OBJ files."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from jointwave.cases.files import read_bytes, read_json, read_text
from jointwave.cases.gmsh_file import (
    FROM_GMSH,
    KINDS,
    MeshError,
    cells_of_type,
    one_line,
    read_file,
    read_tagged,
)

LARGEST = 500_000_000  # bytes, of a file
FLAT = 1e-9  # tolerated range of z in a plane model, over the extent
JOINT, ROCK = "joint", "rock"
#: Faces of VTU and gmsh cells by meshio's names; polyhedra list their faces in the file.
FACES = {
    kind: [[int(corner) for corner in face] for face in faces.split()]
    for kind, faces in {
        "tetra": "021 013 123 203",
        "pyramid": "0321 014 124 234 304",
        "wedge": "021 345 0143 1254 2035",
        "hexahedron": "0321 4567 0154 1265 2376 3047",
    }.items()
}
POLYGONS = ("triangle", "quad", "polygon")
MESHIO = {kind: name for name, kind in KINDS.items()}

Loop = list[int]
Part = list[Loop]


class Given(NamedTuple):
    """The blocks of a file.

    x : float array [v, d], m; two columns if all z are equal.
    blocks : the parts of each block. A part is a list of polygons of vertices: one in the plane,
        the bounding faces in space, all counter-clockwise as seen from outside, or all clockwise.
    names : of the blocks, for messages.
    joints : facets as vertices, for each group "joint NAME" in lower case; None without groups.
    """

    x: np.ndarray
    blocks: list[list[Part]]
    names: list[str]
    joints: dict[str, list[Loop]] | None


def read_blocks(path: Path) -> Given:
    """Return the blocks of a file. Raises MeshError, in one phrase, if it has none."""
    readers = {".vtu": _vtu, ".msh": _gmsh, ".json": _compas, ".obj": _obj}
    if path.suffix.lower() not in readers:
        raise MeshError(f"must be a file of blocks: {', '.join(readers)}")
    try:
        given = readers[path.suffix.lower()](path)
    except MeshError:
        raise
    except Exception as error:  # a broken file raises errors of any kind
        raise MeshError(f"cannot be read as {path.suffix.lower()}: {one_line(error)}") from None
    if not given.blocks:
        raise MeshError("has no blocks")
    used = np.unique([v for block in given.blocks for part in block for loop in part for v in loop])
    if used[0] < 0 or used[-1] >= len(given.x) or not np.isfinite(given.x[used]).all():
        raise MeshError("has a block with a corner that is no vertex of the file")
    extent = np.ptp(given.x[used], axis=0)
    if extent[2] > FLAT * extent.max():
        return given
    blocks = [[[loop] for part in block for loop in part] for block in given.blocks]
    if len(blocks) == 1 and path.suffix.lower() in (".json", ".obj"):
        blocks = [[face] for face in blocks[0]]
        given = given._replace(names=[f"face {k}" for k in range(len(blocks))])
    return given._replace(x=given.x[:, :2], blocks=blocks)


def read_cells(path: Path) -> Given:
    """Return the cells of one kind in a gmsh file's groups "rock..." as blocks. Raises
    MeshError."""
    tagged = read_tagged(path)
    cells = tagged.cells[:, FROM_GMSH[tagged.kind]]  # the permutation is its own inverse
    parts = _parts(MESHIO[tagged.kind], cells)
    found = {name: one for name, one in tagged.facets.items() if name.startswith(JOINT)}
    joints = {_plain(name): one.tolist() for name, one in found.items()}
    dim = 2 if MESHIO[tagged.kind] in POLYGONS else 3
    names = [f"cell {k}" for k in range(len(cells))]
    return Given(tagged.x[:, :dim], [[part] for part in parts], names, joints)


def _plain(name: str) -> str:
    """Return the NAME of a group "joint NAME" in lower case."""
    return name.strip().lower()[len(JOINT) :].strip(" _-:")


def _vtu(path: Path) -> Given:
    mesh, said = read_file(path, "vtu")
    if "cannot handle" in said or read_bytes(path, LARGEST, 1).count(b"<Piece") > 1:
        raise MeshError("must be one piece of polygons or polyhedra, tetrahedra, hexahedra")
    kinds = [block for block in mesh.cells if block.dim > 1]
    if len({block.dim for block in kinds}) > 1:
        raise MeshError("has both polygons and polyhedra")
    parts = [part for one in kinds for part in _parts(one.type, one.data)]
    names = [f"cell {k}" for k in range(len(parts))]
    return Given(mesh.points, [[part] for part in parts], names, None)


def _parts(kind: str, cells: np.ndarray) -> list[Part]:
    """Return the polygons of each cell of a meshio cell type."""
    if kind in POLYGONS:
        return [[cell] for cell in np.asarray(cells).tolist()]
    if kind.startswith("polyhedron"):
        return [[face.tolist() for face in faces] for faces in cells]
    if kind not in FACES:
        known = ", ".join([*POLYGONS, "polyhedron", *FACES])
        raise MeshError(f"has {kind} cells, must be of {known}")
    return [[[cell[k] for k in face] for face in FACES[kind]] for cell in cells.tolist()]


def _gmsh(path: Path) -> Given:
    """Return one block per physical surface or volume; one per elementary entity in groups
    "rock..." and in files without groups."""
    mesh, _ = read_file(path, "gmsh")
    dim = max((block.dim for block in mesh.cells), default=0)
    none = [np.zeros(len(block.data), np.int64) for block in mesh.cells]
    physical = mesh.cell_data.get("gmsh:physical", none)
    names = {tag: name for name, (tag, of) in mesh.field_data.items() if of == dim}
    kind, blocks = {2: "surface", 3: "volume"}.get(dim, ""), dict[str, list[Part]]()
    grouped = any(p.any() for b, p in zip(mesh.cells, physical, strict=True) if b.dim == dim)
    for block, groups, entities in zip(
        mesh.cells, physical, mesh.cell_data["gmsh:geometrical"], strict=True
    ):
        if block.dim != dim or dim < 2:
            continue
        for part, group, entity in zip(
            _parts(block.type, block.data), groups, entities, strict=True
        ):
            if grouped and not group:
                raise MeshError(f"has a cell of {kind} {entity} in no group")
            name = names.get(group, f"group {group}" if grouped else ROCK)
            key = f"{kind} {entity}" if name.lower().startswith(ROCK) else repr(name)
            blocks.setdefault(key, []).append(part)
    joints = {
        _plain(name): [
            facet
            for cell in ({2: ["line"], 3: ["triangle", "quad"]}[dim])
            for facet in cells_of_type(mesh, [name], cell).tolist()
        ]
        for name in mesh.field_data
        if name.strip().lower().startswith(JOINT)
    }
    return Given(mesh.points, list(blocks.values()), list(blocks), joints or None)


def _compas(path: Path) -> Given:
    """Return meshes and polyhedra in any COMPAS structure: assemblies, models or lists of them."""
    x: list[list[float]] = []
    objects: dict[str, list[Loop]] = {}
    for vertices, faces in _meshes(read_json(path, LARGEST)):
        number = {str(key): len(x) + k for k, key in enumerate(vertices)}
        x += vertices.values()
        if faces:
            name = f"block {len(objects)}"
            objects[name] = [[number[str(key)] for key in face] for face in faces]
    return _of_objects(x, objects)


def _of_objects(x: list[list[float]], objects: dict[str, list[Loop]]) -> Given:
    """Return blocks from the faces of each."""
    blocks = [[faces] for faces in objects.values()]
    return Given(np.reshape(x, (-1, 3)), blocks, list(objects), None)


def _meshes(node) -> Iterator[tuple[dict, list]]:
    """Yield the vertices' coordinates by key, and the faces as keys, of each mesh."""
    if isinstance(node, list):
        for one in node:
            yield from _meshes(one)
    elif isinstance(node, dict) and {"vertex", "face"} <= node.keys():
        places = {
            key: [one.get(axis, 0.0) for axis in "xyz"] for key, one in node["vertex"].items()
        }
        yield places, list(node["face"].values())
    elif isinstance(node, dict) and {"vertices", "faces"} <= node.keys():
        yield dict(enumerate(node["vertices"])), node["faces"]
    elif isinstance(node, dict):
        moved = node.get("transformation")
        if moved and not np.allclose(moved["data"]["matrix"], np.eye(4), atol=0, rtol=0):
            raise MeshError("has blocks with a transformation, must have them in place")
        for key, one in node.items():
            if key not in ("edge", "contacts", "interactions"):  # these hold no blocks
                yield from _meshes(one)


def _obj(path: Path) -> Given:
    """Return the faces of each object (o), or of each group (g) if there are no objects."""
    lines = [line.split() for line in read_text(path, LARGEST).replace("\\\n", " ").splitlines()]
    mark = "o" if any(words[:1] == ["o"] for words in lines) else "g"
    x: list[list[float]] = []
    objects: dict[str, list[Loop]] = {}
    name = "''"
    for words in lines:
        kind, *rest = words or [""]
        if kind == "v":
            x.append([float(word) for word in rest[:3]])
        elif kind == mark:
            name = repr(" ".join(rest))
        elif kind == "f":
            corners = [int(word.split("/")[0]) for word in rest]
            loop = [k - 1 if k > 0 else len(x) + k if k else -1 for k in corners]
            objects.setdefault(name, []).append(loop)
    return _of_objects(x, objects)
