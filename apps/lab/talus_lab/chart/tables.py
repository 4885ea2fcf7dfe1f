"""The tables of the page: `lead`, `front-SCENE` for every scene, `reference` where there are any, `settings` and `failed`."""

from __future__ import annotations

from talus_lab.chart.config import Config, scale_of
from talus_lab.chart.fronts import Rows, best, confirmed, least, points
from talus_lab.chart.measure import NOT_THERE, parts, references
from talus_lab.study import page
from talus_lab.study.page import NOTHING, number, table_text


def fill_page(text: str, config: Config, rows: Rows) -> str:
    """The text with every table as the rows have it."""
    rows = list(rows)
    names = ["lead", "failed", *(f"front-{scene}" for scene in config.scenes)]
    if any(scene.reference for scene in config.scenes.values()):
        names.append("reference")
    return page.fill(config.page, text, names, lambda name: _table(config, name, rows))


def _table(config: Config, name: str, rows: list) -> str:
    kind, _, scene = name.partition("-")
    if kind == "front":
        return _front(config, scene, rows)
    return {"lead": _lead, "failed": _failed, "reference": _reference}[kind](config, rows)


def _front(config: Config, scene: str, rows: list) -> str:
    """CPU time of each method for each error; the least of a column in bold."""
    lines = {method: confirmed(line) for method, line in points(rows, scene).items()}
    if not lines:
        return NOTHING
    cheapest = [min((point.cpu_time for line in lines.values() if (point := least(line, level))), default=None) for level in config.levels]
    body = []
    for method in config.scenes[scene].methods:
        described = config.methods[method]
        if method not in lines:
            said = {row["said"] for row in rows if row["scene"] == scene and row["method"] == method}
            why = "not measured" if not said else NOT_THERE if all(text.endswith(NOT_THERE) for text in said) else "failed"
            body.append([described.label, *[why] * len(config.levels), "", ""])
            continue
        cells = []
        for level, lowest in zip(config.levels, cheapest):
            point = least(lines[method], level)
            cells.append("-" if point is None else f"**{seconds(point.cpu_time)}**" if point.cpu_time == lowest else seconds(point.cpu_time))
        finest = min(lines[method], key=lambda point: point.error)
        body.append([described.label, *cells, f"{finest.error:.1e} at {seconds(finest.cpu_time)}", finest.setting])
    head = ["method", *(f"{level:.0e}" for level in config.levels), "least error", "its setting"]
    return table_text(head, body, words=1)


def _lead(config: Config, rows: list) -> str:
    """How many times the time of our best method the best of the other programs takes."""
    body = []
    for scene, described in config.scenes.items():
        if not points(rows, scene):
            continue
        cells = []
        for level in config.levels:
            ours, theirs = (best(config, rows, scene, level, whose) for whose in (True, False))
            if ours and theirs:
                cells.append(f"{number(theirs[1].cpu_time / ours[1].cpu_time, 2)} ({config.methods[ours[0]].label} / {config.methods[theirs[0]].label})")
            else:
                cells.append(f"only {config.methods[ours[0]].label}" if ours else f"only {config.methods[theirs[0]].label}" if theirs else "none")
        body.append([described.title, *cells])
    return table_text(["scene", *(f"{level:.0e}" for level in config.levels)], body, words=1) if body else NOTHING


def _reference(config: Config, rows: list) -> str:
    """Values of the reference runs, and how little the two finest differ."""
    known = references(config)
    body = []
    for scene, described in config.scenes.items():
        lines = [row for row in known if row["scene"] == scene]
        for k, row in enumerate(lines):
            found = parts(row["values"])
            before = parts(lines[k - 1]["values"]) if k else {}
            for name, error in described.errors.items():
                if name in found:
                    change = f"{abs(found[name] - before[name]) / scale_of(error, found[name]):.1e}" if name in before else "-"
                    body.append([described.title, error.label, row["setting"], f"{found[name]:.6g} {error.unit}".strip(), change])
    return table_text(["scene", "what", "run", "value", "change from the run before"], body, words=3) if body else NOTHING


def _failed(config: Config, rows: list) -> str:
    """Runs without a result, and what the program said."""
    body = [[config.scenes[row["scene"]].title, config.methods[row["method"]].label, row["setting"], row["said"].replace("|", "/")]
            for row in rows if row["said"] and not row["said"].endswith(NOT_THERE)]
    return table_text(["scene", "method", "setting", "said"], body, words=4) if body else "none\n"


def seconds(value: float) -> str:
    """Two digits: times repeat no better."""
    return f"{value:.2g}" if 1e-3 <= value < 100 else f"{value:.0f}" if value >= 100 else f"{value:.1e}"
