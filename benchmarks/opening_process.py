"""Opens a mesh as the viewer does, without its window; prints as JSON how long what took.

python opening_process.py MESH CACHE
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from viewer_process import kilobytes

from idviewer.core import Diffusion, InteriorDistance, Mesh, Plane, Spectrum
from idviewer.core.compilation import compile_steps
from idviewer.core.steps import finish
from idviewer.session.pipeline import Pipeline
from idviewer.session.spectrum_cache import SpectrumCache
from idviewer.session.state import (
    Failure,
    Frame,
    FrameRequest,
    Opened,
    OpenRequest,
    Query,
    Ready,
    default_plane,
)

NEAR = 1e-3
"""Share of its range within which a frame counts as final."""

CHECKED = 200
"""Values of a first frame that are compared with the final distances."""


def main() -> None:
    finish(compile_steps(3))
    cache = SpectrumCache(Path(sys.argv[2]))
    pipeline = Pipeline(cache, previews=True)
    start = time.perf_counter()
    shape = next(
        one.shape for one in told(pipeline, OpenRequest(Path(sys.argv[1]))) if isinstance(one, Opened)
    )
    read = time.perf_counter() - start
    frames: list[tuple[float, Frame]] = []
    for frame in shown(pipeline, shape):
        frames.append((time.perf_counter() - start, frame))
    peak = kilobytes("VmHWM")
    print(
        json.dumps(
            {
                "read": read,
                "first": frames[0][0],
                "final": next(seconds for seconds, frame in frames if is_final(frame)),
                "exact": next(seconds for seconds, frame in frames if frame.exact),
                "change": change(frames[0][1], cache.lookup(shape, Diffusion().cutoff)),
                "peak": peak,
            }
        )
    )


def shown(pipeline: Pipeline, mesh: Mesh) -> Iterator[Frame]:
    """Frames as a window asks for them: when it gets to know the barycentroid, of the plane through it."""
    query, asked = Query(planes=(default_plane(mesh),)), True
    while asked:
        asked = False
        for result in told(pipeline, FrameRequest(mesh, query)):
            if isinstance(result, Frame):
                yield result
            elif isinstance(result, Ready) and query.planes == (default_plane(mesh),):
                place = tuple(result.barycentroid.tolist())
                plane = result.plane or Plane(place, query.planes[0].normal)  # type: ignore[arg-type]
                query, asked = Query(planes=(plane,)), True
                break


def told(pipeline: Pipeline, request: OpenRequest | FrameRequest):  # type: ignore[no-untyped-def]
    for result in pipeline.results(request):
        if isinstance(result, Failure):
            raise result.error
        yield result


def is_final(frame: Frame) -> bool:
    """Whether a frame is of the mesh's own eigenpairs and as good as exact."""
    low, high = frame.value_range
    return frame.preview is None and frame.error <= NEAR * (high - low)


def change(frame: Frame, spectrum: Spectrum | None) -> float:
    """Largest difference between a frame's values and exact distances, as a share of the largest."""
    points, values = frame.slices[0].points, frame.slices[0].values
    some = np.random.default_rng(0).permutation(len(points))[:CHECKED]
    exact = InteriorDistance(frame.shape, spectrum=spectrum).field(frame.source, points[some])
    inside = np.isfinite(exact)
    return float(np.abs(exact - values[some])[inside].max() / frame.value_range[1])


if __name__ == "__main__":
    main()
