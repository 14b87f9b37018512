"""Equations in a line of text -> MathML, which a browser shows without a network.

F_ext = sum_i ( j_w,i T_i ) + M a       names of one word; _sub with commas inside, ^2, greek letters by name
dot(x), ddot(x), sqrt(x)                a function's name and one bracket
a / b                                   a slash between blanks is set in the line
"text"                                  words
"""

from __future__ import annotations

import re
from html import escape

__all__ = ["mathml"]

_LETTERS = {
    name: chr(code)
    for name, code in {
        "alpha": 0x3B1, "delta": 0x3B4, "mu": 0x3BC, "nu": 0x3BD, "sigma": 0x3C3, "tau": 0x3C4, "phi": 0x3C6,
        "omega": 0x3C9,
    }.items()
}  # fmt: skip
_OPERATORS = {"sum": "\u2211", "<=": "\u2264", "-": "\u2212"}
_OVER = {"dot": ".", "ddot": ".."}  # browsers would draw these accents into the letter
_FUNCTIONS = ("max", "tanh", "clamp", "sign")
_TOKEN = re.compile(r"\s*(\"[^\"]*\"|[A-Za-z]+|\d+(?:\.\d+)?|<=|[-+/=<>|(),;:.'\[\]^_\u00d7\u00b7])")


class _Parser:
    def __init__(self, text: str) -> None:
        self.tokens: list[str] = []
        position = 0
        while position < len(text.rstrip()):
            match = _TOKEN.match(text, position)
            if match is None:
                raise ValueError(f"not understood: {text[position:]!r}")
            self.tokens.append(match[1])
            position = match.end()

    def peek(self) -> str:
        return self.tokens[0] if self.tokens else ""

    def take(self, wanted: str | None = None) -> str:
        if not self.tokens or (wanted is not None and self.tokens[0] != wanted):
            raise ValueError(f"{wanted or 'something'} is missing before {' '.join(self.tokens) or 'the end'!r}")
        return self.tokens.pop(0)

    def row(self, *ends: str) -> str:
        parts = []
        while self.tokens and self.peek() not in ends:
            parts.append(self.scripted())
        return f"<mrow>{''.join(parts)}</mrow>"

    def scripted(self) -> str:
        base = self.atom()
        sub = sup = None
        while self.peek() in ("_", "^"):
            if self.take() == "_":
                sub = self.script()
            else:
                sup = self.script()
        if sub is not None and sup is not None:
            return f"<msubsup>{base}{sub}{sup}</msubsup>"
        if sub is not None:
            return f"<msub>{base}{sub}</msub>"
        return base if sup is None else f"<msup>{base}{sup}</msup>"

    def script(self) -> str:
        """One atom, or several joined by commas without blanks, as in x_w,i."""
        if self.peek() == "(":
            self.take()
            inside = self.row(")")
            self.take(")")
            return inside
        parts = [self.atom()]
        while self.peek() == "," and len(self.tokens) > 1 and re.fullmatch(r"[a-z]", self.tokens[1]):
            self.take()
            parts.append(f"<mo>,</mo>{self.atom()}")
        return f"<mrow>{''.join(parts)}</mrow>"

    def atom(self) -> str:
        token = self.take()
        if token.startswith('"'):
            return f"<mtext>&#160;{escape(token[1:-1])}&#160;</mtext>"
        if token in _OVER or token == "sqrt":
            self.take("(")
            inside = self.row(")")
            self.take(")")
            if token == "sqrt":
                return f"<msqrt>{inside}</msqrt>"
            return f"<mover>{inside}<mo>{_OVER[token]}</mo></mover>"
        if token == "(":
            inside = self.row(")")
            self.take(")")
            return f"<mrow><mo>(</mo>{inside}<mo>)</mo></mrow>"
        if token in _OPERATORS:
            return f"<mo>{_OPERATORS[token]}</mo>"
        if re.fullmatch(r"\d.*", token):
            return f"<mn>{token}</mn>"
        if re.fullmatch(r"[A-Za-z]+", token):
            if token in _FUNCTIONS:
                return f"<mo>{token}</mo>"
            return f"<mi>{_LETTERS.get(token, token)}</mi>"
        if token == ")":
            raise ValueError("a bracket was never opened")
        return f"<mo>{escape(token)}</mo>"


def mathml(text: str, display: str = "block") -> str:
    """``text`` as a MathML element, ``block`` or ``inline``; ValueError with the place if it cannot be read."""
    parser = _Parser(text)
    return f'<math xmlns="http://www.w3.org/1998/Math/MathML" display="{display}">{parser.row()}</math>'
