"""Mutations of files: what cuts, damaged disks and careless programs make of them, and what attackers do."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np

NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
STRANGE_NUMBERS = (
    b"0",
    b"-1",
    b"1e400",
    b"-1e400",
    b"nan",
    b"inf",
    b"1.#QNAN",
    b"2147483647",
    b"2147483648",
    b"4294967295",
    b"9223372036854775807",
    b"99999999999999999999999",
    b"1,5",
    b"",
    b"0x10",
    b"1e-320",
)
STRANGE_WORDS = (0, 1, 0x7F, 0xFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x7FFFFFFFFFFFFFFF)
Mutation = Callable[[np.random.Generator, bytes, bytes], bytes]


def _place(rng: np.random.Generator, data: bytes) -> int:
    return int(rng.integers(0, len(data) + 1))


def flip_bits(rng: np.random.Generator, data: bytes, other: bytes) -> bytes:
    damaged = bytearray(data)
    for _ in range(int(rng.integers(1, 9))):
        damaged[int(rng.integers(len(data)))] ^= 1 << int(rng.integers(8))
    return bytes(damaged)


def cut(rng: np.random.Generator, data: bytes, other: bytes) -> bytes:
    return data[: _place(rng, data)]


def lose_a_piece(rng: np.random.Generator, data: bytes, other: bytes) -> bytes:
    start, end = sorted((_place(rng, data), _place(rng, data)))
    return data[:start] + data[min(end, start + 64) :]


def repeat_a_piece(rng: np.random.Generator, data: bytes, other: bytes) -> bytes:
    start, end = sorted((_place(rng, data), _place(rng, data)))
    return data[:start] + data[start:end] * int(rng.integers(2, 6)) + data[end:]


def zero_a_block(rng: np.random.Generator, data: bytes, other: bytes) -> bytes:
    start = _place(rng, data)
    size = min(int(rng.integers(1, 65)), len(data) - start)
    return data[:start] + bytes(size) + data[start + size :]


def replace_a_number(rng: np.random.Generator, data: bytes, other: bytes) -> bytes:
    numbers = list(NUMBER.finditer(data))
    if not numbers:
        return flip_bits(rng, data, other)
    found = numbers[int(rng.integers(min(len(numbers), 60)))]  # counts stand at the beginning
    strange = STRANGE_NUMBERS[int(rng.integers(len(STRANGE_NUMBERS)))]
    return data[: found.start()] + strange + data[found.end() :]


def replace_a_word(rng: np.random.Generator, data: bytes, other: bytes) -> bytes:
    size = int(rng.choice([1, 2, 4, 8]))
    value = STRANGE_WORDS[int(rng.integers(len(STRANGE_WORDS)))] & ((1 << 8 * size) - 1)
    start = _place(rng, data)
    order = "little" if rng.random() < 0.8 else "big"
    return data[:start] + value.to_bytes(size, order) + data[start + size :]  # type: ignore[arg-type]


def splice(rng: np.random.Generator, data: bytes, other: bytes) -> bytes:
    return data[: _place(rng, data)] + other[_place(rng, other) :]


def swap_lines(rng: np.random.Generator, data: bytes, other: bytes) -> bytes:
    lines = data.splitlines(keepends=True)
    i, j = rng.integers(len(lines), size=2)
    lines[i], lines[j] = lines[j], lines[i]
    return b"".join(lines)


def add_rubbish(rng: np.random.Generator, data: bytes, other: bytes) -> bytes:
    start = _place(rng, data)
    return data[:start] + rng.bytes(int(rng.integers(1, 65))) + data[start:]


MUTATIONS: tuple[Mutation, ...] = (
    flip_bits,
    cut,
    lose_a_piece,
    repeat_a_piece,
    zero_a_block,
    replace_a_number,
    replace_a_word,
    splice,
    swap_lines,
    add_rubbish,
)


def mutant(rng: np.random.Generator, data: bytes, other: bytes) -> bytes:
    """Mostly one mutation of data, at times up to four; `other` is a file to splice with."""
    for _ in range(1 if rng.random() < 0.7 else int(rng.integers(2, 5))):
        if data:
            data = MUTATIONS[int(rng.integers(len(MUTATIONS)))](rng, data, other)
    return data
