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
_COMPARISONS: dict[str, Callable[[Value, Value], bool]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
_SUMS = {"+": operator.add, "-": operator.sub}
_PRODUCTS = {"*": operator.mul, "/": operator.truediv}
_CONSTANTS: dict[str, Value] = {"true": True, "false": False}
_WORDS = ("and", "or", "not")


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
    term = parser.either()
    if parser.token:
        raise _fault(text, f"{parser.token!r} does not belong there; join comparisons by and, or")
    if not parser.compares:
        raise _fault(text, "compares nothing; write for example sonar.beam.width >= 5")
    return Condition(text, tuple(dict.fromkeys(parser.fields)), term)


class _Parser:
    """Recursive descent over the tokens of a condition, from ``or`` down to single values."""

    def __init__(self, text: str) -> None:
        self.text, self.fields, self.compares = text, list[str](), False
        self._tokens = _tokens(text)
        self._place = self._depth = 0

    @property
    def token(self) -> str:
        """The token at the present place; empty at the end."""
        return self._tokens[self._place] if self._place < len(self._tokens) else ""

    def either(self) -> Term:
        """Terms joined by ``or``."""
        terms = [self._both()]
        while self._take("or"):
            terms.append(self._both())
        return terms[0] if len(terms) == 1 else lambda lookup: any(_truth(term(lookup)) for term in terms)

    def _both(self) -> Term:
        terms = [self._negation()]
        while self._take("and"):
            terms.append(self._negation())
        return terms[0] if len(terms) == 1 else lambda lookup: all(_truth(term(lookup)) for term in terms)

    def _negation(self) -> Term:
        if not self._take("not"):
            return self._comparison()
        term = self._deeper(self._negation)
        return lambda lookup: not _truth(term(lookup))

    def _comparison(self) -> Term:
        left = self._chain(_SUMS, self._product)
        sign = self._take(*_COMPARISONS)
        if not sign:
            return left
        right, compare, self.compares = self._chain(_SUMS, self._product), _COMPARISONS[sign], True
        return lambda lookup: compare(*_alike(left(lookup), right(lookup)))

    def _product(self) -> Term:
        return self._chain(_PRODUCTS, self._single)

    def _chain(self, operators: dict[str, Callable[[float, float], float]], part: Callable[[], Term]) -> Term:
        """Parts joined by operators of one rank, from left to right."""
        term = part()
        while sign := self._take(*operators):
            term = _applied(operators[sign], term, part())
        return term

    def _single(self) -> Term:
        if self._take("-"):
            term = self._deeper(self._single)
            return lambda lookup: -_number(term(lookup))
        if self._take("("):
            term = self._deeper(self.either)
            if not self._take(")"):
                raise _fault(self.text, "a bracket is not closed; add ')'")
            return term
        return self._value()

    def _value(self) -> Term:
        token = self.token
        if not token or token in _WORDS or not (token[0].isalnum() or token[0] in "_\"'"):
            raise _fault(self.text, f"a value is missing before {token or 'the end'!r}; add a field or a number")
        self._place += 1
        if token[0] in "\"'":
            return lambda _: token[1:-1]
        if token[0].isdigit():
            number = float(token)
            return lambda _: number
        if token in _CONSTANTS:
            return lambda _: _CONSTANTS[token]
        self.fields.append(token)
        return lambda lookup: _present(lookup(token))

    def _take(self, *tokens: str) -> str:
        """Step over one of these tokens, and return it; empty if none of them is next."""
        token = self.token
        if token not in tokens:
            return ""
        self._place += 1
        return token

    def _deeper(self, parse: Callable[[], Term]) -> Term:
        self._depth += 1
        if self._depth > DEEPEST:
            raise _fault(self.text, f"is nested more than {DEEPEST} deep; write it with fewer brackets")
        term = parse()
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


def _applied(operation: Callable[[float, float], float], left: Term, right: Term) -> Term:
    return lambda lookup: operation(_number(left(lookup)), _number(right(lookup)))


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
