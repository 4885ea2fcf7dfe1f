"""Numbers within texts of a config: `[0, {sqrt(blocks)}]`."""

from __future__ import annotations

import ast
import math
import operator
import re
from typing import Any, Callable, Mapping


class FormulaError(ValueError):
    pass


def _power(x: float, y: float) -> float:
    """Of whole numbers a whole one, as far as numbers are exact: 9**9**9 would have 370 million digits."""
    try:
        power = float(x) ** y
    except OverflowError:
        raise ValueError(f"{x:g} ** {y:g} is too large") from None
    if isinstance(power, complex):
        raise ValueError(f"{x:g} ** {y:g} is not a real number")
    return x**y if abs(power) < 2**53 else power


OPERATIONS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: _power,
              ast.USub: operator.neg}
FUNCTIONS = {"sqrt": math.sqrt, "abs": abs, "min": min, "max": max, "round": round, "sin_deg": lambda x: math.sin(math.radians(x)),
             "cos_deg": lambda x: math.cos(math.radians(x)), "tan_deg": lambda x: math.tan(math.radians(x)),
             "atan_deg": lambda x: math.degrees(math.atan(x))}
COMPARISONS = {ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge, ast.Eq: operator.eq, ast.NotEq: operator.ne}
LOGIC = {ast.And: all, ast.Or: any}


def filled(text: object, values: Mapping[str, float]) -> str:
    """The text with every {formula} replaced by its value. Formulas know + - * / **, FUNCTIONS and the names in values."""
    return re.sub(r"\{([^{}]*)\}", lambda match: format(evaluate(match[1], values), ".10g"), str(text))


def evaluate(formula: str, values: Mapping[str, float], more: Mapping[str, Callable[..., float]] = {}) -> float:
    """more: functions beside FUNCTIONS."""
    try:
        return _value(ast.parse(formula.strip(), mode="eval").body, values, {**FUNCTIONS, **more})
    except (SyntaxError, ArithmeticError, ValueError, TypeError) as error:
        raise FormulaError(f"{{{formula}}}: {getattr(error, 'msg', error)}") from None


def holds(condition: str, values: Mapping[str, Any]) -> bool:
    """Of a condition such as `friction_deg <= dip_deg + 5 and rock == 'granite'`."""
    try:
        return _holds(ast.parse(condition.strip(), mode="eval").body, values)
    except (SyntaxError, ArithmeticError, ValueError, TypeError) as error:
        raise FormulaError(f"{condition}: {getattr(error, 'msg', error)}") from None


def _holds(node: ast.expr, values: Mapping[str, Any]) -> bool:
    match node:
        case ast.BoolOp():
            return LOGIC[type(node.op)](_holds(part, values) for part in node.values)
        case ast.UnaryOp(op=ast.Not()):
            return not _holds(node.operand, values)
        case ast.Compare() if all(type(op) in COMPARISONS for op in node.ops):
            sides = [_side(side, values) for side in (node.left, *node.comparators)]
            return all(COMPARISONS[type(op)](a, b) for op, a, b in zip(node.ops, sides, sides[1:]))
    raise ValueError("a condition compares formulas by < <= > >= == !=, joined by and, or, not")


def _side(node: ast.expr, values: Mapping[str, Any]) -> Any:
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else _value(node, values, FUNCTIONS)


def _value(node: ast.expr, values: Mapping[str, float], functions: Mapping[str, Callable[..., float]]) -> float:
    match node:
        case ast.Constant(value=int() | float()):
            return node.value
        case ast.Name():
            if node.id not in values:
                raise ValueError(f"no value is called {node.id}; there are {', '.join(values)}")
            return values[node.id]
        case ast.BinOp() | ast.UnaryOp() if type(node.op) in OPERATIONS:
            operands = [node.left, node.right] if isinstance(node, ast.BinOp) else [node.operand]
            return OPERATIONS[type(node.op)](*(_value(operand, values, functions) for operand in operands))
        case ast.Call(func=ast.Name(id=name), keywords=[]) if name in functions:
            return functions[name](*(_value(argument, values, functions) for argument in node.args))
    raise ValueError(f"a formula has numbers, names, + - * / ** and {', '.join(functions)}")
