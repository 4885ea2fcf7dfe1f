"""The tables of the page of a study."""

from __future__ import annotations

import math

from talus_lab.bench.config import Config, Table
from talus_lab.bench.select import Rows, growth, series, totals, words
from talus_lab.study import page
from talus_lab.study.page import NOTHING, number, table_text


def fill_page(text: str, config: Config, rows: Rows) -> str:
    """The text with every table as the rows have it."""
    return page.fill(config.page, text, config.tables, lambda name: markdown(config, config.tables[name], rows))


def markdown(config: Config, table: Table, rows: Rows) -> str:
    rows = list(rows)
    head, body = {"values": _values, "totals": _totals, "ratios": _ratios, "spread": _spread, "growth": _growth}[table.kind](config, table, rows)
    body = [line for line in body if any(cell != "-" for cell in line[2:])]
    if not body:
        return NOTHING
    filled = [k for k in range(len(head)) if k < 2 or any(line[k] != "-" for line in body)]
    return table_text([head[k] for k in filled], [[line[k] for k in filled] for line in body], words=2)


Parts = tuple[list[str], list[list[str]]]


def _values(config: Config, table: Table, rows: list) -> Parts:
    names = table.series or _all(config, table, rows)
    body = [[where, at, *(number(lines.get(name, {}).get(value)) for name in names)] for where, at, value, lines in _points(config, table, rows)]
    return ["scene", _varied(config, table), *map(words, names)], body


def _totals(config: Config, table: Table, rows: list) -> Parts:
    """Sums over all numbers of threads and skins."""
    body = []
    for study in table.studies:
        for scene in config.studies[study].scenes:
            lines = totals(rows, table.column, study, scene)
            body += [[config.scenes[scene].name, f"{value:,.10g}", *(number(lines.get(name, {}).get(value)) for name in table.series)]
                     for value in config.studies[study].values]
    return ["scene", _varied(config, table), *table.series], body


def _ratios(config: Config, table: Table, rows: list) -> Parts:
    body = [[where, at, *(_ratio(lines.get(a, {}).get(value), lines.get(b, {}).get(value)) for a, b in table.pairs)]
            for where, at, value, lines in _points(config, table, rows)]
    return ["scene", _varied(config, table), *(f"{words(a)} / {words(b)}" for a, b in table.pairs)], body


def _spread(config: Config, table: Table, rows: list) -> Parts:
    """Least and largest over the quantity that is varied, and how often the one goes into the other."""
    names = table.series or _all(config, table, rows)
    body = []
    for study, scene, lines in _scenes(config, table, rows):
        ends = [(min(line.values()), max(line.values())) if (line := lines.get(name)) else None for name in names]
        cells = [f"{number(end[0])} to {number(end[1])} ({number(end[1] / end[0], 2)})" if end else "-" for end in ends]
        body.append([config.scenes[scene].name, _short(config, config.studies[study].varied), *cells])
    return ["scene", "over", *map(words, names)], body


def _growth(config: Config, table: Table, rows: list) -> Parts:
    names = table.series or _all(config, table, rows)
    low, high = table.between
    body = []
    for scene in dict.fromkeys(scene for study in table.studies for scene in config.studies[study].scenes):
        lines = series(rows, table.column, table.studies, scene, table.where)
        powers = [growth(lines.get(name, {}), low, high) for name in names]
        body.append([config.scenes[scene].name, f"{low:,} to {high:,}", *("-" if math.isnan(p) else f"{1 + p:.2f}" for p in powers)])
    return ["scene", "between", *map(words, names)], body


def _points(config: Config, table: Table, rows: list) -> list[tuple[str, str, float, dict]]:
    found = []
    for study, scene, lines in _scenes(config, table, rows):
        values = sorted({value for line in lines.values() for value in line})
        found += [(config.scenes[scene].name, f"{value:,.10g}", value, lines) for value in values]
    return found


def _scenes(config: Config, table: Table, rows: list) -> list[tuple[str, str, dict]]:
    return [(study, scene, series(rows, table.column, [study], scene, table.where)) for study in table.studies
            for scene in config.studies[study].scenes]


def _all(config: Config, table: Table, rows: list) -> list[str]:
    return list(dict.fromkeys(name for _, _, lines in _scenes(config, table, rows) for name in lines))


def _varied(config: Config, table: Table) -> str:
    return _short(config, config.studies[table.studies[0]].varied)


def _short(config: Config, quantity: str) -> str:
    return config.quantities[quantity].short or config.quantities[quantity].label


def _ratio(a: float | None, b: float | None) -> str:
    return number(a / b, 2) if a is not None and b else "-"
