"""The command line: one function a command, each importing what it needs when it runs.

Results go to standard output, everything else to standard error. Bad input is one line and exit status 2.
"""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from cyclopts import App, CycloptsError

import idviewer
from idviewer.cli import (
    collection_commands,
    commands,
    discretisation,
    distance_options,
    output,
    parsing,
    point_distances,
)
from idviewer.cli.options import (
    BodyChoice,
    DisplayOptions,
    DistanceOptions,
    Endpoints,
    Flag,
    NoCache,
    PictureQuery,
    ReadingOptions,
    RefineText,
    RepairOptions,
)

BAD_INPUT, INTERRUPTED, BROKEN_PIPE = 2, 130, 141
DISTANCE_COMMANDS = ("render", "distance", "barycentroid", "batch", "compare")
"""The commands that take a distance."""

FALLBACK_PICTURE = Path("idviewer.png")

app = App(
    name="idviewer",
    help="Interior distances of triangle meshes and polygons: a window, and the same without one.",
    version=idviewer.__version__,
    help_format="plaintext",
    result_action="return_value",
    suppress_keyboard_interrupt=False,
)


@app.default
def window(shape: str | None = None, /, *, no_cache: NoCache = False) -> int:
    """Open the window; without a display, draw a picture instead.

    Args:
        shape: A file, or the name of a bundled shape.
        no_cache: Neither read nor keep eigenpairs on disk.
    """
    from idviewer.core.io import DEFAULT_SAMPLE

    path = None if shape is None else parsing.path_of(shape)
    obstacle = parsing.why_no_display()
    if obstacle:
        print(f"idviewer: {obstacle}; drawing a picture instead", file=sys.stderr, flush=True)
        parsing.check_picture_path(FALLBACK_PICTURE)
        chosen = distance_options.chosen_distance(DistanceOptions())
        made = parsing.shape_of(shape or DEFAULT_SAMPLE)
        cache = commands.cache_of(no_cache)
        commands.draw_picture(made, FALLBACK_PICTURE, chosen, PictureQuery(), DisplayOptions(), cache)
        print(FALLBACK_PICTURE)
        return 0
    parsing.need_window_libraries()
    from idviewer.app import run_window

    return run_window(path, commands.cache_of(no_cache))


@app.command
def render(
    shape: str,
    out: Path,
    /,
    *,
    query: PictureQuery = PictureQuery(),
    options: DistanceOptions = DistanceOptions(),
    display: DisplayOptions = DisplayOptions(),
    reading: ReadingOptions = ReadingOptions(),
) -> None:
    """Draw a picture into a PNG file; needs no display.

    Args:
        shape: A file, or the name of a bundled shape.
        out: The picture.
    """
    parsing.check_picture_path(out)
    commands.check_picture(query, display)
    chosen = distance_options.chosen_distance(options)
    cache = commands.cache_of(reading.no_cache)
    if reading.takes_all:
        from idviewer.cli import components

        components.draw(components.shapes_of(shape, reading), out, chosen, query, display, cache)
        return
    commands.draw_picture(parsing.shape_of(shape, reading), out, chosen, query, display, cache)


@app.command
def distance(
    shape: str,
    /,
    *,
    endpoints: Endpoints = Endpoints(),
    options: DistanceOptions = DistanceOptions(),
    reading: ReadingOptions = ReadingOptions(),
    json: Flag = False,
) -> None:
    """Print the interior distance of two points, or of many from one.

    Args:
        shape: A file, or the name of a bundled shape.
        json: Print JSON.
    """
    named = {name for name, value in vars(endpoints).items() if value is not None}
    if named == {"from_", "to"}:
        answer = point_distances.of_pair
    elif named - {"out"} == {"source", "points"}:
        answer = point_distances.from_source
    else:
        raise ValueError(
            "distance needs --from X,Y,Z and --to X,Y,Z, or else --source X,Y,Z and --points FILE "
            "(X,Y in a polygon)"
        )
    chosen = distance_options.chosen_distance(options)
    cache = commands.cache_of(reading.no_cache)
    if reading.takes_all:
        from idviewer.cli import components

        shapes = components.shapes_of(shape, reading)
        text = components.distances(endpoints, shapes, chosen, cache, json)
    else:
        text = answer(endpoints, lambda: parsing.shape_of(shape, reading), chosen, cache, json)
    point_distances.write(text, endpoints.out)


@app.command
def barycentroid(
    shape: str,
    /,
    *,
    options: DistanceOptions = DistanceOptions(),
    reading: ReadingOptions = ReadingOptions(),
    json: Flag = False,
) -> None:
    """Print the point inside whose mean squared distance to the boundary is smallest.

    Args:
        shape: A file, or the name of a bundled shape.
        json: Print JSON.
    """
    chosen = distance_options.chosen_distance(options)
    if reading.takes_all:
        from idviewer.cli import components

        shapes, cache = components.shapes_of(shape, reading), commands.cache_of(reading.no_cache)
        print(components.barycentroids(shapes, chosen, cache, json))
        return
    solver = commands.solver_of(parsing.shape_of(shape, reading), chosen, commands.cache_of(reading.no_cache))
    found = solver.barycentroid()
    commands.print_remarks(commands.remarks_on_barycentroid(solver))
    levels = discretisation.discretisation_of(solver)
    summary = None if levels is None else levels.summary
    warnings = discretisation.warnings_of(summary)
    commands.print_remarks((*commands.remarks_on_weights(solver), *warnings))
    if json:
        content = {**commands.distance_as_json(solver), "point": found.point, "potential": found.potential}
        print(output.as_json({**content, "discretisation": discretisation.as_json(summary)}))
    else:
        print(f"barycentroid  {output.coordinates(found.point)}\npotential     {found.potential!r}")


@app.command
def info(
    shape: str,
    /,
    *,
    choice: BodyChoice = BodyChoice(),
    repairs: RepairOptions = RepairOptions(),
    refine: RefineText = "auto",
    json: Flag = False,
) -> int:
    """Print a shape's sizes and everything that is wrong with it; exit status 2 if it cannot be used.

    Args:
        shape: A file, or the name of a bundled shape.
        refine: How the boundary is refined whose error is told: no, auto, or the longest edge allowed.
        json: Print JSON.
    """
    from idviewer.cli import shape_info

    path = parsing.path_of(shape)
    report = shape_info.polygon if shape_info.is_polygon(path) else shape_info.mesh
    refinement = distance_options.refinement_of(refine)
    text, usable = report(shape, path, choice, parsing.repairs_of(repairs), refinement, json)
    print(text)
    return 0 if usable else BAD_INPUT


@app.command
def repair(
    mesh: str,
    out: Path,
    /,
    *,
    repairs: RepairOptions = RepairOptions(),
    choice: BodyChoice = BodyChoice(),
    overwrite: Flag = False,
    json: Flag = False,
) -> None:
    """Write a mesh without its faults, and print what was changed; exit status 2 if it still cannot be used.

    Args:
        mesh: A file, or the name of a bundled shape.
        out: A file that ends in .ply, .off, .obj or .stl.
        overwrite: Let OUT be the file that is read.
        json: Print JSON.
    """
    from idviewer.cli import mesh_repair

    path = parsing.path_of(mesh)
    mesh_repair.check_output(out, path, overwrite)
    print(mesh_repair.repaired(path, out, parsing.repairs_of(repairs), choice, json))


@app.command
def samples() -> None:
    """List the bundled shapes."""
    from idviewer.core.io import all_samples

    print("\n".join(f"{sample.name:<20}{sample.description}" for sample in all_samples()))


collection_commands.add_to(app)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit status: 0, or 2 for bad input."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # it tells of its own cache folder
    try:
        if given and given[0] in DISTANCE_COMMANDS and {"--help", "-h"} & set(given):
            # Only then, because what knows the distances takes a while to load.
            app[given[0]].help_epilogue = distance_options.distances_help()
        status = app(given, exit_on_error=False, print_error=False)
        sys.stdout.flush()
        return status or 0
    except CycloptsError as error:
        return _refuse(f"{error} Try idviewer --help.")
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        # Whoever read the results has left; Python must not try to flush the rest on its way out.
        with suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except OSError as error:
        return _refuse(
            f"{error.filename}: {error.strerror}" if error.filename and error.strerror else str(error)
        )
    except (ValueError, MemoryError) as error:  # MeshError is a ValueError
        return _refuse(str(error) or "there is not enough memory for this")


def _refuse(message: str) -> int:
    print(f"idviewer: {' '.join(message.split())}", file=sys.stderr)
    return BAD_INPUT
