"""Work on files and on bodies that need not be shapes: reading, what is wrong with them, their repair."""

from __future__ import annotations

from collections.abc import Generator

from idviewer.core import read_shape
from idviewer.core.shapes import examine_steps
from idviewer.core.spectrum import check_memory
from idviewer.session.state import (
    BodyRequest,
    Examined,
    ExamineRequest,
    Foretold,
    Opened,
    OpenRequest,
    Progress,
    Repaired,
    Result,
)

EXAMINING, FORETELLING, REPAIRING = "Examining the surface", "Foretelling the repair", "Repairing the surface"


def body_results(request: BodyRequest) -> Generator[Result | None, None, None]:
    """Answer a request; None is a checkpoint at which to stop or go on.

    Raises:
        ShapeError: a file cannot be read; the body is no shape after its repair; a shape is too large.
    """
    if isinstance(request, OpenRequest):
        yield Progress(f"Reading {request.path.name}")
        read = read_shape(request.path, request.component, part=request.part)
        check_memory(read)  # what is open stays
        yield Opened(read, request.path)
        return
    if isinstance(request, ExamineRequest):
        yield Progress(EXAMINING)
        yield Examined((yield from examine_steps(request.body)))
        return
    yield Progress(FORETELLING if request.foretell else REPAIRING)
    outcome = yield from request.body.repair_steps(request.repairs)
    if request.foretell:
        yield Foretold(outcome)
        return
    shape = outcome.mesh
    check_memory(shape)
    yield Repaired(shape, outcome)
