"""Package files are consistent, so that plain colcon builds them beside an installed ROS."""

import ast
import configparser
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from steering_lockstep.executables import ANY, EXECUTABLES
from steering_lockstep.kinds import FACTORIES

SOURCE = Path(__file__).resolve().parents[2] / "src"
PACKAGES = sorted(file.parent for file in SOURCE.glob("*/package.xml"))
PYTHON = [package for package in PACKAGES if (package / "setup.py").is_file()]
NAMES = {package.name for package in PACKAGES}
# Keys of rosdep, and packages of ROS 2 Jazzy itself.
KNOWN = {
    "ament_cmake", "diagnostic_msgs", "nav_msgs", "rcl_interfaces", "rclpy", "rosgraph_msgs",
    "sensor_msgs", "std_msgs", "std_srvs", "rosidl_default_generators", "rosidl_default_runtime",
    "ament_cmake_pytest", "ament_index_python", "launch", "launch_ros",
    "python3-can", "python3-h5py", "python3-numba", "python3-numpy", "python3-pandas",
    "python3-pydantic", "python3-pytest", "python3-scipy", "python3-tqdm", "python3-yaml",
}  # fmt: skip


def manifest(package: Path) -> ElementTree.Element:
    return ElementTree.parse(package / "package.xml").getroot()


def setup_arguments(package: Path) -> dict[str, ast.expr]:
    tree = ast.parse((package / "setup.py").read_text())
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    call = next(c for c in calls if isinstance(c.func, ast.Name) and c.func.id == "setup")
    return {keyword.arg: keyword.value for keyword in call.keywords if keyword.arg}


def scripts(package: Path) -> list[str]:
    points = setup_arguments(package).get("entry_points")
    return ast.literal_eval(points)["console_scripts"] if points else []


def test_every_folder_in_src_is_a_package():
    folders = {folder.name for folder in SOURCE.iterdir() if folder.is_dir()}
    assert folders - {"__pycache__"} == NAMES
    assert len(NAMES) >= 8


@pytest.mark.parametrize("package", PACKAGES, ids=lambda p: p.name)
def test_manifest_names_the_package(package):
    root = manifest(package)
    assert root.get("format") == "3"
    assert root.findtext("name") == package.name
    assert root.findtext("license") == "Apache-2.0"


def test_versions_are_equal():
    versions = {p.name: manifest(p).findtext("version") for p in PACKAGES}
    versions |= {
        f"{p.name}/setup.py": ast.literal_eval(setup_arguments(p)["version"]) for p in PYTHON
    }
    assert len(set(versions.values())) == 1, versions


@pytest.mark.parametrize("package", PACKAGES, ids=lambda p: p.name)
def test_declared_dependencies_exist(package):
    tags = [child for child in manifest(package) if child.tag.endswith("depend")]
    declared = {child.text for child in tags}
    assert declared <= NAMES | KNOWN
    assert package.name not in declared


@pytest.mark.parametrize("package", PYTHON, ids=lambda p: p.name)
def test_imported_packages_are_declared(package):
    declared = {child.text for child in manifest(package) if child.tag.endswith("depend")}
    text = "\n".join(file.read_text() for file in (package / package.name).rglob("*.py"))
    imported = set(re.findall(r"^\s*(?:from|import) (\w+)", text, flags=re.MULTILINE))
    ros = {"rclpy", "rosgraph_msgs", "nav_msgs", "sensor_msgs", "std_msgs", "diagnostic_msgs"}
    assert (imported & (NAMES | ros)) - {package.name} <= declared


@pytest.mark.parametrize("package", PYTHON, ids=lambda p: p.name)
def test_ament_finds_the_package(package):
    assert (package / "resource" / package.name).is_file()
    assert (package / package.name / "__init__.py").is_file()
    settings = configparser.ConfigParser()
    settings.read(package / "setup.cfg")
    assert settings["install"]["install_scripts"] == f"$base/lib/{package.name}"
    assert manifest(package).findtext("export/build_type") == "ament_python"


@pytest.mark.parametrize("package", PYTHON, ids=lambda p: p.name)
def test_console_scripts_lead_somewhere(package):
    for script in scripts(package):
        module, function = script.split("=")[1].strip().split(":")
        base = SOURCE / module.split(".")[0] / Path(*module.split("."))
        file = base / "__init__.py" if base.is_dir() else base.with_suffix(".py")
        nodes = list(ast.walk(ast.parse(file.read_text())))
        names = [n.name for n in nodes if hasattr(n, "name")]
        assigned = [n.targets[0] for n in nodes if isinstance(n, ast.Assign)]
        names += [target.id for target in assigned if isinstance(target, ast.Name)]
        assert function in names, script


@pytest.mark.parametrize("package", PYTHON, ids=lambda p: p.name)
def test_colcon_finds_the_package_s_tests(package):
    settings = configparser.ConfigParser()
    settings.read(package / "setup.cfg")
    folders = settings["tool:pytest"]["testpaths"].split()
    assert folders
    for folder in folders:
        assert list((package / folder).glob("test_*.py")), folder


def test_every_kind_of_node_has_an_executable_of_its_package():
    installed = {
        (package.name, *re.split(r"\s*=\s*", script))
        for package in PYTHON
        for script in scripts(package)
    }
    assert EXECUTABLES.keys() == FACTORIES.keys()
    for kind, (package, name) in EXECUTABLES.items():
        assert (package, name, f"steering_lockstep.executables:{kind}") in installed
        assert FACTORIES[kind].startswith(f"{package}.")
    assert (*ANY, "steering_lockstep.executables:any_kind") in installed


@pytest.mark.parametrize("package", PYTHON, ids=lambda p: p.name)
def test_data_files_are_installed(package):
    tree = package / package.name
    data = {file for file in tree.rglob("*") if file.suffix in (".yaml", ".html", ".js", ".css")}
    expression = setup_arguments(package)["package_data"]
    assert isinstance(expression, ast.Dict)
    globs = ast.literal_eval(expression.values[0])
    installed = {file for pattern in globs for file in tree.glob(pattern)}
    assert data <= installed, f"not installed: {sorted(map(str, data - installed))}"


def test_messages_are_all_generated():
    text = (SOURCE / "steering_msgs" / "CMakeLists.txt").read_text()
    assert "msg/*.msg" in text
