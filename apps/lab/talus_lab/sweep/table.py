"""What came of a sweep as one table: `table.csv`, `table.h5`, `table.parquet` if asked for, and `sweep.json`, which says what its columns are."""

from __future__ import annotations

import csv
import io
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping, Sequence

import h5py
import numpy as np

from talus_lab.sweep.case import Record
from talus_lab.sweep.cases import Case, keys_of, levels
from talus_lab.sweep.config import COLUMNS, REPETITION, Config
from talus_lab.sweep.measures import known_unit, said
from talus_lab.sweep.ranges import is_drawn, is_number

UNITS = {"wall_time": "s"}


@dataclass(frozen=True)
class Column:
    name: str
    unit: str  # "-" for words
    values: Sequence[Any]  # numbers, texts, or None
    label: str = ""


def columns_of(config: Config, cases: Sequence[Case], records: Mapping[str, Record]) -> list[Column]:
    """One row for each case, whether it has been computed or not."""
    found = [records.get(case.id, {}) for case in cases]
    units = {measure.key: known_unit(measure.key) for measure in config.measures} | {key: unit for record in found for key, unit in record.get("units", {}).items()}
    parameters = [Column(p["name"], p["unit"], [case.values[p["name"]] for case in cases], p["label"]) for p in parameters_of(config)]
    measures = [Column(measure.name, units.get(measure.key, ""), [record.get("measures", {}).get(measure.key) for record in found], measure.label or said(measure.key))
                for measure in config.measures]
    about = {"case": [case.id for case in cases], "status": [record.get("status", "missing") for record in found]}
    about |= {name: [record.get(name) for record in found] for name in COLUMNS if name not in about}
    rest = [Column(name, UNITS.get(name, "-"), about[name]) for name in COLUMNS[1:]]
    return [Column("case", "-", about["case"]), *parameters, *measures, *rest]


def parameters_of(config: Config) -> list[dict]:
    """name, keys of the scenario, unit, label, values in their order, kind: grid, drawn or repetition."""
    found = []
    for name, values in levels(config).items():
        parameter = config.repetitions if name == REPETITION else config.parameters[name]
        kind = REPETITION if name == REPETITION else "drawn" if is_drawn(parameter) else "grid"
        unit = getattr(parameter, "unit", "") or _unit(name, values)
        found.append({"name": name, "keys": keys_of(parameter), "unit": unit, "label": getattr(parameter, "label", "") or name, "kind": kind,
                      "values": values} | ({"scale": "log"} if getattr(parameter, "scale", "") == "log" else {}))
    return found


def write_tables(config: Config, columns: Sequence[Column]) -> None:
    """Each file whole, or what was there before."""
    measures = {measure.name: measure for measure in config.measures}
    about = {"name": config.path.stem, "title": config.title, "scenario": str(config.scenario), "config": str(config.path.resolve()),
             "parameters": parameters_of(config), "cases": len(columns[0].values),
             "measures": [{"name": c.name, "unit": c.unit, "label": c.label or c.name, "measure": measures[c.name].key}
                          for c in columns if c.name in measures]}
    _replace(config.output / "sweep.json", (json.dumps(about, indent=1, ensure_ascii=False) + "\n").encode())
    _replace(config.output / "table.csv", _csv(columns))
    _replace(config.output / "table.h5", _h5(about, columns))
    if config.parquet:
        _replace(config.output / "table.parquet", _parquet(about, columns))


def _csv(columns: Sequence[Column]) -> bytes:
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([column.name for column in columns])
    writer.writerows(zip(*([_plain(value) for value in column.values] for column in columns)))
    return text.getvalue().encode()


def _plain(value: Any) -> Any:
    return "" if value is None else json.dumps(value) if isinstance(value, (list, dict, bool)) else value


def _h5(about: Mapping[str, Any], columns: Sequence[Column]) -> bytes:
    memory = io.BytesIO()
    with h5py.File(memory, "w") as file:
        file.attrs["sweep"] = json.dumps(about, ensure_ascii=False)
        for column in columns:
            data = file.create_dataset(column.name, data=_array(column))
            data.attrs["unit"], data.attrs["label"] = column.unit, column.label or column.name
    return memory.getvalue()


def _parquet(about: Mapping[str, Any], columns: Sequence[Column]) -> bytes:
    """Units and labels are metadata of the fields; what there is not is null."""
    import pyarrow
    from pyarrow import parquet

    arrays, fields = [], []
    for column in columns:
        numbers = column.unit != "-" and all(is_number(value) for value in column.values if value is not None)
        arrays.append(pyarrow.array([value if value is None else float(value) if numbers else str(_plain(value)) for value in column.values],
                                    pyarrow.float64() if numbers else pyarrow.string()))
        fields.append(pyarrow.field(column.name, arrays[-1].type, metadata={"unit": column.unit, "label": column.label or column.name}))
    made = pyarrow.Table.from_arrays(arrays, schema=pyarrow.schema(fields, {"sweep": json.dumps(about, ensure_ascii=False)}))
    memory = io.BytesIO()
    parquet.write_table(made, memory)
    return memory.getvalue()


def _array(column: Column) -> np.ndarray:
    """Numbers, with nan for none, or texts of fixed length in UTF-8."""
    given = [value for value in column.values if value is not None]
    if column.unit != "-" and all(is_number(value) for value in given):
        return np.array([np.nan if value is None else value for value in column.values], dtype=float)
    return np.array([str(_plain(value)).encode() for value in column.values] or [b""])


def _replace(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f"{path.name}.{os.getpid()}.part")
    try:
        beside.write_bytes(content)
        beside.replace(path)
    except OSError:
        beside.unlink(missing_ok=True)
        raise


def _unit(name: str, values: Sequence[Any]) -> str:
    if not all(is_number(value) for value in values):
        return "-"
    return "deg" if name.endswith("_deg") else "1"

