"""Numbers as programs write them: with decimal commas, Fortran's exponents, and the ways to write NaN."""

from __future__ import annotations

import re

from idviewer.core.arrays import Floats
from idviewer.core.io.text import Tokens, UnreadableError, floats

_COMMA = re.compile(rb"[+-]?(\d*),(\d+)([eEdD][+-]?\d+)?")
_POINT = re.compile(rb"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?")
_FORTRAN = re.compile(rb"([+-]?(?:\d+\.?\d*|\.\d+))[dD]([+-]?\d+)")
_NOT_A_NUMBER = re.compile(rb"[+-]?(?:nan(?:\(\w*\))?|1[.,]#(?:ind|qnan|snan|inf)\d*)", re.IGNORECASE)


def numbers(tokens: Tokens) -> tuple[Floats, tuple[str, ...]]:
    """Convert tokens to float64; what is written unusually is understood where it can mean one thing only.

    Args:
        tokens: one number each. Decimal commas are taken where every number has one, and one at least
            cannot be a thousand; "1.5D+02" is 150; "-nan(ind)", "1.#QNAN" and "1.#INF" are NaN.

    Returns:
        the numbers, and a note for each way of writing that was met.

    Raises:
        UnreadableError: a token is no number, or may mean two; the message names it.

    >>> numbers([b"0,5", b"1,250"])
    (array([0.5 , 1.25]), ('Its numbers have decimal commas.',))
    """
    try:
        return floats(tokens), ()
    except UnreadableError:
        pass
    notes = []
    plain = list(tokens)
    if any(b"," in token for token in tokens):
        finite = [token for token in plain if not _NOT_A_NUMBER.fullmatch(token)]
        if _all_have_commas(finite):
            plain = [token.replace(b",", b".") for token in plain]
            notes.append("Its numbers have decimal commas.")
    fortran = [_FORTRAN.sub(rb"\1e\2", token) if b"d" in token.lower() else token for token in plain]
    if fortran != plain:
        notes.append("Its exponents are written with a D.")
    unusual = sum(_NOT_A_NUMBER.fullmatch(token) is not None for token in fortran)
    if unusual:
        shown = next(token for token in fortran if _NOT_A_NUMBER.fullmatch(token)).decode()
        notes.append(f"{unusual:,} values such as {shown!r} were taken for what is no number.")
        fortran = [b"nan" if _NOT_A_NUMBER.fullmatch(token) else token for token in fortran]
    return floats(fortran), tuple(notes)


def _all_have_commas(tokens: Tokens) -> bool:
    """Whether all are numbers with a decimal comma; False where one is no number of any kind."""
    matches = [_COMMA.fullmatch(token) for token in tokens]
    pointed = next((token for token, match in zip(tokens, matches, strict=True) if match is None), None)
    if pointed is not None:
        if not _POINT.fullmatch(pointed):
            return False
        comma = next(match[0] for match in matches if match is not None).decode()
        raise UnreadableError(
            f"{comma!r} has a comma and {pointed.decode()!r} has none; write decimal points"
        )
    for match in matches:
        assert match is not None
        if match[3] or len(match[2]) != 3 or not 0 < len(match[1]) < 4 or match[1].startswith(b"0"):
            return True
    first = tokens[0].decode()
    raise UnreadableError(f"{first!r} may be a decimal comma or a thousand; write decimal points")
