"""The runner: one thread, one pending slot; gates stand where the real work would take time."""

from __future__ import annotations

import threading

import pytest
from tests.session.bodies import WAIT, Owner, egg

from idviewer.core import Diffusion
from idviewer.session.runner import Runner
from idviewer.session.state import (
    DropRequest,
    Failure,
    Finished,
    Frame,
    FrameRequest,
    OpenRequest,
    Progress,
    Query,
)

MESH = egg(1)


def request(number: float) -> FrameRequest:
    return FrameRequest(MESH, Query(source=(number, 0.0, 0.0)))


def frame(asked: FrameRequest, level: int) -> Frame:
    point = MESH.vertices[0]
    return Frame(MESH, asked.query, (), level, False, 0.0, point, point, (0.0, 1.0), Diffusion.title)


class GatedWork:
    """Yields what a script says for each request, waiting at a gate before every step."""

    def __init__(self, script):
        self.script = script
        self.gate = threading.Semaphore(0)
        self.arrived = threading.Semaphore(0)
        self.threads = set()
        self.closed = []

    def __call__(self, asked):
        self.threads.add(threading.current_thread().name)
        try:
            for step in self.script(asked):
                self.arrived.release()
                assert self.gate.acquire(timeout=WAIT)
                yield step
        finally:
            self.closed.append(asked)

    def let(self, steps=1):
        for _ in range(steps):
            assert self.arrived.acquire(timeout=WAIT)
            self.gate.release()


class Harness:
    def __init__(self, script):
        self.work = GatedWork(script)
        self.owner = Owner()
        self.delivered = []
        self.runner = Runner(
            self.work, lambda asked, result: self.delivered.append((asked, result)), self.owner.post
        )

    def wait_for(self, count):
        self.owner.run_until(lambda: len(self.delivered) >= count)
        return [result for _, result in self.delivered]


@pytest.fixture
def harness():
    made = []

    def make(script):
        made.append(Harness(script))
        return made[-1]

    yield make
    for one in made:
        one.work.gate.release(1000)
        one.runner.close()


def test_results_are_delivered_in_order_and_checkpoints_are_not(harness):
    asked = request(1)
    setup = harness(lambda asked: [Progress("a"), None, frame(asked, 0), None, frame(asked, 1)])
    setup.runner.submit(asked)
    setup.work.let(5)
    kinds = [type(one) for one in setup.wait_for(4)]
    assert kinds == [Progress, Frame, Frame, Finished]


def test_the_first_frame_of_a_started_query_always_goes_out(harness):
    setup = harness(lambda asked: [None, None, frame(asked, 0), None, frame(asked, 1)])
    first, second = request(1), request(2)
    setup.runner.submit(first)
    setup.work.let(1)
    setup.runner.submit(second)
    setup.work.let(2)  # the rest up to the first frame, in spite of the newer query
    setup.wait_for(1)
    assert setup.delivered[0][0] is first
    setup.work.let(5)
    setup.wait_for(4)
    assert [asked is second for asked, _ in setup.delivered[1:]] == [True] * 3
    assert first in setup.work.closed


def test_only_the_newest_waiting_query_is_served(harness):
    setup = harness(lambda asked: [frame(asked, 0)])
    queries = [request(number) for number in range(10)]
    setup.runner.submit(queries[0])
    assert setup.work.arrived.acquire(timeout=WAIT)
    for query in queries[1:]:
        setup.runner.submit(query)
    setup.work.gate.release()
    setup.work.let(1)
    setup.wait_for(3)
    served = [asked for asked, result in setup.delivered if isinstance(result, Frame)]
    assert served == [queries[0], queries[-1]]


@pytest.mark.parametrize("urgent", [DropRequest(), OpenRequest("somewhere.off")])
def test_opening_and_dropping_do_not_wait_for_a_frame(harness, urgent):
    setup = harness(lambda asked: [None] * 100 if isinstance(asked, FrameRequest) else [])
    setup.runner.submit(request(1))
    setup.work.let(1)
    setup.runner.submit(urgent)
    setup.work.gate.release()
    setup.wait_for(1)
    assert setup.delivered[0][0] is urgent


def test_progress_may_be_left_for_a_newer_query(harness):
    setup = harness(
        lambda asked: [Progress("long")] * 100 if asked.query.source[0] == 1 else [frame(asked, 0)]
    )
    setup.runner.submit(request(1))
    setup.work.let(1)
    newer = request(2)
    setup.runner.submit(newer)
    setup.work.gate.release(3)
    setup.owner.run_until(lambda: any(isinstance(result, Frame) for _, result in setup.delivered))
    assert setup.delivered[-1][0] is newer


def test_a_defect_is_delivered_and_the_thread_lives_on(harness):
    def script(asked):
        if asked.query.source[0] == 1:
            raise RuntimeError("broken")
        return [frame(asked, 0)]

    setup = harness(script)
    setup.runner.submit(request(1))
    failure, finished = setup.wait_for(2)
    assert isinstance(failure, Failure)
    assert str(failure.error) == "broken"
    assert isinstance(finished, Finished)
    setup.runner.submit(request(2))
    setup.work.let(1)
    assert isinstance(setup.wait_for(3)[2], Frame)
    assert setup.work.threads == {"idviewer-compute"}


def test_closing_in_the_middle_joins_and_delivers_nothing_more(harness):
    setup = harness(lambda asked: [None, Progress("x")] * 50)
    setup.runner.submit(request(1))
    setup.work.let(1)
    closer = threading.Thread(target=setup.runner.close)
    closer.start()
    setup.work.gate.release(1000)
    closer.join(timeout=WAIT)
    assert not closer.is_alive()
    setup.owner.run_all()
    assert len(setup.work.closed) == 1
    setup.runner.close()
    setup.runner.submit(request(2))
    setup.owner.run_all()
    assert all(asked.query.source[0] == 1 for asked, _ in setup.delivered)
