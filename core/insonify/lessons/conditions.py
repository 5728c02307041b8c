"""Conditions and expressions over fields and named quantities: parsed here, and never run as code."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

from insonify.errors import SceneError
from insonify.lessons.quantities import QUANTITIES

Value = float | str | bool
Lookup = Callable[[str], Value | None]
BEFORE = "before"  # function of one expression: its value before the move
LONGEST = 1000  # characters
DEEPEST = 50  # nested brackets and signs

_TOKEN = re.compile(
    r"""\s*(?:(?P<number>\d+\.?\d*(?:[eE][+-]?\d+)?)|(?P<text>"[^"]*"|'[^']*')"""
    r"""|(?P<name>[A-Za-z_]\w*(?:\.\w+)*)|(?P<sign>==|!=|<=|>=|[<>+\-*/(),]))"""
)
_CONSTANTS: dict[str, Value] = {"true": True, "false": False}
_NOT, _COMPARISON, _SIGN = 3, 4, 7  # precedence of operators


class _NoValue(Exception):
    """A field without a value, or values that cannot be compared."""


class Reader(NamedTuple):
    """Values that a condition or an expression reads."""

    lookup: Lookup  # value of the field at a dotted path, None where there is none
    # Value of the quantity of a name with its arguments, None where there is none.
    quantity: Callable[[str, tuple[float, ...]], float | None] = lambda name, arguments: None
    before: Reader | None = None  # the same before the move of a step


Term = Callable[[Reader], Value]


@dataclass(frozen=True)
class Condition:
    """A condition over fields."""

    text: str  # as written
    fields: tuple[str, ...]  # dotted paths that it reads, each once, in the order of the text
    _term: Term = field(repr=False, compare=False)

    def holds(self, source: Reader | Lookup) -> bool:
        """Whether the condition holds."""
        return _evaluate(self._term, source) is True


@dataclass(frozen=True)
class Expression:
    """A number calculated from fields and quantities."""

    text: str  # as written
    names: tuple[str, ...]  # fields and quantities that it reads
    _term: Term = field(repr=False, compare=False)

    def number(self, source: Reader | Lookup) -> float | None:
        """Return its value, None where a field or a quantity has none."""
        value = self.value(source)
        return None if value is None or isinstance(value, bool | str) else float(value)

    def value(self, source: Reader | Lookup) -> Value | None:
        """Return its value, which may be a text, None where a field or a quantity has none."""
        return _evaluate(self._term, source)


def parse_condition(text: str) -> Condition:
    """Parse a condition, such as ``sonar.beam.width >= 5 and sonar.beam.kind == "fan"``."""
    parser, term = _parse(text, "join comparisons by and, or")
    if not parser.compares:
        raise _fault(text, "contains no comparison; write for example sonar.beam.width >= 5")
    return Condition(text, tuple(dict.fromkeys(parser.fields)), term)


def parse_expression(text: str) -> Expression:
    """Parse an expression of a number, such as ``shadow_length(targets.0.size.2, 21.4)``."""
    parser, term = _parse(text, "join values by + - * /")
    if parser.compares:
        raise _fault(text, "is a comparison where a number is needed; write for example 2 * altitude()")
    return Expression(text, (*parser.fields, *parser.quantities), term)


def _parse(text: str, remedy: str) -> tuple[_Parser, Term]:
    """Parse a whole text."""
    if len(text) > LONGEST:
        raise _fault(text, f"has {len(text)} characters; write at most {LONGEST}")
    parser = _Parser(text)
    term = parser.expression()
    if parser.token:
        raise _fault(text, f"{parser.token!r} is not expected here; {remedy}")
    return parser, term


def _evaluate(term: Term, source: Reader | Lookup) -> Value | None:
    """Value of a term; None where one of its values is missing or cannot be combined."""
    try:
        return term(source if isinstance(source, Reader) else Reader(source))
    except (_NoValue, ArithmeticError, TypeError, ValueError):
        return None


class _Parser:
    """Parser of a condition by the ranks of its operators."""

    def __init__(self, text: str) -> None:
        self.text, self.fields, self.quantities, self.compares = text, list[str](), list[str](), False
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
            return lambda reader: not _truth(term(reader))
        if token == "-":
            term = self._deeper(_SIGN)
            return lambda reader: -_number(term(reader))
        if token == "(":
            term = self._deeper(0)
            self._close()
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
        if self.token == "(" and (token == BEFORE or token in QUANTITIES):
            return self._call(token)
        self.fields.append(token)
        return lambda reader: _present(reader.lookup(token))

    def _call(self, name: str) -> Term:
        """Parse the arguments of a quantity, or of `BEFORE`."""
        self.quantities.append(name)
        self._descend()
        self._next()
        arguments = [] if self.token == ")" else [self.expression()]
        while self.token == ",":
            self._next()
            arguments.append(self.expression())
        self._close()
        self._depth -= 1
        wanted = 1 if name == BEFORE else len(QUANTITIES[name].arguments)
        if len(arguments) != wanted:
            raise _fault(self.text, f"{name} has {len(arguments)} values; it takes {wanted}")
        if name == BEFORE:
            return lambda reader: arguments[0](_earlier(reader))
        return lambda reader: _present(reader.quantity(name, tuple(_number(each(reader)) for each in arguments)))

    def _next(self) -> str:
        """Step over a token, and return it."""
        self._place += 1
        return self._tokens[self._place - 1]

    def _deeper(self, least: int) -> Term:
        """Step over a bracket or a sign, and parse the expression behind it."""
        self._descend()
        self._next()
        term = self.expression(least)
        self._depth -= 1
        return term

    def _descend(self) -> None:
        """Count a bracket or a sign that is nested in others."""
        self._depth += 1
        if self._depth > DEEPEST:
            raise _fault(self.text, f"is nested more than {DEEPEST} deep; write it with fewer brackets")

    def _close(self) -> None:
        """Step over a closing bracket."""
        if self.token != ")":
            raise _fault(self.text, "a bracket is not closed; add ')'")
        self._next()


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


def _earlier(reader: Reader) -> Reader:
    if reader.before is None:
        raise _NoValue
    return reader.before


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
    return lambda left, right: lambda reader: compare(*_alike(left(reader), right(reader)))


def _calculated(operation: Callable[[float, float], float]) -> Join:
    return lambda left, right: lambda reader: operation(_number(left(reader)), _number(right(reader)))


_OPERATORS: dict[str, tuple[int, Join]] = {  # rank and meaning of each
    "or": (1, lambda left, right: lambda reader: _truth(left(reader)) or _truth(right(reader))),
    "and": (2, lambda left, right: lambda reader: _truth(left(reader)) and _truth(right(reader))),
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
