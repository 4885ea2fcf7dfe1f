"""talus-lab scene, bench, chart, stability."""

from __future__ import annotations

import argparse
import importlib
import json
import tempfile
from pathlib import Path

NOT_MET = 1  # exit code, as in talus


def add(commands: argparse._SubParsersAction) -> None:
    c = commands.add_parser("scene", help="write a scenario as other programs read it, see docs/runners.md")
    c.add_argument("scenario", type=Path, metavar="SCENARIO.yaml")
    c.add_argument("-o", "--output", type=Path, metavar="FILE", help="default: beside the scenario, .json")
    c.add_argument("--frames", type=int, default=1, metavar="K", help="states to look at beside the start (default: 1)")
    c.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change a key of the scenario")
    c.set_defaults(command=scene_command)

    _study(commands, "bench", "measure contact searches as a config says; table, charts and the numbers of its page", "studies")
    _study(commands, "chart", "draw error against CPU time for the scenes and methods of a config; table, charts and page", "scenes")

    s = commands.add_parser("stability", help="run the stability suite and make the table of its page")
    s.add_argument("config", type=Path, metavar="CONFIG.yaml")
    s.add_argument("--draw", action="store_true", help="the table from what was measured last, and nothing else")
    s.set_defaults(command=stability_command)


def _study(commands: argparse._SubParsersAction, name: str, help: str, parts: str) -> None:
    p = commands.add_parser(name, help=help)
    p.add_argument("config", type=Path, metavar="CONFIG.yaml")
    p.add_argument("--quick", action="store_true", help=f"the {parts} in their shortest form, to see that they work; the page is left alone")
    p.add_argument("--long", action="store_true", help=f"with the {parts} marked `long`")
    p.add_argument("--draw", action="store_true", help="charts and page from what was measured so far, and nothing else")
    p.add_argument("--again", action="store_true", help="measure also what an earlier run has measured")
    p.set_defaults(command=study_command, study=f"talus_lab.{name}")


def scene_command(options: argparse.Namespace) -> int:
    from talus_lab.chart.exchange import cut, scene_json
    from talus_lab.program import find_talus

    keys = dict(word.partition("=")[::2] for word in options.set)
    with tempfile.TemporaryDirectory() as folder:
        blocks, scenario = cut(find_talus(), options.scenario, keys, Path(folder))
        scene = scene_json(blocks, scenario, options.frames, {})
    output: Path = options.output or options.scenario.with_suffix(".json")
    output.write_text(json.dumps(scene), encoding="utf-8")
    print(output)
    return 0


def study_command(options: argparse.Namespace) -> int:
    """Measures what a config lists; one table, charts, and the numbers of a page. `options.study` is the package that knows how."""
    from talus_lab.program import find_talus
    from talus_lab.study.picture import save_small

    study = importlib.import_module(options.study)
    config = study.read_config(options.config)
    if options.quick:
        config = study.quick(config)
    study.fill_page(config.page.read_text(encoding="utf-8"), config, [])  # faults of the page before hours of measuring
    if options.draw:
        rows = study.measured(config)
    else:
        rows = study.measure(config, find_talus(), options.long, options.again, lambda line: print(line, flush=True))
        print(config.output / "results.csv")
    config.output.mkdir(parents=True, exist_ok=True)
    config.images.mkdir(parents=True, exist_ok=True)
    for name, described in config.charts.items():
        figure = study.draw(config, described, rows)
        if figure is None:
            print(f"{name}: no chart, nothing of it was measured")
            continue
        figure.savefig(config.output / f"{name}.svg")
        save_small(figure, config.images / f"{name}.png")
        print(config.images / f"{name}.png")
    written = config.output / config.page.name if options.quick else config.page
    page = config.page.read_text(encoding="utf-8")  # as it is now: it may have been written on meanwhile
    written.write_text(study.fill_page(page, config, rows), encoding="utf-8")
    print(written)
    return 0


def stability_command(options: argparse.Namespace) -> int:
    from talus_lab import stability
    from talus_lab.program import find_talus

    config = stability.read_config(options.config)
    stability.fill_page(config.page.read_text(encoding="utf-8"), config, [])  # a fault of the page before minutes of running
    if options.draw:
        checks = stability.read_table(config.output / "stability.csv")
    else:
        checks = stability.verify(config, find_talus(), lambda line: print(line, flush=True))
    checks += stability.tests(config, find_talus())
    config.page.write_text(stability.fill_page(config.page.read_text(encoding="utf-8"), config, checks), encoding="utf-8")
    print(config.page)
    return 0 if all(check.passed for check in checks) else NOT_MET
