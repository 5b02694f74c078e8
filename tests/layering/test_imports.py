"""Who may import whom: cores never ROS, packages only those below them, and package.xml says so."""

import ast
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import pytest

SRC = Path(__file__).parents[2] / "src"
PACKAGES = sorted(file.parent.name for file in SRC.glob("*/setup.py"))
CORE = "steering_core"
BELOW_STUDIES = set(PACKAGES) - {"steering_bringup", "steering_studies", "steering_diagnosis"}

ALLOWED: dict[str, set[str]] = {
    "balance_diagnosis": set(),
    "steering_core": set(),
    "steering_lockstep": {CORE},
    "steering_plant": {CORE},
    "pressure_control": {CORE, "steering_plant"},
    "driver_model": {CORE},
    "vehicle_model": {CORE, "steering_lockstep"},
    "rig_bridge": {CORE, "steering_lockstep"},
    "steering_bringup": BELOW_STUDIES,
    "steering_studies": BELOW_STUDIES | {"steering_bringup"},
    "steering_diagnosis": BELOW_STUDIES | {"steering_bringup", "steering_studies"},
}
"""Packages that a package's modules may import beside itself."""

MORE: dict[str, set[str]] = {
    # The registry of effects is the plant's; the vehicle's node alone asks it.
    "vehicle_model.vehicle_node": {"steering_plant"},
    # The emulated rig holds a plant of its own; the bridge holds no physics.
    "rig_bridge.emulator": {"steering_plant", "pressure_control"},
}
"""What a module, or a package's folder, may import beyond that."""

ROS_MODULES = {
    f"steering_lockstep.{name}"
    for name in (
        "diagnostics",
        "rosout",
        "endpoints",
        "free_clock",
        "node",
        "spinner",
        "standalone",
        "worker",
    )
}
ROS_MODULES |= {"steering_bringup.playback.publishers", "steering_bringup.cli.play"}
ROS_MODULES |= {
    f"steering_bringup.{name}"
    for name in (
        "check_node.link",
        "check_node.member",
        "check_node.case",
        "check_node.checking",
        "cli.check_node",
        "cli.node",
    )
}
"""Modules that stand on rclpy beside the nodes, whose names end with ``_node``."""

ROS_PACKAGES = {
    "rclpy",
    "builtin_interfaces",
    "diagnostic_msgs",
    "geometry_msgs",
    "nav_msgs",
    "rcl_interfaces",
    "rosgraph_msgs",
    "sensor_msgs",
    "std_msgs",
    "std_srvs",
    "steering_msgs",
}

DECLARED_AS = {"numpy": "python3-numpy", "scipy": "python3-scipy", "yaml": "python3-yaml"}


def name_of(file: Path) -> str:
    parts = file.relative_to(SRC).with_suffix("").parts[1:]
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {name_of(file): file for p in PACKAGES for file in sorted((SRC / p / p).rglob("*.py"))}


@cache
def imports(module: str) -> frozenset[str]:
    """Return the absolute names of all that a module imports, inside functions as well."""
    found = set()
    for node in ast.walk(ast.parse(MODULES[module].read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            # `from package import name` may import a module called name.
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            found |= {n if n in MODULES else str(node.module) for n in names}
    return frozenset(found)


def top(name: str) -> str:
    return name.partition(".")[0]


def stands_on_ros(module: str) -> bool:
    return module in ROS_MODULES or module.endswith("_node")


def allowed(module: str) -> set[str]:
    more = [names for start, names in MORE.items() if f"{module}.".startswith(f"{start}.")]
    ros = {"steering_lockstep"} if stands_on_ros(module) else set()
    return {top(module)} | ALLOWED[top(module)] | ros.union(*more)


def test_every_package_has_its_place():
    assert set(ALLOWED) == set(PACKAGES)


@pytest.mark.parametrize("module", MODULES)
def test_a_module_imports_packages_below_its_own_only(module):
    ours = {top(name) for name in imports(module)} & set(PACKAGES)
    assert ours <= allowed(module)


@pytest.mark.parametrize("module", [m for m in MODULES if not stands_on_ros(m)])
def test_a_core_imports_neither_ros_nor_a_node(module):
    """Checked module by module, so nothing that a core imports brings ROS in either."""
    assert not {top(name) for name in imports(module)} & ROS_PACKAGES
    assert not {name for name in imports(module) if name in MODULES and stands_on_ros(name)}


@pytest.mark.parametrize("package", PACKAGES)
def test_package_xml_declares_what_is_imported(package):
    tree = ElementTree.parse(SRC / package / "package.xml")
    declared = {str(entry.text) for entry in tree.iter() if entry.tag in ("depend", "exec_depend")}
    own = [module for module in MODULES if top(module) == package]
    used = {top(name) for module in own for name in imports(module)} - {package}
    known = set(PACKAGES) | ROS_PACKAGES | set(DECLARED_AS)
    assert {DECLARED_AS.get(name, name) for name in used & known} <= declared


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("import rclpy.node", "rclpy.node"),
        ("def f():\n    from steering_plant import plant", "steering_plant.plant"),
        ("from steering_lockstep.node import LockstepNode", "steering_lockstep.node"),
    ],
)
def test_an_import_is_seen(line, name, tmp_path, monkeypatch):
    (tmp_path / "made_up.py").write_text(line)
    monkeypatch.setitem(MODULES, "made_up", tmp_path / "made_up.py")
    imports.cache_clear()
    assert imports("made_up") == {name}
    imports.cache_clear()


def test_the_benchmark_s_truth_shares_no_code_with_the_plant():
    truth = [m for m in MODULES if m.startswith("steering_diagnosis.benchmark.truth")]
    assert truth
    for module in truth:
        assert not {n for n in imports(module) if top(n) in ("steering_plant", "rig_bridge")}
