"""Arithmetic expressions typed by a user, evaluated without ever running them as code."""

from __future__ import annotations

import ast
import operator
import re
from collections.abc import Callable

import numpy as np

from idviewer.core.arrays import Floats

MOST_CHARACTERS = 200
"""Characters; what is longer may nest deeper than the parser goes."""

LAMBDA_PLACEHOLDER = "_lambd"
"""As long as `lambda`, which Python keeps for itself, so that places in the text stay what they are."""

VARIABLES = {"x": 0, LAMBDA_PLACEHOLDER: 0, "λ": 0, "lambda_2": 1, "lambda2": 1}
"""Which of the two numbers a name stands for."""

FUNCTIONS = {"exp": np.exp, "log": np.log, "sqrt": np.sqrt}
OPERATORS: dict[type[ast.AST], Callable[..., Floats]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}
SYNTAX = "numbers, + - * / **, exp, log, sqrt, brackets, lambda (or x) and lambda_2"


class Expression:
    """A function of an eigenvalue, `lambda` or `x`, and of the first one, `lambda_2`.

    Args:
        text: such as "exp(-lambda / lambda_2)".

    Raises:
        ValueError: the text is something else; the message points at the part that is wrong.

    >>> Expression("sqrt(lambda) / lambda_2")(np.array([4.0, 9.0]), 2.0).tolist()
    [1.0, 1.5]
    >>> Expression("exp(-lambda) + open('f')")
    Traceback (most recent call last):
    ValueError: "open('f')" at character 16 is no part of an expression; there are numbers, + - * / **, \
exp, log, sqrt, brackets, lambda (or x) and lambda_2
    """

    def __init__(self, text: str) -> None:
        self._text = text
        if not text.strip():
            raise ValueError(f"the expression is empty; there are {SYNTAX}")
        if len(text) > MOST_CHARACTERS:
            raise ValueError(f"the expression has {len(text)} characters; {MOST_CHARACTERS} are the most")
        self._body = re.sub(r"\blambda\b", LAMBDA_PLACEHOLDER, text.replace("\n", " "))
        leading = len(self._body) - len(self._body.lstrip())
        self._offset = leading
        try:
            self._tree = ast.parse(self._body.lstrip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            raise ValueError(self._syntax_error(error)) from None
        self._check(self._tree)

    def __call__(self, values: Floats, lambda_2: float) -> Floats:
        """The expression at eigenvalues (k,); infinite or NaN where it has no value."""
        with np.errstate(all="ignore"):
            result = self._value(self._tree, (np.asarray(values, dtype=np.float64), np.float64(lambda_2)))
        return np.broadcast_to(result, np.shape(values)).astype(np.float64)

    def _syntax_error(self, error: BaseException) -> str:
        told = getattr(error, "offset", None) or 0
        place = told + self._offset
        near = self._text[place - 1 :][:12] if told > 0 else ""
        where = f"something is wrong at character {place}, {near!r}" if near.strip() else "it ends too early"
        hint = "; powers are written **" if "^" in self._text else ""
        return f"{self._text!r} cannot be read: {where}{hint}"

    def _check(self, node: ast.AST) -> None:
        match node:
            case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
                return
            case ast.Name(id=name) if name in VARIABLES:
                return
            case ast.Call(func=ast.Name(id=name), args=[only], keywords=[]) if name in FUNCTIONS:
                self._check(only)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
                self._check(left)
                self._check(right)
            case ast.UnaryOp(op=op, operand=operand) if type(op) in OPERATORS:
                self._check(operand)
            case _:
                raise ValueError(self._unexpected_part(node))

    def _unexpected_part(self, node: ast.AST) -> str:
        # Places are told in bytes by Python, in characters here.
        source = self._body.lstrip().encode()
        start = len(source[: getattr(node, "col_offset", 0)].decode())
        end = len(source[: getattr(node, "end_col_offset", len(source))].decode())
        part = self._text.lstrip()[start:end]
        hint = "; powers are written **" if isinstance(getattr(node, "op", None), ast.BitXor) else ""
        place = start + self._offset + 1
        return f'"{part}" at character {place} is no part of an expression; there are {SYNTAX}{hint}'

    def _value(self, node: ast.AST, values: tuple[Floats, np.float64]) -> Floats:
        match node:
            case ast.Constant(value=value):
                return _number(value)
            case ast.Name(id=name):
                return np.asarray(values[VARIABLES[name]])
            case ast.Call(func=ast.Name(id=name), args=[only]):
                return FUNCTIONS[name](self._value(only, values))
            case ast.BinOp(left=left, op=op, right=right):
                return OPERATORS[type(op)](self._value(left, values), self._value(right, values))
            case ast.UnaryOp(op=op, operand=operand):
                return OPERATORS[type(op)](self._value(operand, values))
        raise AssertionError("checked before")


def _number(value: object) -> Floats:
    """As an array: integers of Python's own would grow without end in powers."""
    try:
        return np.array(float(value))  # type: ignore[arg-type]
    except OverflowError:
        return np.array(np.inf)
