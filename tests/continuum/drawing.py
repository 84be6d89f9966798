"""Pillars in gmsh files, blocks between joints of any slope, their vertices once or twice; and
squares of rock with lines of joints."""

from itertools import pairwise

import numpy as np

from jointwave.continuum.mesh.session import gmsh_session

DIMENSION = {"quadrilateral": 2, "triangle": 2, "hexahedron": 3, "tetrahedron": 3}


def drawn(
    path,
    kind,
    joints=((0.5, 0.5), (1.0, 1.0)),
    doubled=False,
    length=1.5,
    side=0.4,
    elements=2,
    order=1,
    version=4.1,
    binary=0,
    names=None,
    untagged=(),
    ends=True,
    save_all=0,
):
    """Let gmsh draw blocks between joints, each given by its y at x = -side/2 and at x = side/2;
    return the path of the file.

    doubled : neighbours share no vertex. names : of the joints' groups; untagged : numbers of the
    joints of which only the lower side is tagged."""
    with gmsh_session() as gmsh:
        dim, model = DIMENSION[kind], gmsh.model
        cuts = [(0.0, 0.0), *joints, (length, length)]
        for pair in pairwise(cuts):
            _block(model.geo, dim, side, *pair)
        if not doubled:
            model.geo.removeAllDuplicates()
        model.geo.synchronize()
        _transfinite(model, dim, elements, recombine=kind in ("quadrilateral", "hexahedron"))
        faces: dict[tuple, list[int]] = {}
        for tag, across in _faces_across(model, dim, side):
            faces.setdefault(across, []).append(tag)
        names = names or [f"joint {k}" for k in range(len(joints))]
        groups: dict[str, list[int]] = {}
        for k, (cut, name) in enumerate(zip(joints, names, strict=True)):
            tags = faces[tuple(np.round(cut, 6))]
            groups.setdefault(name, []).extend(tags[:1] if k in untagged else tags)
        if ends:
            groups |= {"start": faces[0.0, 0.0], "end": faces[length, length]}
        for name, tags in groups.items():
            grouped(gmsh, dim - 1, name, tags)
        grouped(gmsh, dim, "Rock mass", [tag for _, tag in model.getEntities(dim)])
        model.mesh.generate(dim)
        model.mesh.setOrder(order)
        how = {"MshFileVersion": version, "Binary": binary, "SaveAll": save_all}
        for key, value in how.items():
            gmsh.option.setNumber(f"Mesh.{key}", value)
        gmsh.write(str(path))
    return path


def _block(geo, dim, side, lower, upper):
    """Add one block between two joints."""
    half = side / 2
    ring = [(-half, lower[0]), (half, lower[1]), (half, upper[1]), (-half, upper[0])]
    points = [geo.addPoint(x, y, -half * (dim - 2)) for x, y in ring]
    lines = [geo.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
    face = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    if dim == 3:
        geo.extrude([(2, face)], 0, 0, side)


def _transfinite(model, dim, elements, recombine):
    """Mesh every curve alike and every face by the same pattern; simplices fill them freely."""
    for _, curve in model.getEntities(1):
        model.mesh.setTransfiniteCurve(curve, elements + 1)
    for _, face in model.getEntities(2):
        model.mesh.setTransfiniteSurface(face, "Left", _corners_of(model, face) if dim == 3 else [])
        if recombine:
            model.mesh.setRecombine(2, face)
    if recombine:
        for _, volume in model.getEntities(3):
            model.mesh.setTransfiniteVolume(volume)


def _points_of(model, dim, tag):
    """Return the numbers of the points around a face or curve, and their places [n, 3]."""
    points = [one for _, one in model.getBoundary([(dim, tag)], recursive=True)]
    return points, np.array([model.getValue(0, one, []) for one in points])


def _corners_of(model, face):
    """Return the corner points of a face, around it from the same corner for opposite faces."""
    points, x = _points_of(model, 2, face)
    flat = np.delete(x - x.mean(axis=0), np.ptp(x, axis=0).argmin(), axis=1)
    return [points[i] for i in np.argsort(np.arctan2(flat[:, 1], flat[:, 0]))]


def _faces_across(model, dim, side):
    """Return each face or curve that spans the section, with its y at both ends of x."""
    for d, tag in model.getEntities(dim - 1):
        _, x = _points_of(model, d, tag)
        spans = np.ptp(x, axis=0)
        if np.isclose(spans[0], side) and (dim == 2 or np.isclose(spans[2], side)):
            ends = (x[np.isclose(x[:, 0], s), 1][0] for s in (-side / 2, side / 2))
            yield tag, tuple(float(np.round(y, 6)) for y in ends)


def grouped(gmsh, dim, name, tags):
    """Return the number of a new group of this name."""
    group = gmsh.model.addPhysicalGroup(dim, tags)
    gmsh.model.setPhysicalName(dim, group, name)
    return group


def crossed(path, joints, low, high, hole=None, size=0.5, version=4.1, quads=False, crack=False):
    """Let gmsh mesh a square from low to high with lines of joints in it, given by their points and
    by name, and with a round hole of 1 m around a place."""
    with gmsh_session() as gmsh:
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        occ = gmsh.model.occ
        square, lines = [(2, occ.addRectangle(low, low, 0, high - low, high - low))], {}
        if hole is not None:
            square, _ = occ.cut(square, [(2, occ.addDisk(*hole, 0, 1.0, 1.0))])
        tools = []
        for name, points in joints.items():
            ends = [occ.addPoint(x, y, 0) for x, y in points]
            own = [(1, occ.addLine(a, b)) for a, b in pairwise(ends)]
            lines[name] = range(len(tools), len(tools) + len(own))
            tools += own
        _, children = occ.fragment(square, tools)
        occ.synchronize()
        grouped(gmsh, 2, "rock", [tag for dim, tag in gmsh.model.getEntities(2)])
        for name, own in lines.items():
            tags = [tag for k in own for _, tag in children[len(square) + k]]
            group = grouped(gmsh, 1, name, tags)
        if quads:
            gmsh.option.setNumber("Mesh.RecombineAll", 1)
            gmsh.option.setNumber("Mesh.SubdivisionAlgorithm", 1)
        gmsh.model.mesh.generate(2)
        if crack:
            gmsh.plugin.setNumber("Crack", "Dimension", 1)
            gmsh.plugin.setNumber("Crack", "PhysicalGroup", group)
            gmsh.plugin.run("Crack")
        gmsh.write(str(path))
