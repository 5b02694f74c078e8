"""An FMU that is opened once and run many times: reset between runs, its loop compiled."""

from __future__ import annotations

import ctypes
import shutil
import tempfile
import weakref
from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit

from balance_diagnosis.errors import BalanceError
from balance_diagnosis.fmu.binding import unknown
from balance_diagnosis.fmu.optional import needed

ACCEPTED = 1
"""The largest status that is none of failure: fmi2Warning, fmi3Warning."""

KEPT = 3
"""Messages of the FMU that an error repeats at most."""

REALS = ("Real", "Float64")


class Unit:
    """One instance of an FMU. Co-simulation where it has that, else model exchange by FMPy's CVode.

    BalanceError: no FMU, no binary for this machine, what FMPy cannot open.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        fmpy = needed("fmpy")
        if not path.is_file():
            raise BalanceError(f"there is no file '{path}'")
        self.messages: deque[str] = deque(maxlen=KEPT)
        try:
            with path.open("rb") as opened:
                self.description = fmpy.read_model_description(opened, validate=False)
                platforms = fmpy.supported_platforms(opened)
        except Exception as error:
            raise BalanceError(f"'{path}' is no FMU that can be read: {_line(error)}") from None
        self._check(fmpy, platforms)
        self._folder = tempfile.mkdtemp(prefix="fmu-")
        weakref.finalize(self, shutil.rmtree, self._folder, ignore_errors=True)
        fmpy.extract(str(path), unzipdir=self._folder)
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.cosimulation = self.description.coSimulation is not None
        self._third = self.description.fmiVersion.startswith("3")
        self._instance: Any = None
        self._library: Any = None
        self._march: Any = None
        self._reset_works, self._tried = True, False

    def reference(self, name: str) -> int:
        """Return a variable's number; BalanceError where there is none, or it is no real number."""
        variable = self.variables.get(name)
        if variable is None:
            raise BalanceError(f"'{self.path}': {unknown(name, self.variables, 'variable')}")
        if variable.type not in REALS:
            raise BalanceError(
                f"'{self.path}': variable '{name}' is {variable.type}; only real ones can be bound"
            )
        return int(variable.valueReference)

    def settable(self, name: str) -> None:
        """Refuse a variable that no start value can be given to."""
        self.reference(name)
        variable = self.variables[name]
        fixed = variable.variability == "constant" or variable.initial == "calculated"
        if fixed or (variable.causality in ("output", "independent") and variable.initial is None):
            raise BalanceError(
                f"'{self.path}': variable '{name}' is computed by the FMU and cannot be set"
            )

    def run(
        self,
        values: Mapping[str, float],
        times: np.ndarray,
        inputs: Mapping[str, np.ndarray],
        outputs: Sequence[str],
        held: bool,
        steps: int,
    ) -> np.ndarray:
        """Return the outputs at every instant, (n, outputs).

        values: variables before the start. times: (n,) [s]; the FMU's own time begins at zero.
        inputs: variable to (n,). BalanceError with the FMU's own words where a call fails.
        """
        began = times - times[0]

        def once() -> np.ndarray:
            if not self.cosimulation:
                return self._exchanged(values, began, inputs, outputs)
            driven = np.zeros((len(times), len(inputs)))
            for k, signal in enumerate(inputs.values()):
                driven[:, k] = signal
            self._begin(values, list(inputs), driven[0])
            return self._marched(began, list(inputs), driven, outputs, held, steps)

        try:
            made = once()
            if not self._tried:
                self._tried = True
                self._reset_works = np.array_equal(made, once(), equal_nan=True)
            return made
        except BalanceError:
            self._drop()
            raise
        except Exception as error:
            self._drop()
            raise BalanceError(
                f"FMU '{self.path.name}' fails: {_line(error)}{self._said()}"
            ) from None

    def _check(self, fmpy: Any, platforms: Iterable[str]) -> None:
        version = self.description.fmiVersion
        if not version.startswith(("2", "3")):
            raise BalanceError(f"'{self.path}' is of FMI {version}; 2.0 and 3.0 can be run")
        if self.description.coSimulation is None and self.description.modelExchange is None:
            raise BalanceError(f"'{self.path}' has neither co-simulation nor model exchange")
        here = {fmpy.platform, fmpy.platform_tuple}
        if not here & set(platforms):
            raise BalanceError(
                f"'{self.path}' has no binary for {fmpy.platform}, only for "
                f"{', '.join(sorted(platforms)) or 'none'}: export it for this machine "
                "(one with sources: 'fmpy compile')"
            )

    def _drop(self) -> None:
        """Forget an instance that failed: after an error FMI allows little else."""
        self._instance = None

    def _open(self) -> Any:
        from fmpy.simulation import instantiate_fmu

        self._instance = instantiate_fmu(
            self._folder,
            self.description,
            "CoSimulation" if self.cosimulation else "ModelExchange",
            logger=lambda *told: self.messages.append(_text(told[-1])),
        )
        if self._library is None:
            # Held, since the compiled loop calls it: FMPy closes its own with each instance.
            self._library = ctypes.CDLL(self._instance.dll._name)
        return self._instance

    def _fresh(self) -> Any:
        """Return the instance as it was when it was made: a new one, if its reset is none."""
        if self._instance is None:
            return self._open()
        if self._reset_works:
            try:
                self._instance.reset()
                return self._instance
            except Exception:
                self._reset_works = False
        self._instance.freeInstance()
        return self._open()

    def _begin(self, values: Mapping[str, float], inputs: Sequence[str], first: np.ndarray) -> None:
        fmu = self._fresh()
        references = [self.reference(name) for name in values]
        drive = [self.reference(name) for name in inputs]
        put = fmu.setFloat64 if self._third else fmu.setReal
        put(references, list(values.values()))
        if self._third:
            fmu.enterInitializationMode(startTime=0.0, stopTime=None)
        else:
            fmu.setupExperiment(startTime=0.0, stopTime=None)
            fmu.enterInitializationMode()
        if drive:
            put(drive, list(first))
        fmu.exitInitializationMode()

    def _marched(
        self,
        times: np.ndarray,
        inputs: Sequence[str],
        driven: np.ndarray,
        outputs: Sequence[str],
        held: bool,
        steps: int,
    ) -> np.ndarray:
        if self._march is None:
            self._march = _compiled(self._library, self._third)
        path = np.empty((len(times), len(outputs)))
        drive = np.array([self.reference(name) for name in inputs], np.uint32)
        told = np.array([self.reference(name) for name in outputs], np.uint32)
        component = self._instance.component
        component = getattr(component, "value", component)
        at, status = self._march(component, times, drive, driven, told, path, held, steps)
        if status > ACCEPTED:
            why = f"with status {status}{self._said()}"
            raise BalanceError(f"FMU '{self.path.name}' fails at {times[at]:g} s {why}")
        return path

    def _exchanged(
        self,
        values: Mapping[str, float],
        times: np.ndarray,
        inputs: Mapping[str, np.ndarray],
        outputs: Sequence[str],
    ) -> np.ndarray:
        """Run model exchange in FMPy, and return the outputs at the instants."""
        from fmpy import simulate_fmu

        kinds = [("time", float), *((name, float) for name in inputs)]
        signals = np.array(list(zip(times, *inputs.values(), strict=True)), kinds)
        made = simulate_fmu(
            self._folder,
            validate=False,
            fmi_type="ModelExchange",
            start_time=0.0,
            stop_time=float(times[-1]),
            output_interval=float(np.median(np.diff(times))),
            record_events=False,
            start_values=dict(values),
            input=signals if inputs else None,
            output=list(outputs),
            model_description=self.description,
            fmu_instance=self._fresh(),
            terminate=False,
        )
        return np.stack([np.interp(times, made["time"], made[name]) for name in outputs], axis=1)

    def _said(self) -> str:
        return f" ({'; '.join(self.messages)})" if self.messages else ""


def _compiled(dll: Any, third: bool) -> Any:
    """Return the loop over the samples, compiled about the FMU's own functions."""
    word, real, whole = ctypes.c_ssize_t, ctypes.c_double, ctypes.c_int
    names = ("fmi3SetFloat64", "fmi3GetFloat64") if third else ("fmi2SetReal", "fmi2GetReal")
    sizes = (word, word, word, word, word) if third else (word, word, word, word)
    put, get = (_function(dll, name, whole, *sizes) for name in names)
    if third:
        step3 = _function(
            dll, "fmi3DoStep", whole, word, real, real, ctypes.c_bool, word, word, word, word
        )
    else:
        step2 = _function(dll, "fmi2DoStep", whole, word, real, real, whole)

    if third:

        @njit
        def put_in(c: Any, refs: Any, values: Any) -> Any:
            n = len(refs)
            return put(c, refs.ctypes.data, n, values.ctypes.data, n) if n else 0

        @njit
        def get_out(c: Any, refs: Any, values: Any) -> Any:
            n = len(refs)
            return get(c, refs.ctypes.data, n, values.ctypes.data, n)

        @njit
        def step(c: Any, time: Any, size: Any) -> Any:
            flags, reached = np.zeros(3, np.bool_), np.zeros(1)
            f = flags.ctypes.data
            return step3(c, time, size, True, f, f + 1, f + 2, reached.ctypes.data)

    else:

        @njit
        def put_in(c: Any, refs: Any, values: Any) -> Any:
            n = len(refs)
            return put(c, refs.ctypes.data, n, values.ctypes.data) if n else 0

        @njit
        def get_out(c: Any, refs: Any, values: Any) -> Any:
            return get(c, refs.ctypes.data, len(refs), values.ctypes.data)

        @njit
        def step(c: Any, time: Any, size: Any) -> Any:
            return step2(c, time, size, 1)

    @njit
    def march(
        c: Any, times: Any, drive: Any, driven: Any, told: Any, path: Any, held: Any, steps: Any
    ) -> Any:
        row, made, worst = np.empty(len(drive)), np.empty(len(told)), 0
        for t in range(len(times)):
            for s in range(steps if t else 0):
                share = 0.0 if held else (s + 0.5) / steps
                for k in range(len(drive)):
                    row[k] = driven[t - 1, k] + share * (driven[t, k] - driven[t - 1, k])
                size = (times[t] - times[t - 1]) / steps
                worst = max(put_in(c, drive, row), step(c, times[t - 1] + s * size, size))
                if worst > 1:
                    return t, worst
            for k in range(len(drive)):
                row[k] = driven[t, k]
            worst = max(put_in(c, drive, row), get_out(c, told, made))
            if worst > 1:
                return t, worst
            for k in range(len(told)):
                path[t, k] = made[k]
        return len(times) - 1, worst

    return march


def _function(dll: Any, name: str, result: Any, *arguments: Any) -> Any:
    """Return a function of the FMU with plain types, as compiled code calls it."""
    address = ctypes.cast(getattr(dll, name), ctypes.c_void_p).value or 0
    return ctypes.CFUNCTYPE(result, *arguments)(address)


def _text(told: Any) -> str:
    text = told.decode("utf-8", "replace") if isinstance(told, bytes) else str(told)
    return " ".join(text.split())


def _line(error: Exception) -> str:
    return _text(error) or type(error).__name__
