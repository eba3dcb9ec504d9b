"""Bodies examined and repaired through the session: foretold, shown, taken back exactly."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes
from tests.session.bodies import WatchedSession, egg

from idviewer.core import Euclidean, Mesh, Plane, Polygon, Repairs
from idviewer.core.shapes import BrokenBodyError, RawBody
from idviewer.core.validation import PolygonSoup
from idviewer.session import RepairDesk
from idviewer.session.body_work import body_results
from idviewer.session.state import Examined, ExamineRequest, Foretold, Progress, Repaired, RepairRequest

EGG = egg()
STAR = Polygon(shapes.star(40))


def torn(mesh: Mesh = EGG) -> RawBody:
    """The body without a face and its neighbours."""
    near = np.isin(mesh.faces, mesh.faces[0]).any(axis=1)
    return RawBody(PolygonSoup.of(mesh.vertices, mesh.faces[~near]), "torn")


@pytest.fixture
def watched():
    with WatchedSession() as made:
        made.session.set(distance=Euclidean())
        yield made


@pytest.fixture
def desk(watched) -> RepairDesk:
    return RepairDesk(watched.session)


def heard(watched, signal) -> list:
    told: list = []
    signal.connect(told.append)
    return told


def test_the_work_tells_what_it_does_and_gives_the_result() -> None:
    body = torn()
    stage, *_, examined = (one for one in body_results(ExamineRequest(body)) if one is not None)
    assert isinstance(stage, Progress)
    assert isinstance(examined, Examined)
    assert examined.health.faults[0].fatal
    repairs = examined.health.suggested
    results = [list(body_results(RepairRequest(body, repairs, foretell=told))) for told in (True, False)]
    foretold, repaired = (next(one for one in result[::-1] if one is not None) for result in results)
    assert isinstance(foretold, Foretold)
    assert isinstance(repaired, Repaired)
    assert foretold.outcome.records == repaired.outcome.records
    assert all(None in result for result in results)


@pytest.mark.slow
def test_a_refused_body_is_examined_repaired_and_taken_back(watched, desk) -> None:
    watched.session.show(STAR)
    watched.settle()
    watched.session.set(isolines=7, source=(0.1, 0.2, 0.0))
    watched.settle()
    before, frame = watched.session.state, watched.session.frame
    examined, foretold = heard(watched, desk.examined), heard(watched, desk.foretold)
    assert desk.examine_refused(torn(), None)
    watched.settle()
    (health,) = examined
    assert health.suggested.fill_holes
    assert watched.session.state is before
    desk.foretell(health.suggested)
    watched.settle()
    assert foretold[0].usable
    assert watched.session.state is before
    desk.repair(health.suggested)
    watched.settle()
    assert isinstance(watched.session.state.shape, Mesh)
    assert watched.session.frame.shape is watched.session.state.shape
    assert (desk.is_modified, desk.undo_title, desk.redo_title) == (True, "Fill holes", "")
    repaired = watched.session.state
    desk.undo()
    assert watched.session.state is before
    assert watched.session.frame is frame
    watched.settle()
    assert watched.session.state is before
    assert len(examined) == 2, "the refused body is looked at again"
    assert (desk.is_modified, desk.redo_title) == (False, "Fill holes")
    desk.redo()
    watched.settle()
    assert watched.session.state is repaired


@pytest.mark.slow
def test_repairing_what_is_shown_keeps_query_and_display(watched, desk) -> None:
    watched.session.show(EGG)
    watched.settle()
    plane = Plane((0.0, 0.1, 0.2), (0.0, 1.0, 0.5))
    watched.session.set(planes=(plane,), source=(0.0, 0.1, 0.2), isolines=11)
    watched.settle()
    before = watched.session.state
    assert desk.examine_shown()
    watched.settle()
    assert desk.is_of_shown
    desk.repair(Repairs(weld=1e-3))
    watched.settle()
    after = watched.session.state
    assert after.shape is not before.shape
    assert (after.query, after.display) == (before.query, before.display)
    desk.undo()
    watched.settle()
    assert watched.session.state is before


@pytest.mark.slow
def test_a_repair_that_leaves_it_open_is_an_error_and_changes_nothing(watched, desk) -> None:
    watched.session.show(EGG)
    watched.settle()
    before = watched.session.state
    desk.examine_refused(torn(), None)
    watched.settle()
    desk.repair(Repairs(fill_holes=3))
    watched.settle()
    ((error,),) = watched.told("failed")
    assert isinstance(error, BrokenBodyError)
    assert watched.session.state is before
    assert watched.session.frame.exact
    assert not desk.is_modified


@pytest.mark.slow
def test_opening_another_shape_forgets_the_body_and_the_way_back(watched, desk) -> None:
    desk.examine_refused(torn(), None)
    watched.settle()
    desk.repair(Repairs(fill_holes=30))
    watched.settle()
    assert desk.is_modified
    watched.session.show(STAR)
    assert desk.health is None
    assert not desk.is_modified
    desk.undo()
    assert watched.session.state.shape is STAR


@pytest.mark.slow
def test_a_change_while_a_body_is_examined_is_computed_afterwards(watched, desk) -> None:
    watched.session.show(EGG)
    examined = heard(watched, desk.examined)
    assert desk.examine_shown()
    watched.session.set(source=(0.0, 0.0, 0.1))
    watched.settle()
    assert len(examined) == 1
    assert watched.session.frame.exact
    assert watched.session.frame.query.source == (0.0, 0.0, 0.1)


def test_there_is_nothing_to_examine_in_a_polygon_or_in_nothing(watched, desk) -> None:
    assert not desk.examine_shown()
    desk.undo()
    desk.redo()
    assert watched.session.state.shape is None
