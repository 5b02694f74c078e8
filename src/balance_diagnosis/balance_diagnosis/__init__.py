"""Names what a model of any machine gets wrong: see docs/own_machine.md."""

from balance_diagnosis.calibration import Rates, calibrate
from balance_diagnosis.diagnosis import Diagnosis, diagnose
from balance_diagnosis.errors import BalanceError
from balance_diagnosis.extended import Extended
from balance_diagnosis.model import Cause, Model, Values
from balance_diagnosis.ode import ode
from balance_diagnosis.priors import between, toleranced
from balance_diagnosis.record import Record

__all__ = [
    "BalanceError",
    "Cause",
    "Diagnosis",
    "Extended",
    "Model",
    "Rates",
    "Record",
    "Values",
    "between",
    "calibrate",
    "diagnose",
    "ode",
    "toleranced",
]
