"""The CAN hub with clients that say nonsense, never read, or want others' identifiers."""

import socket
import time
from contextlib import contextmanager

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rig_bridge.transport.can_hub import LARGEST_BACKLOG, CanHub

WAIT_S = 5.0


@contextmanager
def hub(**options):
    served = CanHub(**options)
    try:
        yield served
    finally:
        served.close()


class Client:
    """A socketcand client of the raw kind."""

    def __init__(self, served, bus="can0"):
        self.socket = socket.create_connection(("127.0.0.1", served.port), timeout=WAIT_S)
        self.text = ""
        self.until("< hi >")
        for words in (f"< open {bus} >", "< rawmode >"):
            self.say(words)
            self.until("< ok >")

    def say(self, text):
        self.socket.sendall(text if isinstance(text, bytes) else text.encode())

    def until(self, wanted):
        """Read until ``wanted`` has come; return what was before it."""
        while wanted not in self.text:
            data = self.socket.recv(65536)
            assert data, "the hub has closed the connection"
            self.text += data.decode()
        before, _, self.text = self.text.partition(wanted)
        return before

    def close(self):
        self.socket.close()


def works(served, one, other):
    """Check that a frame of ``one`` reaches ``other``."""
    one.say("< send 7F0 2 0A B >")
    other.until("< frame 7F0 ")
    assert other.until(">").split()[1:] == ["0A0B"]


MALFORMED = [
    "< send 123 1 zz >",
    "< send zz 1 00 >",
    "< send 123 >",
    "< send >",
    "< send 123 9 1 2 3 4 5 6 7 8 9 >",
    "< send 123 2 00 >",
    "< send 123 x 00 >",
    "< send 800 0 >",
    "< send 20000000 0 >",
    "< send -12 0 >",
    "< send +12 0 >",
    "< send 123 1 1g >",
    "< send 123 1 123 >",
    "< fdsend 123 41 " + "00 " * 65 + ">",
]


@pytest.mark.parametrize("line", MALFORMED)
def test_a_malformed_line_reaches_nobody_and_the_hub_goes_on(line):
    with hub() as served:
        one, other, third = (Client(served) for _ in range(3))
        one.say(line)
        one.until("< error malformed frame >")
        works(served, one, other)
        assert served.malformed == 1
        third.until("< frame 7F0 ")
        assert "zz" not in third.text
        for client in (one, other, third):
            client.close()


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.binary(max_size=60), max_size=5))
def test_any_bytes_leave_the_hub_working(pieces):
    with hub() as served:
        stranger, one, other = (Client(served) for _ in range(3))
        for piece in pieces:
            stranger.say(piece)
        stranger.close()
        works(served, one, other)
        one.close()
        other.close()


def test_a_client_that_never_reads_is_dropped_and_holds_nobody_up():
    with hub() as served:
        one, other = Client(served), Client(served)
        deaf = Client(served)
        deaf.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        line = "< send 123 8 0 1 2 3 4 5 6 7 >" * 500
        slowest = 0.0
        for _ in range(20 * LARGEST_BACKLOG // (500 * 50)):
            begin = time.monotonic()
            one.say(line)
            one.say("< send 124 0 >")
            other.until("< frame 124 ")
            slowest = max(slowest, time.monotonic() - begin)
            if len(served.clients) < 3:
                break
        assert len(served.clients) == 2
        assert slowest < WAIT_S
        works(served, one, other)
        for client in (one, other, deaf):
            client.close()


def test_an_identifier_is_its_first_sender_s_while_he_is_there():
    with hub(exclusive=True) as served:
        bench, rig, stranger = (Client(served) for _ in range(3))
        bench.say("< send 200 1 01 >")
        rig.until("< frame 200 ")
        stranger.say("< send 200 1 66 >< send 300 1 02 >")
        assert "66" not in rig.until("< frame 300 ").partition("01 >")[2]
        assert served.refused == 1
        elsewhere = Client(served, "can1")
        elsewhere.say("< send 200 1 05 >")
        works(served, bench, rig)
        assert served.refused == 1, "another bus has identifiers of its own"
        bench.close()
        again = Client(served)
        until = time.monotonic() + WAIT_S
        while len(served.clients) > 4 and time.monotonic() < until:
            time.sleep(0.01)
        again.say("< send 200 1 03 >")
        rig.until("< frame 200 ")
        assert served.refused == 1
        for client in (rig, stranger, elsewhere, again):
            client.close()
