"""A model of another tool under diagnosis: a functional mock-up unit (FMI 2 or 3) and one YAML.

Needs FMPy and PyYAML: ``pip install "balance_diagnosis[fmu]"``.
"""

from balance_diagnosis.fmu.model import FmuModel

__all__ = ["FmuModel"]
