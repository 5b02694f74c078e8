"""The project's benchmarks: program, smallest size, figures and their targets."""

from __future__ import annotations

from steering_bringup.benchmarking.rows import Benchmark, Row

SYSTEMS = {"open_centre": "open centre", "closed_centre": "closed centre"}
WAYS = {"graph": "whole graph", "bare": "bridge alone"}
LINKS = {"udp": "UDP", "can": "CAN"}

DIRECT = (
    Row("ratio_to_lsoda", "plant against solve_ivp's LSODA, same accuracy", "times", at_least=40.0),
    Row("whole_loop_to_lsoda", "the same, charged with the whole loop", "times"),
    Row("ratio_to_class", "plant against the bare class LSODA", "times"),
    Row("ratio_to_odeint", "plant against odeint", "times"),
    Row("pressure_error", "error of the chamber pressures", "bar", at_most=0.01),
    Row("state_error", "worst state's error over its range"),
    Row("real_time", "whole loop against real time", "times"),
    Row("memory", "memory beside the trace", "kB"),
    Row("memory_growth", "the same of five times the length", "times", at_most=1.5),
)

EFFECTS = tuple(
    Row(f"{system}_ratio", f"{name}: all effects against the nominal model", "times", at_most=1.5)
    for system, name in SYSTEMS.items()
)

GRAPH = (
    Row("one_to_default", "one process: faster than rclpy's executor", "times", at_least=5.0),
    Row("each_to_default", "a process each: faster than rclpy's executor", "times", at_least=4.0),
    Row("one_to_bare", "one process: a tick against bare messages", "times", at_most=1.5),
    Row("each_to_bare", "a process each: a tick against bare messages", "times", at_most=1.5),
    Row("one_recording", "one process: a tick recorded against not", "times", at_most=1.6),
    Row("each_recording", "a process each: a tick recorded against not", "times", at_most=1.25),
    Row("one_real_time", "one process against real time", "times"),
    Row("each_real_time", "a process each against real time", "times"),
    Row("one_recording_real_time", "one process, recording, against real time", "times"),
    Row("each_recording_real_time", "a process each, recording, against real time", "times"),
    Row("lost", "messages lost in all runs", at_most=0.0, digits=0),
)
"""Recording may cost what 4.0 and 2.5, 1.5 and 1.2 times real time differ by."""

REPLAY = tuple(
    row
    for system, name in SYSTEMS.items()
    for row in (
        Row(f"{system}_to_run", f"{name}: a replay against the run itself", "times", at_most=3.0),
        Row(f"{system}_sensors", f"{name}: sensors alone are faster by", "times", at_least=2.0),
        Row(f"{system}_real_time", f"{name}: a replay against real time", "times"),
    )
)

RIG = tuple(
    row
    for way, way_name in WAYS.items()
    for link, link_name in LINKS.items()
    for row in (
        Row(f"{way}_{link}_p50", f"{way_name}, {link_name}: latency, median", "us", digits=3),
        Row(f"{way}_{link}_p99", f"{way_name}, {link_name}: latency, 99 %", "us", digits=3),
        Row(f"{way}_{link}_late", f"{way_name}, {link_name}: late ticks", "%"),
        Row(
            f"{way}_{link}_beyond",
            f"{way_name}, {link_name}: late beyond a process that only sleeps",
            "%",
            at_most=0.1,
        ),
        Row(f"{way}_{link}_lost", f"{way_name}, {link_name}: frames lost", digits=0),
    )
)

TRUST = tuple(
    row
    for link, name in LINKS.items()
    for row in (
        Row(f"{link}_without", f"{name}: the bench's part of a tick without a key", "us"),
        Row(f"{link}_with", f"{name}: the same with a key", "us"),
        Row(f"{link}_cost", f"{name}: what the key costs a tick", "us", at_most=20.0),
    )
)
"""The limit is a time, as the period is: 2 % of 1 ms."""

RECORDING = (
    Row("lost", "messages lost, recorded or played", at_most=0.0, digits=0),
    Row("recorded", "messages recorded", digits=0),
    Row("heard", "messages heard of the playback", digits=0),
)

MUTANTS = (
    Row("alive", "broken sources that no test notices", at_most=0.0, digits=0),
    Row("tried", "broken sources tried", digits=0),
)

MISTAKES = {
    "sign": "wrong sign",
    "magnitude": "magnitude without its sign (the sign is another channel)",
    "degrees": "angle in degrees for radians, or the other way",
    "degrees_and_sign": "angle in degrees for radians, and the wrong sign",
    "ten": "off by 10: angle, position, torque, force",
    "bar_mpa": "all pressures in bar for MPa, or the other way",
    "one_bar_mpa": "one pressure in bar for MPa",
    "thousand": "mm for m, kN for N, mN m for N m",
    "bar_pa": "pressures in bar for Pa (1e5)",
    "imperial": "psi for bar, inch for m",
    "kilopond": "load cell in kgf or lbf for N",
    "speeds": "speeds in deg/s, rpm, km/h, mm/s, or of the wrong sign",
    "swapped": "swapped: chambers, chamber and supply, angle and its speed",
    "copied": "one channel twice",
    "late": "0.1 s or 0.3 s late",
    "ac_coupled": "AC-coupled, 0.3 s or 1 s",
    "ratio": "rack position by another pinion ratio (0.75, 1.3)",
    "road_wheel": "angle of the road wheel",
    "reduction": "torque behind a reduction",
    "absolute": "absolute pressures for gauge",
    "zero": "angle or position never zeroed",
    "wrapped": "a counter that wraps",
    "clipped": "clipped at 70 % of what it reaches",
    "stuck": "frozen for 1.2 s",
    "dead": "dead: constant",
    "lost": "-999 for no measurement",
}
"""Kinds of tests/support/rig_mistakes.py."""

NOT_IN_A_RIG = {"speeds"}

FLEET = (
    Row("bar", "stiffer bar of all named as common", at_least=1.0, digits=0),
    Row("bar_value", "the bar's stiffness over the data sheet's, drawn 5 %", "%"),
    Row("leaks", "specimens with a leak named with it alone", "%", at_least=100.0, digits=0),
    Row("wrong_single", "specimens with another single cause", at_most=0.0, digits=0),
    Row("wrong_common", "other common causes or shifts", at_most=0.0, digits=0),
    Row("failed", "specimens that could not be judged", at_most=0.0, digits=0),
)

RIG_MISTAKES = (
    Row("clean", "clean records in which something is suspected", "%", at_most=0.0),
    Row("effects", "records of large effects in which something is suspected", "%", at_most=0.0),
    Row("named_all", "mistakes suspected by name; all channels", "%", at_least=75.0),
    Row("named_rig", "mistakes suspected by name; a rig's seven channels", "%", at_least=75.0),
    *(
        Row(f"{kind}_{name}", f"{what}; {channels}", "%", digits=0)
        for kind, what in MISTAKES.items()
        for name, channels in (("all", "all channels"), ("rig", "a rig's seven"))
        if name == "all" or kind not in NOT_IN_A_RIG
    ),
)

BENCHMARKS: dict[str, Benchmark] = {
    entry.name: entry
    for entry in (
        Benchmark(
            "direct_speed",
            "the direct runner against LSODA and real time",
            DIRECT,
            {"duration": 1.0, "repetitions": 1, "stretches": 1},
            ros=False,
        ),
        Benchmark(
            "effects_speed",
            "the model of all effects against the nominal one",
            EFFECTS,
            {"repetitions": 2, "systems": ["closed_centre"]},
            ros=False,
        ),
        Benchmark(
            "graph_speed",
            "the graph over DDS against rclpy's executor and bare messages",
            GRAPH,
            {"ticks": 200, "rounds": 1, "layouts": ["one"]},
        ),
        Benchmark(
            "replay_speed",
            "the replay of the diagnosis against the run itself",
            REPLAY,
            {"seconds": 2.0, "calls": 2, "systems": ["closed_centre"]},
            ros=False,
        ),
        Benchmark(
            "rig_link",
            "latency of the rig bridge at 1 kHz",
            RIG,
            {"seconds": 1.0, "links": ["udp"], "ways": ["bare"]},
        ),
        Benchmark(
            "rig_trust",
            "what a rig's key costs in a tick",
            TRUST,
            {"ticks": 200, "rounds": 3},
            ros=False,
        ),
        Benchmark(
            "record_while_playing",
            "what is lost while a bag is played and another recorded",
            RECORDING,
            {"seconds": 2.0},
        ),
        Benchmark(
            "overlay_mutants",
            "broken sources of the overlay's arbiter against its tests",
            MUTANTS,
            {"every": 80},
            ros=False,
        ),
        Benchmark(
            "rig_mistakes",
            "what rigs get wrong in a record, and how often it is suspected",
            RIG_MISTAKES,
            {"records": 1, "changed": 1, "each": 1, "seconds": 4.0, "no_effects": True},
            ros=False,
        ),
        Benchmark(
            "fleet",
            "a drawn fleet: a shift that all have, and leaks of single ones",
            FLEET,
            {"specimens": 2, "leaks": 1, "seconds": 4.0, "jobs": 1},
            ros=False,
        ),
        Benchmark(
            "diagnosis",
            "the sealed benchmark of diagnosis: rates against their targets",
            (),
            {"cases": 1, "kinds": ["clean"], "method": "baseline", "jobs": 1},
            ros=False,
        ),
    )
}
"""The rows of the diagnosis are its rates (steering_diagnosis.benchmark.scoring)."""
