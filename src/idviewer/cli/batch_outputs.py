"""The results of one shape of a collection: numbers for its JSON file, and files beside it."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, Any

from idviewer.cli import commands, point_distances

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from idviewer.core import Barycentroid, InteriorDistance, Shape

    Floats = NDArray[np.float64]

NODES_AT_ONCE = 8192
"""Of a grid; so many are embedded in one call."""

MAX_GRID_SIDE = 512
"""Nodes."""

VERTEX_HEADER = b"vertex"
"""First line of a file of landmarks that are vertices."""

LARGEST_MATRIX_VERTICES = 2000
"""Vertices of a shape up to which all distances between them are looked at where there is no embedding."""


def measures(solver: InteriorDistance, centre: Barycentroid) -> dict[str, Any]:
    """What every shape's result holds: distance, eigenvalues, barycentroid, and how far off they may be."""
    from idviewer.core import parameters_of

    told = commands.distance_as_json(solver)
    own = (*parameters_of(type(solver.boundary.distance)), "coordinates")
    distance = {"name": told.pop("distance"), **{name: told.pop(name) for name in own if name in told}}
    result: dict[str, Any] = {"distance": distance, **told}
    errors: dict[str, Any] = {
        "barycentroid_position": solver.boundary.position_accuracy * solver.shape.diagonal,
    }
    if solver.boundary.distance.spectral:
        spectrum = solver.spectrum
        result |= {
            "lambda_2": float(spectrum.values[0]),
            "modes": len(spectrum.values),
            "eigenvalues": spectrum.values.tolist(),
        }
        errors["eigenvalues"] = spectrum.residual
    return {
        **result,
        "barycentroid": centre.point.tolist(),
        "potential": centre.potential,
        "largest_distance": _largest_distance(solver),
        "errors": errors,
    }


def _largest_distance(solver: InteriorDistance) -> float | None:
    """The largest distance between vertices; None where too many have no embedding."""
    from idviewer.core.interior import extent

    boundary = solver.boundary
    if boundary.form is None:
        return extent(boundary.embedding)
    if len(boundary.shape.vertices) > LARGEST_MATRIX_VERTICES:
        return None
    return float(boundary.squares().max()) ** 0.5


def descriptors(solver: InteriorDistance) -> dict[str, Any]:
    """The shape's descriptors."""
    from idviewer.core.interior import shape_descriptors

    return shape_descriptors(solver).as_dict()


def write_landmarks(path: Path, solver: InteriorDistance, points_file: Path) -> dict[str, Any]:
    """Write the matrix of distances between the points of a file; empty cells where one lies outside."""
    import numpy as np

    from idviewer.core.interior import place_points
    from idviewer.core.io import atomic_path

    names, points, rounding = _landmarks_in(points_file, solver.boundary.full_shape)
    placed = place_points(solver.coordinates, points, rounding)
    inside = np.asarray(np.isfinite(placed.points).all(axis=1))
    inside[placed.outside] = False
    rows = np.full((len(points), len(points)), np.nan)
    for place in np.flatnonzero(inside):
        rows[place, inside] = solver.field(placed.points[place], placed.points[inside])
    rows = 0.5 * (rows + rows.T)
    np.fill_diagonal(rows, np.where(inside, 0.0, np.nan))
    with atomic_path(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["landmark", *names])
        for name, row in zip(names, rows.tolist(), strict=True):
            writer.writerow([name, *("" if value != value else repr(value) for value in row)])
    return {
        "points": len(points),
        "outside": [names[number] for number in np.flatnonzero(~inside)],
        "moved_onto_the_surface": len(placed.moved),
        "farthest_moved": placed.farthest,
    }


def _landmarks_in(path: Path, shape: Shape) -> tuple[list[str], Floats, Floats]:
    """Names of landmarks, their places (p, dimension), and how far off each may be by how it is written."""
    import numpy as np

    data = path.read_bytes()
    if data.lstrip(b'\xef\xbb\xbf \t\r\n"').lower().startswith(VERTEX_HEADER):
        return _vertices_in(data, path, shape)
    table = point_distances.table_of(data, str(path), shape.dimension)
    others = sorted(set(range(len(table.rows[0]))) - set(table.columns))
    names = [row[others[0]] if others else str(place) for place, row in enumerate(table.rows, 1)]
    return names, table.points, np.asarray(table.rounding)


def _vertices_in(data: bytes, path: Path, shape: Shape) -> tuple[list[str], Floats, Floats]:
    """The same of a table whose rows are vertices of the shape's file; NaN for those that were dropped."""
    import numpy as np

    from idviewer.core import Mesh, Polygon

    assert isinstance(shape, Mesh | Polygon)
    became = shape.file_vertices
    points = np.append(shape.vertices, np.full((1, shape.dimension), np.nan), axis=0)
    names: list[str] = []
    for place, line in enumerate(data.decode("utf-8-sig", errors="replace").splitlines(), 1):
        text = line.strip().strip('"')
        if not text or (not names and text.lower().encode() == VERTEX_HEADER):
            continue
        if not (text.isascii() and text.isdigit() and int(text) < len(became)):
            raise ValueError(
                f"{path}, line {place}: {text[:60]!r} is no vertex of the shape's file, "
                f"where they are 0 to {len(became) - 1}"
            )
        names.append(text)
    if not names:
        raise ValueError(f"{path}: there are no vertices in it; write one number a line")
    return names, points[became[list(map(int, names))]], np.zeros(len(names))


def write_fields(path: Path, solver: InteriorDistance, centre: Floats) -> dict[str, Any]:
    """Write the boundary with the potential and the distance from the barycentroid at its vertices.

    Vertices are those of the file, in its order, unless some were dropped; in any case an array numbers them.
    """
    import numpy as np

    from idviewer.core import Mesh
    from idviewer.view.vtk_writers import write_vtp

    shape = solver.boundary.full_shape
    potential, distances = _at_vertices(solver, centre)
    vertices, facets = shape.vertices, shape.facets
    numbers = np.arange(len(vertices))
    in_order = True
    if isinstance(shape, Mesh):
        became, origins = shape.numbering.became, shape.numbering.origins
        in_order = bool((became >= 0).all() and (origins >= 0).all())
        numbers = np.arange(len(became)) if in_order else origins
        if in_order:
            vertices, facets = vertices[became], origins[facets]
            potential, distances = potential[became], distances[became]
    fields = {"potential": potential, "distance_from_barycentroid": distances, "file_vertex": numbers}
    write_vtp(path, vertices, facets, fields)
    return {"vertices": len(vertices), "in_file_order": in_order}


def _at_vertices(solver: InteriorDistance, centre: Floats) -> tuple[Floats, Floats]:
    """Potential and distance from the barycentroid at the vertices of the shape that was given."""
    import numpy as np

    vertices, boundary = solver.boundary.full_shape.vertices, solver.boundary
    # Where the boundary was refined, its first vertices are those.
    if boundary.form is not None or not np.array_equal(boundary.shape.vertices[: len(vertices)], vertices):
        return solver.potential(vertices), solver.field(centre, vertices)
    embedded = boundary.embedding[: len(vertices)]
    return (
        np.linalg.norm(embedded - boundary.centre, axis=1),
        np.linalg.norm(embedded - solver.embed(centre[None])[0], axis=1),
    )


def write_grid(path: Path, solver: InteriorDistance, centre: Floats, side: int) -> dict[str, Any]:
    """Write both on a regular grid with so many nodes along the longest side; NaN outside."""
    import numpy as np

    from idviewer.core.io import atomic_path
    from idviewer.view.vtk_writers import write_vti

    lower, upper = solver.boundary.full_shape.bounds
    spacing = float((upper - lower).max()) / (side - 1)
    counts = tuple(int(count) for count in np.ceil((upper - lower) / spacing - 1e-9) + 1)
    # In the middle of the box, whose shorter sides are no multiples of the spacing.
    origin = 0.5 * (lower + upper) - 0.5 * spacing * (np.array(counts) - 1)
    potential, distances = np.empty(counts).ravel(), np.empty(counts).ravel()
    for start in range(0, len(potential), NODES_AT_ONCE):
        numbers = np.arange(start, min(start + NODES_AT_ONCE, len(potential)))
        nodes = origin + spacing * np.stack(np.unravel_index(numbers, counts), axis=1)
        if solver.boundary.form is None:
            embedded = solver.embed(np.concatenate([nodes, centre[None]]))
            potential[numbers] = np.linalg.norm(embedded[:-1] - solver.boundary.centre, axis=1)
            distances[numbers] = np.linalg.norm(embedded[:-1] - embedded[-1], axis=1)
        else:
            potential[numbers], distances[numbers] = solver.potential(nodes), solver.field(centre, nodes)
    fields = {"potential": potential.reshape(counts), "distance_from_barycentroid": distances.reshape(counts)}
    if path.suffix == ".vti":
        write_vti(path, origin, spacing, counts, fields)
    else:
        with atomic_path(path) as part, part.open("wb") as file:
            np.savez_compressed(file, **{"origin": origin, "spacing": np.array(spacing), **fields})
    inside = int(np.isfinite(potential).sum())
    return {"origin": origin.tolist(), "spacing": spacing, "nodes": list(counts), "inside": inside}
