"""A two-stage pressure control valve: a small pilot trims the main spool that carries the flow.

The main spool balances the pilot's pressure against the load, P_p A - P_l A = K x + F_0 + ..., so
it answers at once, in proportion. The pilot is the single-stage valve, but its control chamber
senses the load, not its own outlet: it goes on filling the pilot volume until the load is right.
Linear, with C = V/beta of the load, C_p of the pilot volume and g = A_c K_qp/K_ep of the pilot:

    L(s) = w_c/(s + w_s) (1 + w_i/s) / (1 + 2 d s/w + s^2/w^2)
    w_c = A K_q/(K_e C) C_p/C_t,  w_i = g/C_p,  w_s = K_c/C,  C_t = C_p + A^2/K_e,  w^2 = K_e/m

One integration above w_i, two below: stable with margin if w_i < w_c < w/3 or so. At rest nothing
of the main stage's spring or flow force is left in the pressure, only the pilot's small opening.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from steering_core.compiled import kernel
from steering_core.parameters import ParameterSet
from steering_plant.control_valve import holes_area
from steering_plant.model import chamber
from steering_plant.model.closed_centre import spool_stop_force, valve_rates
from steering_plant.model.states import CONTROL, LEFT, LEFT_VALVE, SPOOL, SPOOL_SPEED
from steering_plant.orifice import orifice_flow
from steering_plant.plant import plant_record

PILOT = LEFT
MAIN, MAIN_SPEED, LOAD = 13, 14, 15
"""States behind the pilot's: main spool [m] and its speed [m/s], load pressure [Pa]."""

STATES = 16
STEP_H = 1e-5
NO_EFFECTS = np.zeros(0)


@dataclass(frozen=True)
class MainStage:
    """Sizes of the main stage, SI, chosen from the linear loop gain.

    end_area: of each end; hole_diameter of its four holes an edge; pilot_volume: between the
    stages. spring, preload: at centre, towards the tank edge; damping: restrictors at both ends.
    """

    end_area: float = 1.0e-5
    spring: float = 6.0e4
    preload: float = 45.0
    mass: float = 0.015
    damping: float = 60.0
    hole_diameter: float = 4.5e-3
    underlap: float = 5.0e-6
    pilot_volume: float = 1.0e-5


HEAVY_VEHICLE = MainStage(end_area=2.0e-5, preload=90.0, hole_diameter=6.0e-3, pilot_volume=2.0e-5)
"""For the parameter set heavy_vehicle: its chambers are seven times as large."""

PILOT_SIZES = {
    "pressure_control_valve.spring_stiffness": 1.5e5,
    "pressure_control_valve.hole_diameter": 0.8e-3,
}
"""The pilot where it differs from the data sheet's single-stage valve."""


@kernel
def two_stage_rates(p, m, y, dy, force, load_flow, e):
    """Fill the rates of pilot, main spool and load; ``load_flow`` [m3/s] leaves the load.

    p: plant's record, with the pilot's sizes. m: record of a MainStage.
    """
    pilot, load = y[PILOT], y[LOAD]
    spool, speed = y[MAIN], y[MAIN_SPEED]
    supply = p.supply_pressure
    _, net = valve_rates(p, y, dy, LEFT_VALVE, pilot, supply, force, 0.0, e)

    # Computed there for a control chamber on the pilot's own outlet; it hangs on the load instead.
    control = y[LEFT_VALVE + CONTROL]
    conductance, laminar = p.damping_orifice_conductance, p.damping_orifice_transition_pressure
    net += orifice_flow(conductance, pilot - control, laminar)
    sensed = orifice_flow(conductance, load - control, laminar)
    into_control = sensed + p.pressure_area * y[LEFT_VALVE + SPOOL_SPEED]
    control_rate = chamber.stiffness(p, control, y, e) / p.control_chamber_volume
    dy[LEFT_VALVE + CONTROL] = control_rate * into_control

    inlet = holes_area(m.hole_diameter, spool + m.underlap)
    outlet = holes_area(m.hole_diameter, m.underlap - spool)
    constant, transition = p.orifice_constant, p.laminar_transition_pressure
    flow = orifice_flow(constant * inlet, supply - load, transition)
    flow -= orifice_flow(constant * outlet, load, transition)
    jet = 2.0 * p.flow_coefficient * p.jet_angle_cosine
    closing = jet * (inlet * abs(supply - load) - outlet * abs(load))
    driving = (pilot - load) * m.end_area - m.preload - m.spring * spool - m.damping * speed
    driving -= closing + spool_stop_force(p, spool, speed)

    swept = m.end_area * speed
    dy[PILOT] = chamber.stiffness(p, pilot, y, e) / m.pilot_volume * (net - swept)
    dy[MAIN] = speed
    dy[MAIN_SPEED] = driving / m.mass
    load_rate = chamber.stiffness(p, load, y, e) / p.chamber_volume
    dy[LOAD] = load_rate * (flow + swept - sensed - load_flow)


@kernel
def simulate(par, sizes, start, force, load_flow, ramp, step, work, out, e):
    """Fill ``out`` (n,) with the load pressure [Pa] under a constant force [N].

    start: states (16,). load_flow [m3/s] comes in over ``ramp`` steps. work: (6, 16).
    """
    p, m = par[0], sizes[0]
    y, at, k1, k2, k3, k4 = work[0], work[1], work[2], work[3], work[4], work[5]
    for j in range(STATES):
        y[j] = start[j]
    for i in range(out.shape[0]):
        out[i] = y[LOAD]
        flow = load_flow * min(i / ramp, 1.0)
        two_stage_rates(p, m, y, k1, force, flow, e)
        for j in range(STATES):
            at[j] = y[j] + 0.5 * step * k1[j]
        two_stage_rates(p, m, at, k2, force, flow, e)
        for j in range(STATES):
            at[j] = y[j] + 0.5 * step * k2[j]
        two_stage_rates(p, m, at, k3, force, flow, e)
        for j in range(STATES):
            at[j] = y[j] + step * k3[j]
        two_stage_rates(p, m, at, k4, force, flow, e)
        for j in range(STATES):
            y[j] += step / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j])


@dataclass(frozen=True)
class Corners:
    """w_c, w_i, w and w_s of the module's L(s) [rad/s]."""

    crossover: float
    integral: float
    spool: float
    load: float


class TwoStageValve:
    """Pilot and main stage at a chamber of the data sheet's volume, piston held or moving."""

    def __init__(self, parameters: ParameterSet, main: MainStage | None = None) -> None:
        self.par = plant_record(parameters.with_values(PILOT_SIZES), "closed_centre")
        values = asdict(main or MainStage())
        self.sizes = np.array([tuple(values.values())], [(name, float) for name in values])

    def force(self, reference: float) -> float:
        """Return the solenoid force [N] for a reference pressure [Pa]: p_ref A_c + f_0."""
        p = self.par[0]
        return float(reference * p["pressure_area"] + p["spring_preload"])

    def rest(self, pressure: float) -> np.ndarray:
        """Return the states (16,) near rest at a load pressure [Pa], spools in the middle."""
        y = np.zeros(STATES)
        y[LOAD] = y[LEFT_VALVE + CONTROL] = pressure
        y[PILOT] = pressure + self.sizes[0]["preload"] / self.sizes[0]["end_area"]
        return y

    def run(
        self, start: np.ndarray, reference: float, flow: float = 0.0, time: float = 0.2
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return load pressures [Pa] every 10 us (n,), and the last states (16,).

        flow [m3/s] out of the load, from zero over 50 ms.
        """
        out, work = np.empty(round(time / STEP_H) + 1), np.zeros((6, STATES))
        ramp = 0.05 / STEP_H
        simulate(self.par, self.sizes, start, self.force(reference), flow, ramp, STEP_H, work, out,
                 NO_EFFECTS)  # fmt: skip
        return out, work[0].copy()

    def drawn(self, y: np.ndarray, reference: float) -> float:
        """Return the flow [m3/s] that both stages draw from the supply at given states."""
        p, m, work = self.par[0], self.sizes[0], np.zeros(STATES)
        supply = float(p["supply_pressure"])
        pilot, _ = valve_rates(
            p, y, work, LEFT_VALVE, y[PILOT], supply, self.force(reference), 0.0, NO_EFFECTS
        )
        area = holes_area(m["hole_diameter"], y[MAIN] + m["underlap"])
        constant, transition = p["orifice_constant"], p["laminar_transition_pressure"]
        return float(pilot + orifice_flow(constant * area, supply - y[LOAD], transition))

    def corners(self, y: np.ndarray, reference: float, flow: float) -> Corners:
        """Return the corners of the module's L(s) at states of rest."""
        p, m, J = self.par[0], self.sizes[0], self.jacobian(y, reference, flow)
        stiffness = -J[MAIN_SPEED, MAIN] * m["mass"]
        pilot = J[PILOT, LEFT_VALVE + SPOOL] / -J[LEFT_VALVE + SPOOL_SPEED, LEFT_VALVE + SPOOL]
        capacity = m["pilot_volume"] / p["bulk_modulus"]
        share = capacity / (capacity + m["end_area"] ** 2 / stiffness)
        return Corners(
            float(m["end_area"] / stiffness * J[LOAD, MAIN] * share),
            float(pilot * p["pressure_area"] / p["spool_mass"]),
            float(np.sqrt(stiffness / m["mass"])),
            float(-J[LOAD, LOAD]),
        )

    def loop_gain(
        self, y: np.ndarray, reference: float, flow: float, hertz: np.ndarray
    ) -> np.ndarray:
        """Return the loop gain (n,) at states of rest, opened at the main spool's flow.

        From the nonlinear rates by central differences, every lag included.
        """
        J = self.jacobian(y, reference, flow)
        opened = J.copy()
        opened[LOAD, MAIN] = 0.0
        used = [PILOT, *range(LEFT_VALVE, LEFT_VALVE + 3), MAIN, MAIN_SPEED, LOAD]
        opened = opened[np.ix_(used, used)]
        last, main = used.index(LOAD), used.index(MAIN)
        unit = np.zeros(len(used))
        unit[last] = 1.0
        s = 2j * np.pi * hertz
        found = [np.linalg.solve(v * np.eye(len(used)) - opened, unit)[main] for v in s]
        return -J[LOAD, MAIN] * np.array(found)

    def jacobian(self, y: np.ndarray, reference: float, flow: float) -> np.ndarray:
        """Return d(rates)/d(states) (16, 16), by central differences."""
        J = np.zeros((STATES, STATES))
        sizes = {PILOT: 1e2, LEFT_VALVE + CONTROL: 1e2, LOAD: 1e2, LEFT_VALVE + SPOOL: 1e-8,
                 MAIN: 1e-8, LEFT_VALVE + SPOOL_SPEED: 1e-6, MAIN_SPEED: 1e-6}  # fmt: skip
        for j, size in sizes.items():
            rates = np.zeros((2, STATES))
            for k, sign in enumerate((1.0, -1.0)):
                at = y.copy()
                at[j] += sign * size
                two_stage_rates(self.par[0], self.sizes[0], at, rates[k], self.force(reference),
                                flow, NO_EFFECTS)  # fmt: skip
            J[:, j] = (rates[0] - rates[1]) / (2.0 * size)
        return J
