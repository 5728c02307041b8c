"""Conditions over fields: comparisons, arithmetic, ``and``, ``or``, ``not``; parsed here, and never run as code."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable
from dataclasses import dataclass, field

from insonify.errors import SceneError

Value = float | str | bool
Lookup = Callable[[str], Value | None]
LONGEST = 1000  # characters
DEEPEST = 50  # nested brackets and signs

_TOKEN = re.compile(
    r"""\s*(?:(?P<number>\d+\.?\d*(?:[eE][+-]?\d+)?)|(?P<text>"[^"]*"|'[^']*')"""
    r"""|(?P<name>[A-Za-z_]\w*(?:\.\w+)*)|(?P<sign>==|!=|<=|>=|[<>+\-*/()]))"""
)
_CONSTANTS: dict[str, Value] = {"true": True, "false": False}
_NOT, _COMPARISON, _SIGN = 3, 4, 7  # precedence of operators


class _NoValue(Exception):
    """A field without a value, or values that cannot be compared."""


Term = Callable[[Lookup], Value]


@dataclass(frozen=True)
class Condition:
    """A condition over fields."""

    text: str  # as written
    fields: tuple[str, ...]  # dotted paths that it reads, each once, in the order of the text
    _term: Term = field(repr=False, compare=False)

    def holds(self, lookup: Lookup) -> bool:
        """Whether the condition holds."""
        try:
            return self._term(lookup) is True
        except (_NoValue, ZeroDivisionError, TypeError):
            return False


def parse_condition(text: str) -> Condition:
    """Parse a condition, such as ``sonar.beam.width >= 5 and sonar.beam.kind == "fan"``."""
    if len(text) > LONGEST:
        raise _fault(text, f"has {len(text)} characters; write at most {LONGEST}")
    parser = _Parser(text)
    term = parser.expression()
    if parser.token:
        raise _fault(text, f"{parser.token!r} does not belong there; join comparisons by and, or")
    if not parser.compares:
        raise _fault(text, "compares nothing; write for example sonar.beam.width >= 5")
    return Condition(text, tuple(dict.fromkeys(parser.fields)), term)


class _Parser:
    """Parser of a condition by the ranks of its operators."""

    def __init__(self, text: str) -> None:
        self.text, self.fields, self.compares = text, list[str](), False
        self._tokens = _tokens(text)
        self._place = self._depth = 0

    @property
    def token(self) -> str:
        """The token at the present place; empty at the end."""
        return self._tokens[self._place] if self._place < len(self._tokens) else ""

    def expression(self, least: int = 0) -> Term:
        """Values joined by operators of a least rank, from left to right; comparisons are not chained."""
        left, most = self._operand(least), _SIGN
        while least <= _OPERATORS.get(self.token, (-1,))[0] <= most:
            rank, join = _OPERATORS[self._next()]
            left = join(left, self.expression(rank + 1))
            if rank == _COMPARISON:
                self.compares, most = True, rank - 1
        return left

    def _operand(self, least: int) -> Term:
        """Parse a value, a negation, or an expression in brackets."""
        token = self.token
        if token == "not" and least <= _NOT:
            term = self._deeper(_NOT)
            return lambda lookup: not _truth(term(lookup))
        if token == "-":
            term = self._deeper(_SIGN)
            return lambda lookup: -_number(term(lookup))
        if token == "(":
            term = self._deeper(0)
            if self.token != ")":
                raise _fault(self.text, "a bracket is not closed; add ')'")
            self._next()
            return term
        if not token or token in _OPERATORS or token == "not" or not (token[0].isalnum() or token[0] in "_\"'"):
            raise _fault(self.text, f"a value is missing before {token or 'the end'!r}; add a field or a number")
        return self._value(self._next())

    def _value(self, token: str) -> Term:
        """Return a text, a number, a truth value or a field as a term."""
        if token[0] in "\"'":
            return lambda _: token[1:-1]
        if token[0].isdigit():
            return lambda _: float(token)
        if token in _CONSTANTS:
            return lambda _: _CONSTANTS[token]
        self.fields.append(token)
        return lambda lookup: _present(lookup(token))

    def _next(self) -> str:
        """Step over a token, and return it."""
        self._place += 1
        return self._tokens[self._place - 1]

    def _deeper(self, least: int) -> Term:
        """Step over a bracket or a sign, and parse the expression behind it."""
        self._depth += 1
        if self._depth > DEEPEST:
            raise _fault(self.text, f"is nested more than {DEEPEST} deep; write it with fewer brackets")
        self._next()
        term = self.expression(least)
        self._depth -= 1
        return term


def _tokens(text: str) -> list[str]:
    tokens, place, end = [], 0, len(text.rstrip())
    while place < end:
        match = _TOKEN.match(text, place)
        if match is None:
            rest = text[place:].split()[0]
            raise _fault(text, f"{rest!r} is not understood; write fields, numbers and texts in quotes")
        tokens.append(match.group().strip())
        place = match.end()
    return tokens


def _fault(text: str, fault: str) -> SceneError:
    shown = text if len(text) <= 60 else f"{text[:57]}..."
    return SceneError(f"condition {shown!r}: {fault}")


def _present(value: Value | None) -> Value:
    if value is None:
        raise _NoValue
    return value


def _number(value: Value) -> float:
    if isinstance(value, bool | str):
        raise _NoValue
    return value


def _truth(value: Value) -> bool:
    if not isinstance(value, bool):
        raise _NoValue
    return value


def _alike(left: Value, right: Value) -> tuple[Value, Value]:
    """Two values that may be compared: both numbers, both texts or both truth values."""
    kinds = {str if isinstance(value, str) else bool if isinstance(value, bool) else float for value in (left, right)}
    if len(kinds) > 1:
        raise _NoValue
    return left, right


Join = Callable[[Term, Term], Term]


def _compared(compare: Callable[[Value, Value], bool]) -> Join:
    return lambda left, right: lambda lookup: compare(*_alike(left(lookup), right(lookup)))


def _calculated(operation: Callable[[float, float], float]) -> Join:
    return lambda left, right: lambda lookup: operation(_number(left(lookup)), _number(right(lookup)))


_OPERATORS: dict[str, tuple[int, Join]] = {  # rank and meaning of each
    "or": (1, lambda left, right: lambda lookup: _truth(left(lookup)) or _truth(right(lookup))),
    "and": (2, lambda left, right: lambda lookup: _truth(left(lookup)) and _truth(right(lookup))),
    "==": (_COMPARISON, _compared(operator.eq)),
    "!=": (_COMPARISON, _compared(operator.ne)),
    "<": (_COMPARISON, _compared(operator.lt)),
    "<=": (_COMPARISON, _compared(operator.le)),
    ">": (_COMPARISON, _compared(operator.gt)),
    ">=": (_COMPARISON, _compared(operator.ge)),
    "+": (5, _calculated(operator.add)),
    "-": (5, _calculated(operator.sub)),
    "*": (6, _calculated(operator.mul)),
    "/": (6, _calculated(operator.truediv)),
}
