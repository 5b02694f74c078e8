"""By default no socket of a run is open to the network: a guest there can neither listen nor talk.

Locators alone do not do it: Fast DDS announced 127.0.0.1 and still bound every socket to all
interfaces, until the transport was given its list of them.
"""

from pathlib import Path

import lockstep_dummies as dummies
import pytest

from steering_lockstep.processes import Zygote, run_graph

pytest.importorskip("rclpy")
pytest.importorskip("steering_msgs.msg")
pytestmark = pytest.mark.ros

LOOPBACK = "0100007F"


def children(pid: int) -> list[int]:
    return [int(p) for p in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def sockets(pid: int) -> set[str]:
    """Return the inodes of a process's open sockets."""
    links = (str(link.readlink()) for link in Path(f"/proc/{pid}/fd").iterdir())
    return {name[8:-1] for name in links if name.startswith("socket:[")}


def bound_addresses(pid: int) -> list[str]:
    """Return the local addresses of a process's TCP and UDP sockets, IPv4 as the kernel's hex."""
    own, found = sockets(pid), []
    for table in ("udp", "tcp", "udp6", "tcp6"):
        for line in Path(f"/proc/{pid}/net/{table}").read_text().splitlines()[1:]:
            fields = line.split()
            if fields[9] in own:
                found.append(fields[1].split(":")[0])
    return found


@pytest.mark.parametrize("layout", ["one", "each"])
def test_every_socket_is_bound_to_loopback(layout, monkeypatch):
    monkeypatch.delenv("ROS_AUTOMATIC_DISCOVERY_RANGE", raising=False)
    addresses: dict[int, list[str]] = {}
    with Zygote([dummies.HERE]) as zygote:

        def look(progress):
            if progress.phase == "running" and not addresses:
                for pid in children(zygote._process.pid):
                    addresses[pid] = bound_addresses(pid)

        result = run_graph(dummies.graph(), 2000, layout=layout, on_progress=look, zygote=zygote)
    assert result.ok, result.error
    assert addresses
    for own in addresses.values():
        # One to be found by, one for data, one or more to send from.
        assert len(own) >= 3
        assert set(own) == {LOOPBACK}
