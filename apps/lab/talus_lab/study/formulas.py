"""Numbers within texts of a config: `[0, {sqrt(blocks)}]`."""

from __future__ import annotations

import ast
import math
import operator
import re
from typing import Callable, Mapping

OPERATIONS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: operator.pow,
              ast.USub: operator.neg}
FUNCTIONS = {"sqrt": math.sqrt, "min": min, "max": max, "round": round, "sin_deg": lambda x: math.sin(math.radians(x)),
             "cos_deg": lambda x: math.cos(math.radians(x)), "tan_deg": lambda x: math.tan(math.radians(x))}


class FormulaError(ValueError):
    pass


def filled(text: object, values: Mapping[str, float]) -> str:
    """The text with every {formula} replaced by its value. Formulas know + - * / **, FUNCTIONS and the names in values."""
    return re.sub(r"\{([^{}]*)\}", lambda match: format(evaluate(match[1], values), ".10g"), str(text))


def evaluate(formula: str, values: Mapping[str, float], more: Mapping[str, Callable[..., float]] = {}) -> float:
    """more: functions beside FUNCTIONS."""
    try:
        return _value(ast.parse(formula.strip(), mode="eval").body, values, {**FUNCTIONS, **more})
    except (SyntaxError, ArithmeticError, ValueError, TypeError) as error:
        raise FormulaError(f"{{{formula}}}: {getattr(error, 'msg', error)}") from None


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
