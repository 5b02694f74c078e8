"""YAML as plain data, by libyaml where PyYAML has it: a tenth of the time, for own files."""

from __future__ import annotations

from typing import Any

import yaml

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def plain(text: str) -> Any:
    """Return the data of one YAML document. yaml.YAMLError: it is none."""
    return yaml.load(text, Loader=LOADER)
