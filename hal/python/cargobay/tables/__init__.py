"""Recorded drives as numpy arrays.

    from cargobay import tables

    drive = tables.read("square.mcap")
    states = drive["states"]
    plot(states["time_s"], states["estimate_mm_s.left"])

Reads what `cargobay drive --record` and `cargobay export` write: MCAP, lines of JSON, and the
flight recorder's own files, for which the command `cargobay` has to be installed ($CARGOBAY_COMMAND
names another). CSV is for others: pandas.read_csv(), numpy.genfromtxt(). Columns have the names of
the CSV, which docs/recording.md lists with their units.

Needs numpy (python3-numpy); the rest of the package does not.
"""

from __future__ import annotations

import importlib
import json
import os
import pathlib
import subprocess
import warnings
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from . import _mcap

TOPICS = ("states", "sensors", "events", "commands")

Table = dict[str, Any]
"""Columns by their names, numpy arrays of one length."""

_RECORDING = b"CBRE\r\n\x1a\n"


def read(path: str | os.PathLike[str], topics: Iterable[str] = TOPICS) -> dict[str, Table]:
    """The tables of a file, by their topics: "states", "sensors", "events" and "commands" and, of
    MCAP, those of other channels if `topics` names them ("pose", "log").

    A column is of float64 or int64, of bool or, for text and lists of words, of objects. What is
    not known is nan, a column of whole numbers with gaps therefore of float64; in the others it is
    None. A topic without records is an empty table, a column without values is left out.

    An MCAP file that was not finished is read up to its last whole chunk, with a warning.
    ImportError if there is no numpy; OSError if the file cannot be read; ValueError if it is not
    such a file, or damaged. Blocks; holds all of it in memory.
    """
    numpy = _numpy()
    wanted = tuple(topics)
    columns: dict[str, dict[str, list[Any]]] = {topic: {} for topic in wanted}
    rows = dict.fromkeys(wanted, 0)
    for topic, record in _objects(pathlib.Path(path), wanted):
        if topic not in columns:
            continue
        table, row = columns[topic], rows[topic]
        for name, value in _flat(record):
            column = table.setdefault(name, [])
            column.extend([None] * (row - len(column)))
            column.append(value)
        rows[topic] = row + 1
    for topic, table in columns.items():
        for column in table.values():
            column.extend([None] * (rows[topic] - len(column)))
    return {topic: {name: _array(numpy, column) for name, column in table.items()}
            for topic, table in columns.items()}


def _numpy() -> Any:
    try:
        return importlib.import_module("numpy")
    except ImportError as error:
        raise ImportError("cargobay.tables makes numpy arrays, and numpy is not installed: apt-get "
                          "install python3-numpy, or pip install numpy") from error


def _objects(path: pathlib.Path,
             topics: tuple[str, ...]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    data = path.read_bytes()
    if data.startswith(_mcap.MAGIC):
        yield from _of_mcap(path, data, topics)
    elif data.startswith(_RECORDING):
        yield from _of_lines(path, _exported(path))
    elif data.lstrip()[:1] in (b"{", b""):
        yield from _of_lines(path, data)
    elif data.startswith(b"topic,"):
        raise ValueError(f"{path} is CSV: read it with pandas.read_csv(), or export MCAP or lines "
                         "of JSON instead: cargobay export REC --mcap FILE")
    else:
        raise ValueError(f"{path} is neither MCAP nor lines of JSON nor a recording")


def _of_mcap(path: pathlib.Path, data: bytes,
             topics: tuple[str, ...]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    try:
        file = _mcap.File(data)
    except _mcap.Damaged as error:
        raise _mcap.Damaged(f"{path} is damaged: {error}") from None
    if not file.finished:
        warnings.warn(f"{path} was not finished: read up to its last whole chunk", stacklevel=4)
    for message in file.messages():
        topic = message.topic.removeprefix("/")
        if topic in topics:
            yield topic, json.loads(message.json)


def _of_lines(path: pathlib.Path, data: bytes) -> Iterator[tuple[str, Mapping[str, Any]]]:
    for number, line in enumerate(data.splitlines(), 1):
        try:
            record = json.loads(line)
            yield str(record.pop("topic")), record
        except (ValueError, KeyError, AttributeError, TypeError):
            raise ValueError(f"{path} has no record in line {number}") from None


def _exported(path: pathlib.Path) -> bytes:
    command = os.environ.get("CARGOBAY_COMMAND", "cargobay")
    try:
        done = subprocess.run([command, "export", os.fspath(path.absolute()), "--jsonl", "-"],
                              capture_output=True, check=False)
    except FileNotFoundError:
        raise ValueError(f"{path} is a recording, which the command {command} exports: install it, "
                         "or read what it has exported elsewhere") from None
    said = done.stderr.decode(errors="replace").strip()
    if done.returncode != 0:
        raise ValueError(said or f"{command} export failed")
    if said:
        warnings.warn(said, stacklevel=5)
    return done.stdout


def _flat(record: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Members of members as `member.member`."""
    for name, value in record.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value


def _array(numpy: Any, column: list[Any]) -> Any:
    kinds = {type(value) for value in column}
    if kinds <= {int}:
        return numpy.array(column, dtype=numpy.int64)
    if kinds <= {int, float, type(None)}:
        return numpy.array(column, dtype=numpy.float64)  # None becomes nan
    if kinds <= {bool}:
        return numpy.array(column, dtype=numpy.bool_)
    objects = numpy.empty(len(column), dtype=object)
    for row, value in enumerate(column):  # as a whole, lists would become another dimension
        objects[row] = tuple(value) if isinstance(value, list) else value
    return objects
