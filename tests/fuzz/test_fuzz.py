"""Damaged files of every kind are read, or refused in one line; `make fuzz` tries thirty times as many."""

from __future__ import annotations

import numpy as np
import pytest
from tests.fuzz.campaign import run
from tests.fuzz.mutations import MUTATIONS, mutant
from tests.fuzz.seeds import seeds

TRIALS, SEED = 300, 20090715


@pytest.mark.slow
def test_three_hundred_mutants_are_read_or_refused():
    tally = run(TRIALS, SEED, patience=300.0)
    assert not tally.bad
    assert sum(tally.counts.values()) == TRIALS
    assert tally.of("loaded") > 0
    assert tally.of("refused") > TRIALS / 2
    assert {suffix for suffix, _ in tally.counts} >= {".off", ".obj", ".ply", ".stl", ".glb", ".csv", ".svg"}


@pytest.mark.parametrize("mutate", MUTATIONS, ids=lambda one: one.__name__)
def test_mutations_change_files_and_are_the_same_for_the_same_seed(mutate):
    data, other = (bytes(kind[0]) for kind in (seeds()[".off"], seeds()[".obj"]))
    made = [mutate(np.random.default_rng(seed), data, other) for seed in (*range(8), 0)]
    assert made[0] == made[-1]
    assert any(one != data for one in made)


def test_mutants_of_nothing_are_nothing():
    assert mutant(np.random.default_rng(1), b"", b"") == b""
