"""Pareto fronts of step time against solenoid force, by the source's method and by NSGA-II."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from pressure_control.valve_design.complex_rf import complex_rf
from pressure_control.valve_design.problem import (
    LOWER,
    PENALTY,
    UPPER,
    DesignProblem,
    Evaluation,
)
from steering_core.parameters import ParameterSet

WEIGHTS = 21
EVALUATIONS = 350
TIME_SCALE, FORCE_SCALE = 1.0 / 0.010, 1.0 / 40.0
"""k_1 and k_2 of 6.1: a step of 10 ms weighs like 40 N."""

POPULATION, GENERATIONS, ISLANDS = 40, 40, 2


@dataclass(frozen=True)
class Front:
    """Feasible designs of which none is beaten in both objectives, by rising step time.

    designs (n, 4) in the variables' order, SI; step_times (n,) [s]; forces (n,) [N].
    """

    method: str
    designs: np.ndarray
    step_times: np.ndarray
    forces: np.ndarray
    evaluations: int


Progress = Callable[[float, str], None]


def weights(j: float) -> tuple[float, float]:
    """Return e_1 and e_2 of 6.4 and 6.5 for j from 0 to 1."""
    e2 = float(np.exp(-3.5 * j))
    return 1.0 - e2, e2


def weighted(found: Evaluation, j: float) -> float:
    """Return the objective of 6.1: weighted, normalised, with its six penalties."""
    e1, e2 = weights(j)
    penalties = found.penalties
    violated = float(np.sum(penalties) + 0.1 * np.count_nonzero(penalties))
    value = e1 * TIME_SCALE * found.step_time + e2 * FORCE_SCALE * found.force
    return value + PENALTY * violated


def complex_front(
    parameters: ParameterSet,
    seed: int,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Front:
    """Return the front of the source's method: one Complex-RF search for each of 21 weights."""
    jobs = [(parameters, float(j), seed + k) for k, j in enumerate(np.linspace(0, 1, WEIGHTS))]
    made = executor.map(_search, jobs) if executor else map(_search, jobs)
    return _front("Complex-RF", _counted(made, len(jobs), progress, "Complex-RF"))


def nsga_front(
    parameters: ParameterSet,
    seed: int,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Front:
    """Return the front of NSGA-II (Deb et al., IEEE Trans. Evol. Comp. 6, 2002), from pymoo.

    Several islands search on their own, so that processes share no state.
    """
    jobs = [(parameters, seed + k) for k in range(ISLANDS)]
    made = executor.map(_evolve, jobs) if executor else map(_evolve, jobs)
    return _front("NSGA-II", _counted(made, len(jobs), progress, "NSGA-II"))


Found = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Designs (n, 4), objectives (n, 2) and feasibility (n,) of everything a search evaluated."""


def _search(job: tuple[ParameterSet, float, int]) -> Found:
    parameters, j, seed = job
    problem = DesignProblem(parameters)
    seen: list[tuple[np.ndarray, Evaluation]] = []

    def objective(design: np.ndarray) -> float:
        found = problem.evaluate(design)
        seen.append((design.copy(), found))
        return weighted(found, j)

    complex_rf(objective, LOWER, UPPER, np.random.default_rng(seed), most_evaluations=EVALUATIONS)
    return _stacked(seen)


def _evolve(job: tuple[ParameterSet, int]) -> Found:
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import ElementwiseProblem
    from pymoo.optimize import minimize

    parameters, seed = job
    problem = DesignProblem(parameters)
    seen: list[tuple[np.ndarray, Evaluation]] = []

    class Design(ElementwiseProblem):
        def __init__(self) -> None:
            super().__init__(n_var=len(LOWER), n_obj=2, n_ieq_constr=6, xl=LOWER, xu=UPPER)

        def _evaluate(self, x: np.ndarray, out: dict[str, object], *args: object) -> None:
            found = problem.evaluate(x)
            seen.append((x.copy(), found))
            out["F"] = [TIME_SCALE * found.step_time, FORCE_SCALE * found.force]
            out["G"] = found.penalties

    minimize(Design(), NSGA2(pop_size=POPULATION), ("n_gen", GENERATIONS), seed=seed, verbose=False)
    return _stacked(seen)


def _stacked(seen: list[tuple[np.ndarray, Evaluation]]) -> Found:
    designs = np.array([design for design, _ in seen])
    objectives = np.array([(found.step_time, found.force) for _, found in seen])
    return designs, objectives, np.array([found.feasible for _, found in seen])


def _counted(
    made: Iterable[Found], count: int, progress: Progress | None, what: str
) -> Iterable[Found]:
    for done, found in enumerate(made, start=1):
        if progress is not None:
            progress(done / count, what)
        yield found


def _front(method: str, parts: Iterable[Found]) -> Front:
    found = list(parts)
    designs = np.concatenate([d for d, _, _ in found])
    objectives = np.concatenate([o for _, o, _ in found])
    feasible = np.concatenate([f for _, _, f in found])
    kept = np.flatnonzero(feasible)[undominated(objectives[feasible])]
    kept = kept[np.argsort(objectives[kept, 0], kind="stable")]
    return Front(method, designs[kept], objectives[kept, 0], objectives[kept, 1], len(designs))


def undominated(objectives: np.ndarray) -> np.ndarray:
    """Return the positions of points (n, 2) that no other one beats in both, by rising first."""
    order = np.lexsort((objectives[:, 1], objectives[:, 0]))
    least = np.minimum.accumulate(objectives[order, 1])
    first = np.concatenate([[True], objectives[order[1:], 1] < least[:-1]])
    return order[first] if len(order) else order


def distance_to(front: Front, step_time: float, force: float) -> float:
    """Return by which factor both of a design's objectives could shrink before meeting a front.

    1: on it; above 1: the front holds a design better in both by that factor.
    """
    ratios = np.minimum(step_time / front.step_times, force / front.forces)
    return float(np.max(ratios)) if len(ratios) else 0.0
