"""A small interpreter of IEC 61131-3 Structured Text, to execute what runglight writes.

Only what a test needs: BOOL, integers and TIME, CTU and TON, assignments, IF, CASE, FOR, EXIT.
Written from the standard's grammar, not from the writer.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

_TOKEN = re.compile(
    r"\s+|\(\*.*?\*\)|(?P<time>T#-?\d+ms)|(?P<place>%[IQM][XBWD]?\d+(?:\.\d+)*)|(?P<number>-?\d+)"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*)|(?P<sign>:=|<>|<=|>=|[<>=:;(),.+])",
    re.DOTALL,
)
_ENDS = {"END_IF", "END_CASE", "END_FOR", "END_PROGRAM", "ELSE", "ELSIF"}
_COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {
    "=": lambda a, b: a == b,
    "<>": lambda a, b: a != b,
    "<": lambda a, b: a < b,
    ">": lambda a, b: a > b,
    "<=": lambda a, b: a <= b,
    ">=": lambda a, b: a >= b,
}


class _ExitLoopError(Exception):
    """EXIT."""


@dataclass
class CountUp:
    """CTU (IEC 61131-3, table 45)."""

    CV: int = 0
    Q: bool = False
    _was_on: bool = False

    def __call__(self, now_ms: int, *, CU: bool, R: bool, PV: int) -> None:  # noqa: N803
        del now_ms
        if R:
            self.CV = 0
        elif CU and not self._was_on:
            self.CV += 1
        self._was_on = CU
        self.Q = self.CV >= PV


@dataclass
class OnDelay:
    """TON (IEC 61131-3, table 46)."""

    Q: bool = False
    ET: int = 0
    _since_ms: int | None = None

    def __call__(self, now_ms: int, *, IN: bool, PT: int) -> None:  # noqa: N803
        if not IN:
            self._since_ms, self.Q, self.ET = None, False, 0
            return
        self._since_ms = now_ms if self._since_ms is None else self._since_ms
        self.ET = min(now_ms - self._since_ms, PT)
        self.Q = now_ms - self._since_ms >= PT


Statement = Callable[[], None]
Value = Callable[[], Any]


@dataclass
class StructuredText:
    """A program, parsed; `scan` runs it once."""

    text: str
    variables: dict[str, Any] = field(default_factory=dict)
    places: dict[str, str] = field(default_factory=dict)
    """Address of a variable to its name."""

    def __post_init__(self) -> None:
        self._tokens = list(_tokens(self.text))
        self._at = 0
        self._now_ms = 0
        self._expect("PROGRAM")
        self.name = self._next()
        while self._peek() == "VAR":
            self._declare()
        self._body = self._statements()
        self._expect("END_PROGRAM")
        assert self._at == len(self._tokens), "something stands behind END_PROGRAM"

    def scan(self, inputs: Mapping[str, bool | int], now_ms: int) -> dict[str, bool | int]:
        """Sets the inputs by address, runs the program, gives the outputs by address."""
        for address, value in inputs.items():
            self.variables[self.places[address]] = value
        self._now_ms = now_ms
        _run(self._body)
        return {
            address: self.variables[name]
            for address, name in self.places.items()
            if address.startswith("%Q")
        }

    # declarations

    def _declare(self) -> None:
        self._expect("VAR")
        while self._peek() != "END_VAR":
            name = self._next()
            if self._peek() == "AT":
                self._next()
                self.places[self._next()] = name
            self._expect(":")
            kind = self._next()
            blocks: dict[str, Callable[[], Any]] = {"CTU": CountUp, "TON": OnDelay, "BOOL": bool}
            assert kind in blocks or kind in {"INT", "UINT", "USINT", "UDINT", "TIME"}, kind
            assert name not in self.variables, f"{name} is declared twice"
            self.variables[name] = blocks.get(kind, int)()
            if self._peek() == ":=":
                self._next()
                self.variables[name] = self._expression()()
            self._expect(";")
        self._expect("END_VAR")

    # statements

    def _statements(self) -> list[Statement]:
        found: list[Statement] = []
        while self._peek() not in _ENDS and not self._is_case_label():
            found.append(self._statement())
        assert found, f"no statement before {self._peek()}"
        return found

    def _is_case_label(self) -> bool:
        return self._peek().lstrip("-").isdigit()

    def _statement(self) -> Statement:
        match self._next():
            case "IF":
                return self._if()
            case "CASE":
                return self._case()
            case "FOR":
                return self._for()
            case "EXIT":
                self._expect(";")
                return _exit
            case ";":
                return lambda: None
            case name:
                return self._call(name) if self._peek() == "(" else self._assign(name)

    def _assign(self, name: str) -> Statement:
        assert name in self.variables, f"{name} is not declared"
        self._expect(":=")
        value = self._expression()
        self._expect(";")

        def assign() -> None:
            self.variables[name] = value()

        return assign

    def _call(self, name: str) -> Statement:
        arguments: dict[str, Value] = {}
        self._expect("(")
        while True:
            argument = self._next()
            self._expect(":=")
            arguments[argument] = self._expression()
            if self._next() == ")":
                break
        self._expect(";")
        block = self.variables[name]

        def call() -> None:
            block(self._now_ms, **{key: value() for key, value in arguments.items()})

        return call

    def _if(self) -> Statement:
        branches: list[tuple[Value, list[Statement]]] = []
        otherwise: list[Statement] = []
        while True:
            condition = self._expression()
            self._expect("THEN")
            branches.append((condition, self._statements()))
            word = self._next()
            if word == "ELSE":
                otherwise = self._statements()
                word = self._next()
            if word == "END_IF":
                break
            assert word == "ELSIF", word
        self._expect(";")

        def branch() -> None:
            for condition, body in branches:
                if condition():
                    _run(body)
                    return
            _run(otherwise)

        return branch

    def _case(self) -> Statement:
        value = self._expression()
        self._expect("OF")
        branches: dict[int, list[Statement]] = {}
        while self._peek() != "END_CASE":
            label = int(self._next())
            self._expect(":")
            assert label not in branches, f"case {label} stands twice"
            branches[label] = self._statements()
        self._expect("END_CASE")
        self._expect(";")
        return lambda: _run(branches.get(value(), []))

    def _for(self) -> Statement:
        name = self._next()
        self._expect(":=")
        first = self._expression()
        self._expect("TO")
        last = self._expression()
        self._expect("DO")
        body = self._statements()
        self._expect("END_FOR")
        self._expect(";")

        def loop() -> None:
            for number in range(first(), last() + 1):
                self.variables[name] = number
                try:
                    _run(body)
                except _ExitLoopError:
                    return

        return loop

    # expressions, by precedence

    def _expression(self) -> Value:
        left = self._conjunction()
        while self._peek() == "OR":
            self._next()
            left = _or(left, self._conjunction())
        return left

    def _conjunction(self) -> Value:
        left = self._comparison()
        while self._peek() == "AND":
            self._next()
            left = _and(left, self._comparison())
        return left

    def _comparison(self) -> Value:
        left = self._unary()
        if self._peek() in _COMPARISONS:
            compare = _COMPARISONS[self._next()]
            right = self._unary()
            return lambda: compare(left(), right())
        return left

    def _unary(self) -> Value:
        if self._peek() == "NOT":
            self._next()
            operand = self._unary()
            return lambda: not operand()
        token = self._next()
        if token == "(":
            inner = self._expression()
            self._expect(")")
            return inner
        literal = _literal(token)
        if literal is not None:
            return lambda: literal
        assert token in self.variables, f"{token} is not declared"
        if self._peek() == ".":
            self._next()
            member = self._next()
            return lambda: getattr(self.variables[token], member)
        return lambda: self.variables[token]

    def _peek(self) -> str:
        return self._tokens[self._at]

    def _next(self) -> str:
        self._at += 1
        return self._tokens[self._at - 1]

    def _expect(self, token: str) -> None:
        found = self._next()
        assert found == token, f"expected {token}, found {found}"


def _tokens(text: str) -> Iterator[str]:
    at = 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        assert match, f"no Structured Text: {text[at : at + 20]!r}"
        at = match.end()
        if match.lastgroup is not None:
            yield match[0]


def _literal(token: str) -> bool | int | None:
    if token in {"TRUE", "FALSE"}:
        return token == "TRUE"
    if token.startswith("T#"):
        return int(token[2:-2])
    return int(token) if token.lstrip("-").isdigit() else None


def _run(body: list[Statement]) -> None:
    for statement in body:
        statement()


def _exit() -> None:
    raise _ExitLoopError


def _or(left: Value, right: Value) -> Value:
    return lambda: left() or right()


def _and(left: Value, right: Value) -> Value:
    return lambda: left() and right()
