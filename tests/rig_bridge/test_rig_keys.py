"""Key files, and which link starts with which key."""

import os
import stat
import threading

import pytest
from healthy_rig import EMULATED
from rig_links import RIG

from rig_bridge.rig_file import load_rig
from rig_bridge.transport.registry import check_link
from rig_bridge.trust.key_file import load_key, make_key, own_key
from rig_bridge.trust.policy import beyond, trust_of
from steering_bringup.cli import main
from steering_core.errors import BenchError

HERE = {"bench": "127.0.0.1:1", "rig": "127.0.0.1:2"}
AWAY = {"bench": "192.168.10.1:1", "rig": "192.168.10.2:2"}


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    return tmp_path


def test_the_command_makes_a_key_for_its_owner_alone_and_never_replaces_one(tmp_path, capsys):
    file = tmp_path / "keys" / "my_rig.key"
    assert main(["rig-key", str(file)]) == 0
    assert "key: my_rig.key" in capsys.readouterr().out
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    key = load_key(file)
    assert len(key) == 32
    assert main(["rig-key", str(file)]) == 1
    assert "never overwritten" in capsys.readouterr().err
    assert load_key(file) == key
    other = tmp_path / "other.key"
    make_key(other)
    assert load_key(other) != key


@pytest.mark.parametrize("mode", [0o640, 0o604, 0o660, 0o602])
def test_a_key_that_others_may_read_is_refused(tmp_path, mode):
    file = tmp_path / "a.key"
    make_key(file)
    file.chmod(mode)
    with pytest.raises(BenchError, match=r"others may read the key .*a\.key"):
        load_key(file)


@pytest.mark.parametrize("text", ["", "12", "g" * 64, "0" * 63, "0" * 66, "\xff" * 64])
def test_what_is_no_key_is_refused(tmp_path, text):
    file = tmp_path / "a.key"
    file.write_text(text, encoding="latin-1")
    file.chmod(0o600)
    with pytest.raises(BenchError, match="holds no key of 64"):
        load_key(file)


def test_a_key_that_is_not_there_is_named(tmp_path):
    with pytest.raises(BenchError, match=r"nowhere\.key' cannot be read"):
        load_key(tmp_path / "nowhere.key")


def test_emulated_rigs_have_one_key_whoever_asks_first(home):
    found = []
    threads = [threading.Thread(target=lambda: found.append(load_key(own_key()))) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(set(found)) == 1
    assert stat.S_IMODE(own_key().stat().st_mode) == 0o600
    assert [file.name for file in own_key().parent.iterdir()] == ["emulated_rig.key"]


def test_without_a_home_the_key_lies_in_a_temporary_folder_of_one_s_own(tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.touch()
    monkeypatch.setenv("XDG_CONFIG_HOME", str(blocked))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert own_key().parent == tmp_path / f"steering-bench-{os.getuid()}"
    own_key().parent.chmod(0o755)
    with pytest.raises(BenchError, match="set XDG_CONFIG_HOME"):
        own_key()


def hardware(**more):
    return RIG.model_copy(update={"emulator": None, **more})


def test_the_shipped_rigs_have_a_key(home):
    for name in ("emulated", "servo_rig", "open_centre_rig"):
        rig = load_rig(EMULATED.with_name(f"{name}.yaml"))
        for kind in ("udp", "can"):
            key, note = trust_of(rig, EMULATED.parent, kind, rig.settings(kind))
            assert (key, note) == (load_key(own_key()), "")


def test_hardware_without_a_key_starts_on_this_machine_only_and_says_so(tmp_path):
    key, note = trust_of(hardware(), tmp_path, "udp", HERE)
    assert key is None
    assert note == (
        "whoever reaches its link can move the rig 'emulated': no authentication, as it has no key "
        "(steer rig-key)"
    )
    with pytest.raises(BenchError, match=r"has no key, and its link leaves .*192\.168\.10\.1:1"):
        trust_of(hardware(), tmp_path, "udp", AWAY)
    key, note = trust_of(hardware(authentication="none"), tmp_path, "udp", AWAY)
    assert key is None
    assert "authentication: none" in note


def test_a_key_beside_the_rig_s_file_is_used(tmp_path):
    make_key(tmp_path / "mine.key")
    assert trust_of(hardware(key="mine.key"), tmp_path, "udp", AWAY).key == load_key(
        tmp_path / "mine.key"
    )


@pytest.mark.parametrize(
    ("bus", "leaves"),
    [
        ({"interface": "socketcan", "channel": "can0"}, True),
        ({"interface": "socketcan", "channel": "vcan0"}, False),
        ({"interface": "socketcand", "host": "127.0.0.1", "port": 1}, False),
        ({"interface": "socketcand", "host": "10.0.0.1", "port": 1}, True),
        ({"interface": "virtual"}, False),
        ({"interface": "udp_multicast", "hop_limit": 0}, False),
        ({"interface": "udp_multicast"}, True),
        ({"interface": "pcan"}, True),
    ],
)
def test_which_buses_stay_on_this_machine(bus, leaves):
    assert (beyond("can", [{"interface": "virtual"}, bus]) is not None) == leaves


def test_a_dbc_file_without_the_frames_of_a_key_is_refused_with_the_way_out(tmp_path, home):
    text = EMULATED.with_suffix(".dbc").read_text()
    (tmp_path / "old.dbc").write_text(text[: text.index("BO_ 518")])
    rig = RIG.model_copy(update={"dbc": "old.dbc"})
    with pytest.raises(BenchError, match=r"unknown message 'BenchTag'.*authentication: none"):
        check_link("can", rig, tmp_path)
    free = rig.model_copy(update={"authentication": "none"})
    (note,) = check_link("can", free, tmp_path)
    assert "no authentication" in note


def test_a_key_and_none_at_once_is_refused(tmp_path):
    text = EMULATED.read_text() + "\nauthentication: none\nkey: a.key\n"
    (tmp_path / "rig.yaml").write_text(text)
    with pytest.raises(BenchError, match="authentication is none: leave one out"):
        load_rig(tmp_path / "rig.yaml")
