"""A checked graph as a JSON file, for nodes that are started one by one. Pure."""

from __future__ import annotations

import json
from pathlib import Path

from steering_lockstep.graph import Graph, GraphError, NodeSpec, check_graph


def write_graph(graph: Graph, path: str | Path) -> None:
    """Write ``graph`` to ``path``."""
    nodes = [
        {
            "name": node.name,
            "kind": node.kind,
            "inputs": dict(node.inputs),
            "outputs": list(node.outputs),
            "period": node.period,
        }
        for node in graph.nodes
    ]
    Path(path).write_text(json.dumps({"nodes": nodes}, indent=2) + "\n", encoding="utf-8")


def read_graph(path: str | Path) -> Graph:
    """Return the graph in ``path``; raises ``GraphError`` for a file that holds none."""
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        nodes = [
            NodeSpec(n["name"], n["kind"], n["inputs"], tuple(n["outputs"]), n.get("period", 1))
            for n in content["nodes"]
        ]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise GraphError(f"no graph in '{path}': {type(error).__name__}: {error}") from None
    return check_graph(nodes)
