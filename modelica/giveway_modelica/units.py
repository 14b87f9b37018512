"""Are the equations consistent in their units? Over the flat model, that is after all modifications and connections.

rumoca gives the flat model as a tree; what is inside functions has no units there, so theirs come from the source. A
number is a ratio, unless it is zero or a sentinel (beyond 1e9, or below 1e-9), which may stand for any unit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Any

from giveway_modelica.compiler import Compiler, classes
from giveway_modelica.dimensions import NONE, Dimension, parsed, shown, si_types, times
from giveway_modelica.lint import ANY_UNIT
from giveway_modelica.statements import declarations

Node = Mapping[str, Any]
Unit = Dimension | None
"""None: fits everything."""

SENTINEL_ABOVE, SENTINEL_BELOW = 1e9, 1e-9
RATIOS = {"Sin", "Cos", "Tan", "Tanh", "Sinh", "Cosh", "Exp", "Log", "Atan", "Floor", "Ceil", "Integer", "Mod"}
SAME = {"Abs", "Max", "Min", "Pre", "NoEvent", "Sum", "Fill", "Homotopy", "Smooth", "Previous"}
ANSWERS = {"Size", "Sample", "Zeros", "Edge", "Change", "Initial", "Sign", "Terminal"}
COMPARISONS = {"Eq", "Neq", "Lt", "Le", "Gt", "Ge"}
SECOND: Dimension = parsed("s")


class _Check:
    """Findings in one set of expressions, with the units of what they name."""

    def __init__(self, units: Mapping[str, Unit], functions: Mapping[str, tuple[list[Unit], list[Unit]]]) -> None:
        self.units, self.functions = dict(units), functions
        self.found: list[str] = []

    def equal(self, where: str, *expressions: Node) -> Unit:
        """All expressions have one unit; which."""
        known: tuple[Dimension, Node] | None = None
        for expression in expressions:
            unit = self.unit(expression)
            if unit is None:
                continue
            if known is not None and known[0] != unit:
                pair = f"{text(known[1])} [{shown(known[0])}] and {text(expression)} [{shown(unit)}]"
                self.found.append(f"{where}: {pair}")
            known = known or (unit, expression)
        return known[0] if known else None

    def ratio(self, where: str, expression: Node) -> None:
        unit = self.unit(expression)
        if unit not in (None, NONE):
            self.found.append(f"{where} of {text(expression)} [{shown(unit)}]")

    def unit(self, node: Node | None) -> Unit:
        if not node:
            return None
        ((kind, inner),) = node.items()
        visit = getattr(self, f"_{kind.lower()}", None)
        if visit is None:
            raise ValueError(f"the flat model has a {kind}, which the check of units does not know: {str(node)[:200]}")
        found: Unit = visit(inner)
        return found

    def _literal(self, inner: Node) -> Unit:
        ((kind, value),) = inner["value"].items()
        if kind not in ("Integer", "Real"):
            return None
        any_unit = value == 0 or abs(value) >= SENTINEL_ABOVE or abs(value) < SENTINEL_BELOW
        return None if any_unit else NONE

    def _varref(self, inner: Node) -> Unit:
        return self.units.get(inner["name"]["name"])

    def _index(self, inner: Node) -> Unit:
        return self.unit(inner["base"]) if "base" in inner else NONE

    def _array(self, inner: Node) -> Unit:
        return self.equal("elements of an array", *inner["elements"])

    def _tuple(self, inner: Node) -> Unit:
        return None

    def _range(self, inner: Node) -> Unit:
        return NONE

    def _arraycomprehension(self, inner: Node) -> Unit:
        return self.unit(inner["expr"])

    def _if(self, inner: Node) -> Unit:
        for condition, _ in inner["branches"]:
            self.unit(condition)
        return self.equal("branches of an if", *(value for _, value in inner["branches"]), inner["else_branch"])

    def _unary(self, inner: Node) -> Unit:
        return self.unit(inner["rhs"])

    def _binary(self, inner: Node) -> Unit:
        operator, left, right = inner["op"], inner["lhs"], inner["rhs"]
        if operator in ("Mul", "Div", "MulElem", "DivElem"):
            a, b = self.unit(left), self.unit(right)
            if _is_number(left) and a is None:
                a = NONE
            if _is_number(right) and b is None:
                b = NONE
            return None if a is None or b is None else times(a, b, 1 if operator.startswith("Mul") else -1)
        if operator in ("Exp", "ExpElem"):
            base = self.unit(left)
            power = _number(right)
            if power is None:
                self.ratio("a power", left)
                self.ratio("an exponent", right)
                return NONE
            return None if base is None else times(NONE, base, power)
        unit = self.equal(f"{operator.lower()}", left, right)
        return None if operator in COMPARISONS or operator in ("And", "Or") else unit

    def _builtincall(self, inner: Node) -> Unit:
        name, arguments = inner["function"], inner["args"]
        if name == "Der":
            unit = self.unit(arguments[0])
            return None if unit is None else times(unit, SECOND, -1)
        if name == "Sqrt":
            unit = self.unit(arguments[0])
            return None if unit is None else times(NONE, unit, Fraction(1, 2))
        if name in RATIOS:
            for argument in arguments:
                self.ratio(name.lower(), argument)
            return NONE
        if name == "Cat":
            return self.equal("cat", *arguments[1:])
        if name in SAME:
            return self.equal(name.lower(), *arguments)
        if name in ANSWERS:
            return NONE if name == "Sign" else None
        raise ValueError(f"the flat model calls {name}, which the check of units does not know")

    def _functioncall(self, inner: Node) -> Unit:
        results = self.results(inner)
        return results[0] if results else None

    def results(self, inner: Node) -> list[Unit]:
        """Units of all results of a call, its arguments checked."""
        name, arguments = inner["name"]["name"], inner["args"]
        wanted, results = self.functions[name]
        if name in ANY_UNIT:
            return [self.unit(arguments[0])]
        for argument, unit in zip(arguments, wanted, strict=True):
            found = self.unit(argument)
            if found is not None and unit is not None and found != unit:
                message = f"{name.rsplit('.', 1)[1]} wants [{shown(unit)}], gets {text(argument)} [{shown(found)}]"
                self.found.append(message)
        return results

    def equation(self, residual: Node) -> None:
        """An equation, which the flat model has as left side minus right side."""
        inner = residual.get("Binary")
        if inner is None:
            self.unit(residual)
            return
        left, right = inner["lhs"], inner["rhs"]
        if "Tuple" in left:
            for element, unit in zip(left["Tuple"]["elements"], self.results(right["FunctionCall"]), strict=True):
                self.assign(text(element), self.unit(element), unit)
            return
        self.equal("an equation", left, right)

    def assign(self, target: str, wanted: Unit, found: Unit) -> None:
        if wanted is not None and found is not None and wanted != found:
            self.found.append(f"{target} [{shown(wanted)}] is given a value in [{shown(found)}]")

    def statements(self, body: list[Node]) -> None:
        """Of a when clause or a function."""
        for one in body:
            ((kind, inner),) = one.items()
            if kind in ("Assign", "Reinit"):
                target = inner.get("target") or inner.get("state")
                self.assign(target, self.units.get(target), self.unit(inner["value"]))
            elif kind == "Assignment":
                target = ".".join(part["ident"] for part in inner["comp"]["parts"])
                self.assign(target, self.units.get(target), self.unit(inner["value"]))
            elif kind == "For":
                self.units.update({index["ident"]: NONE for index in inner["indices"]})
                self.statements(inner["equations"])
            elif kind == "If":
                for block in (*inner["cond_blocks"], {"stmts": inner.get("else_block") or []}):
                    self.statements(block["stmts"])
            elif kind == "Assert":
                pass
            else:
                raise ValueError(f"the flat model has a statement {kind}, which the check of units does not know")


def text(node: Node) -> str:
    """An expression for messages, shortened."""
    ((kind, inner),) = node.items()
    signs = {"Add": "+", "Sub": "-", "Mul": "*", "Div": "/", "Exp": "^"}
    if kind == "VarRef":
        return str(inner["name"]["name"])
    if kind == "Literal":
        return str(next(iter(inner["value"].values())))
    if kind == "Binary":
        return f"{text(inner['lhs'])} {signs.get(inner['op'], inner['op'])} {text(inner['rhs'])}"[:120]
    if kind == "Unary":
        return f"-{text(inner['rhs'])}"
    if kind == "BuiltinCall":
        return f"{inner['function'].lower()}({', '.join(text(one) for one in inner['args'])})"[:120]
    return kind


def _number(node: Node) -> Fraction | None:
    if "Unary" in node and node["Unary"]["op"] == "Minus":
        inner = _number(node["Unary"]["rhs"])
        return None if inner is None else -inner
    if "Literal" not in node:
        return None
    ((kind, value),) = node["Literal"]["value"].items()
    return Fraction(value) if kind in ("Integer", "Real") else None


def _is_number(node: Node) -> bool:
    return _number(node) is not None


def _source_units(name: str) -> dict[str, Unit]:
    """Units of all that a function declares, from its source."""
    found = next(one for one in classes() if one.name == name)
    units: dict[str, Unit] = {}
    for one in declarations(found.text, name.rsplit(".", 1)[1]):
        if one.type == "Real":
            quoted = one.rest.partition('unit="')[2].partition('"')[0]
            units[one.name] = parsed(quoted) if quoted else None
        else:
            short = one.type.removeprefix("SI.")
            units[one.name] = parsed(si_types()[short]) if short in si_types() else NONE
    return units


def findings(compiler: Compiler, name: str) -> Iterator[str]:
    """Everything in the flat model of ``name`` whose units do not fit."""
    flat = compiler.load(name).to_dict("flat")
    kinds = flat["variable_type_names"]
    units: dict[str, Unit] = {"time": SECOND}
    for variable, properties in flat["variables"].items():
        real = kinds.get(variable, "Real") == "Real"
        units[variable] = (parsed(properties["unit"]) if properties["unit"] else None) if real else NONE
    functions, bodies = {}, []
    for called, function in flat["functions"].items():
        own = _source_units(called)
        functions[called] = (
            [own[one["name"]] for one in function["inputs"]],
            [own[one["name"]] for one in function["outputs"]],
        )
        bodies.append((own, function["body"]))
    check = _Check(units, functions)
    for equation in (*flat["equations"], *flat["initial_equations"]):
        check.equation(equation["residual"])
    for chain in flat["when_chains"]:
        for branch in (chain["first"], *chain["else_when"]):
            check.unit(branch["condition"])
            check.statements(branch["equations"])
    for variable, properties in flat["variables"].items():
        for value in (properties["binding"], properties["start"]):
            if value and not _is_number(value) and not _numbers(value):
                check.assign(variable, units[variable], check.unit(value))
    yield from check.found
    for own, body in bodies:
        inside = _Check(own, functions)
        inside.statements(body)
        yield from inside.found


def _numbers(node: Node) -> bool:
    """A table of numbers, which have the unit of what they are given to."""
    return "Array" in node and all(_is_number(one) or _numbers(one) for one in node["Array"]["elements"])
