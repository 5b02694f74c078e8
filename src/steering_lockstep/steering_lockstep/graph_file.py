"""A checked graph, and what its nodes must know, as a JSON file for nodes started one by one. Pure.

The file is all that another computer needs beside the software: it names no path.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from steering_lockstep.graph import Graph, GraphError, NodeSpec, check_graph
from steering_lockstep.names import Names
from steering_lockstep.settings import RunSettings


def write_graph(graph: Graph, path: str | Path) -> None:
    """Write ``graph`` to ``path``."""
    _write({"nodes": _nodes(graph)}, path)


def write_run(
    run: RunSettings, parameters: Mapping[str, Mapping[str, Any]], path: str | Path
) -> None:
    """Write a run's graph, length, rest values and parameters {node: {ROS parameter: value}}."""
    content = {
        "nodes": _nodes(run.graph),
        "ticks": run.ticks,
        "real_time": run.real_time,
        "urgent": run.urgent,
        "wait_for": sorted(run.wait_for),
        "rest": {name: list(values) for name, values in run.rest.items()},
        "namespace": run.names.namespace,
        "remaps": dict(run.names.remaps),
        "parameters": {name: dict(values) for name, values in parameters.items()},
    }
    _write(content, path)


def read_graph(path: str | Path) -> Graph:
    """Return the graph in ``path``; raises ``GraphError`` for a file that holds none."""
    return _graph(_read(path), path)


def read_run(
    path: str | Path, ticks: int | None = None, real_time: bool = False
) -> tuple[RunSettings, dict[str, dict[str, Any]]]:
    """Return (settings, parameters by node) of a file; raises ``GraphError``.

    ``ticks``: another length, which a file of ``write_graph`` lacks; ``real_time``: in any case.
    """
    content = _read(path)
    graph = _graph(content, path)
    if ticks is None and "ticks" not in content:
        raise GraphError(f"'{path}' does not tell the length of the run: give --ticks")
    try:
        rest: dict[str, Sequence[float]] = dict(content.get("rest", {}))
        names = Names(content.get("namespace", ""), dict(content.get("remaps", {})))
        settings = RunSettings(
            graph,
            int(content["ticks"] if ticks is None else ticks),
            rest,
            real_time or bool(content.get("real_time", False)),
            bool(content.get("urgent", False)),
            names=names,
            wait_for=frozenset(content.get("wait_for", ())),
        )
        given = content.get("parameters", {})
        parameters = {name: dict(values) for name, values in given.items()}
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise GraphError(f"no run in '{path}': {type(error).__name__}: {error}") from None
    return settings, parameters


def _nodes(graph: Graph) -> list[dict[str, Any]]:
    return [
        {
            "name": node.name,
            "kind": node.kind,
            "inputs": dict(node.inputs),
            "outputs": list(node.outputs),
            "period": node.period,
        }
        for node in graph.nodes
    ]


def _write(content: Mapping[str, Any], path: str | Path) -> None:
    Path(path).write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def _read(path: str | Path) -> Any:
    try:
        return json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise GraphError(f"no graph in '{path}': {type(error).__name__}: {error}") from None


def _graph(content: Any, path: str | Path) -> Graph:
    try:
        nodes = [
            NodeSpec(n["name"], n["kind"], n["inputs"], tuple(n["outputs"]), n.get("period", 1))
            for n in content["nodes"]
        ]
    except (ValueError, KeyError, TypeError) as error:
        raise GraphError(f"no graph in '{path}': {type(error).__name__}: {error}") from None
    return check_graph(nodes)
