"""Commands of the command line, on parsed arguments. Heavy modules are imported where they are used."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from idviewer.cli import discretisation, parsing
from idviewer.cli.options import DisplayOptions, PictureQuery

if TYPE_CHECKING:
    from idviewer.cli.distance_options import ChosenDistance
    from idviewer.core import InteriorDistance, Shape
    from idviewer.session import Frame, Pipeline, Query, SpectrumCache


def cache_of(no_cache: bool) -> SpectrumCache | None:
    """The user's cache of eigenpairs; None if that is not wanted."""
    from idviewer.session import SpectrumCache

    return None if no_cache else SpectrumCache.of_user()


def box_in_words(shape: Shape) -> str:
    """The bounding box in words, for those who looked for the body elsewhere."""
    corners = ("(" + ", ".join(f"{value:.4g}" for value in corner) + ")" for corner in shape.bounds)
    return f"whose bounding box is {' to '.join(corners)}"


def solver_of(
    shape: Shape,
    chosen: ChosenDistance,
    cache: SpectrumCache | None,
    beforehand: Callable[[Shape], None] = lambda refined: None,
) -> InteriorDistance:
    """The solver of a shape, with its eigenpairs read or computed; `print_remarks` says what it warns of.

    Beforehand somebody may look at the boundary that will be computed on.
    """
    from idviewer.core import InteriorDistance
    from idviewer.core.interior import boundary_steps
    from idviewer.core.steps import finish
    from idviewer.session import EigenpairSource

    _print_progress("computing the embedding; the first run also compiles kernels ...")
    distance = chosen.distance
    resolved = finish(boundary_steps(shape, distance, chosen.refine))
    pairs, boundary = EigenpairSource(cache), resolved.shape
    beforehand(boundary)
    spectrum = finish(pairs.steps(boundary, distance, resolved.lambda_2)) if distance.spectral else None
    finish(pairs.keep_steps())
    refined = resolved.remark(0 if spectrum is None else len(spectrum.values))
    print_remarks((*([refined] if refined else []), *pairs.remarks(boundary)))
    solver = InteriorDistance(shape, distance, chosen.coordinates, spectrum=spectrum, refine=resolved)
    solver.coordinates.warns = False
    return solver


def remarks_on_weights(solver: InteriorDistance) -> tuple[str, ...]:
    """Remarks on the weights that a solver found."""
    from idviewer.core.sampling import remarks_on

    return remarks_on(solver.coordinates)


def remarks_on_barycentroid(solver: InteriorDistance) -> list[str]:
    """Remarks on how accurate a solver's barycentroid is."""
    remark = solver.boundary.barycentroid_remark
    return [remark] if remark else []


def print_remarks(remarks: Sequence[str]) -> None:
    """Print one line each on standard error."""
    for remark in remarks:
        print(f"idviewer: {remark}", file=sys.stderr)


def distance_as_json(solver: InteriorDistance) -> dict[str, Any]:
    """The distance's name, the values of its parameters, and the coordinates' name, for JSON."""
    from idviewer.core.distances import parameter_values

    distance = solver.boundary.distance
    lambda_2 = float(solver.spectrum.values[0]) if distance.spectral else None
    return {
        "distance": distance.name,
        **parameter_values(distance, lambda_2),
        "coordinates": solver.coordinates.name,
        "refinement": discretisation.refinement_as_json(solver.boundary.resolved),
    }


def check_picture(picture: PictureQuery, options: DisplayOptions) -> None:
    """Refuse what cannot be drawn, before anything is read or computed."""
    parsing.source_of(picture.source)
    parsing.size_of(options.size)
    from idviewer.session import MAX_ISOLINES

    if not 0 <= options.isolines <= MAX_ISOLINES:
        raise ValueError(f"--isolines {options.isolines}: 0 to {MAX_ISOLINES} can be drawn")
    if not 0.0 <= options.opacity <= 1.0:
        raise ValueError(f"--opacity {options.opacity}: it lies between 0 (not seen) and 1")


def draw_picture(
    shape: Shape,
    out: Path,
    chosen: ChosenDistance,
    picture: PictureQuery,
    options: DisplayOptions,
    cache: SpectrumCache | None,
) -> None:
    """Compute a picture and write it."""
    parsing.need_picture_libraries()
    from idviewer.session import Display, State
    from idviewer.view.images import write_image

    query = query_of(shape, chosen, picture)
    display = Display(isolines=options.isolines, colormap=options.colormap, opacity=options.opacity)
    frame = frame_of(shape, query, cache)
    for text, section in zip(picture.plane, frame.slices, strict=False):
        if not len(section.points):
            raise ValueError(f"--plane {text}: the plane misses the body, {box_in_words(shape)}")
    state = State(shape, frame.query, display)
    try:
        write_image(out, state, frame, parsing.size_of(options.size), transparent=options.transparent)
    except RuntimeError as error:
        raise OSError(str(error)) from error
    print_remarks((*([frame.refinement] if frame.refinement else []), *frame.remarks))


def query_of(shape: Shape, chosen: ChosenDistance, picture: PictureQuery) -> Query:
    """The query of a picture, checked against the shape."""
    from idviewer.core import Plane
    from idviewer.session import Query

    if shape.dimension == 2 and picture.plane:
        raise ValueError(f"--plane {picture.plane[0]}: a polygon is shown whole; leave the plane out")
    planes = tuple(Plane.parse(plane, shape.bounds) for plane in picture.plane)
    source = parsing.source_of(picture.source, shape.dimension)
    if source is not None:
        source = (*source, 0.0)[:3]
    return Query(planes, source, chosen.distance, picture.quantity, chosen.coordinates, chosen.refine)  # type: ignore[arg-type]


def frame_of(shape: Shape, query: Query, cache: SpectrumCache | None) -> Frame:
    """The exact frame of a query; of a mesh without a plane, on the one that the window shows first."""
    from idviewer.core import Plane
    from idviewer.session import Pipeline, default_plane

    pipeline = Pipeline(cache)
    if shape.dimension == 3 and not query.planes:
        centre = _finest(pipeline, shape, query).barycentroid
        query = replace(query, planes=(Plane(tuple(centre.tolist()), default_plane(shape).normal),))
    return _finest(pipeline, shape, query)


def _finest(pipeline: Pipeline, shape: Shape, query: Query) -> Frame:
    """The exact frame of a query; a person who waits at a terminal is told the stages."""
    from idviewer.session import Failure, Frame, FrameRequest, Progress

    frame, last_stage = None, ""
    for result in pipeline.results(FrameRequest(shape, query)):
        if isinstance(result, Failure):
            raise result.error
        if frame is not None and frame.exact and frame.query == query and isinstance(result, Progress):
            break  # what follows is for frames to come
        if isinstance(result, Progress) and result.stage != last_stage:
            last_stage = result.stage
            _print_progress(f"{last_stage} ...")
        frame = result if isinstance(result, Frame) else frame
    assert frame is not None
    return frame


def _print_progress(progress: str) -> None:
    if sys.stderr.isatty():
        print(f"idviewer: {progress}", file=sys.stderr)
