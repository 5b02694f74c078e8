"""The full check finds every kind of damage in installed distributions."""

import base64
import hashlib
import sys

import pytest

from bootstrap import records

VERSIONS = {"some-thing": "1.0"}


@pytest.fixture
def environment(tmp_path):
    version = f"python{sys.version_info[0]}.{sys.version_info[1]}"
    site = tmp_path / "lib" / version / "site-packages"
    info = site / "some_thing-1.0.dist-info"
    (site / "some_thing").mkdir(parents=True)
    info.mkdir()
    (site / "some_thing" / "__init__.py").write_text("x = 1\n")
    (tmp_path / "share").mkdir()
    (tmp_path / "share" / "export.cmake").write_text("set(x 1)\n")
    (info / "METADATA").write_text("Name: some-thing\n")
    rows = [
        row(site / "some_thing/__init__.py", "some_thing/__init__.py"),
        row(tmp_path / "share/export.cmake", "../../../share/export.cmake"),
        "some_thing-1.0.dist-info/RECORD,,",
    ]
    (info / "RECORD").write_text("\n".join(rows) + "\n")
    return tmp_path


def row(file, path):
    value = base64.urlsafe_b64encode(hashlib.sha256(file.read_bytes()).digest())
    return f"{path},sha256={value.rstrip(b'=').decode()},{file.stat().st_size}"


def found(environment, name):
    return next(environment.rglob(name))


def test_whole_distribution_passes(environment):
    assert records.damaged(environment, VERSIONS, {}) == {}


def test_changed_module_is_found(environment):
    found(environment, "__init__.py").write_text("x = 2\n")
    assert "differs" in records.damaged(environment, VERSIONS, {})["some-thing"][0]


def test_deleted_file_outside_site_packages_is_found(environment):
    found(environment, "export.cmake").unlink()
    assert "is gone" in records.damaged(environment, VERSIONS, {})["some-thing"][0]


def test_file_changed_on_purpose_passes_until_it_changes_again(environment):
    file = found(environment, "export.cmake")
    file.write_text("set(x 2)\n")
    patched = {str(file): hashlib.sha256(file.read_bytes()).hexdigest()}
    assert records.damaged(environment, VERSIONS, patched) == {}
    file.write_text("set(x 3)\n")
    assert list(records.damaged(environment, VERSIONS, patched)) == ["some-thing"]


def test_a_file_of_two_distributions_is_as_one_of_them_recorded_it(environment):
    """Two wheels with a LICENSE beside lib: the check found one of them damaged for ever."""
    shared = found(environment, "export.cmake")
    info = found(environment, "some_thing-1.0.dist-info")
    other = info.with_name("other-2.0.dist-info")
    other.mkdir()
    (other / "METADATA").write_text("Name: other\n")
    shared.write_text("set(x 2)\n")
    (other / "RECORD").write_text(row(shared, "../../../share/export.cmake") + "\n")
    both = VERSIONS | {"other": "2.0"}
    assert records.damaged(environment, both, {}) == {}
    shared.write_text("set(x 3)\n")
    assert set(records.damaged(environment, both, {})) == {"some-thing", "other"}


@pytest.mark.parametrize("name", ["RECORD", "METADATA"])
def test_half_installed_distribution_is_found(environment, name):
    found(environment, name).unlink()
    assert "incomplete" in records.damaged(environment, VERSIONS, {})["some-thing"][0]


def test_other_version_and_absent_distribution_are_found(environment):
    wrong = records.damaged(environment, {"some-thing": "1.1", "other": "2.0"}, {})
    assert wrong == {"some-thing": ["is 1.0, not 1.1"], "other": ["is absent, not 2.0"]}


def test_what_a_person_added_is_left_alone(environment):
    found(environment, "__init__.py").write_text("x = 2\n")
    assert records.damaged(environment, {}, {}) == {}
