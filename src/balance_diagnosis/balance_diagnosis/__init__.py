"""Names what a model of any machine gets wrong: see docs/balance_diagnosis.md."""

from balance_diagnosis.diagnosis import Diagnosis, diagnose
from balance_diagnosis.model import Cause, Model, Values
from balance_diagnosis.ode import ode
from balance_diagnosis.priors import between, toleranced
from balance_diagnosis.record import Record

__all__ = [
    "Cause",
    "Diagnosis",
    "Model",
    "Record",
    "Values",
    "between",
    "diagnose",
    "ode",
    "toleranced",
]
