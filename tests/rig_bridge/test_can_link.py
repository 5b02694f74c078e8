"""The CAN link when the bus goes, is not there, or carries others' frames."""

import socket
import threading
import time

import can
import pytest
from healthy_rig import EMULATED
from rig_links import DEMAND, FRAME, RIG, both_ends, link_settings

from rig_bridge.transport.can_bus import open_bus
from rig_bridge.transport.can_hub import CanHub
from rig_bridge.transport.can_link import CanLink
from rig_bridge.transport.registry import open_link
from rig_bridge.transport.settings import CanSettings
from steering_core.errors import BenchError


def test_other_devices_on_the_bus_are_passed_over():
    with both_ends("can") as (bench, rig):
        bus = rig.buses.buses[0]
        bus.send(can.Message(arbitration_id=0x700, data=b"12345678", is_extended_id=False))
        rig.send_frame(FRAME)
        bus.send(can.Message(arbitration_id=0x18FF00F1, data=b"1", is_extended_id=True))
        assert len(bench.receive_frames(1.0)) == 1
        assert bench.bad == 0


class Counting(CanHub):
    """Counts the pieces that it passes on."""

    pieces = 0

    def _pass_on(self, sender, data):
        self.pieces += 1
        super()._pass_on(sender, data)


def test_a_packet_crosses_a_socketcand_bus_in_one_piece():
    hub = Counting()
    with both_ends("can", hub=hub) as (bench, rig):
        rig.send_frame(FRAME)
        assert len(bench.receive_frames(1.0)) == 1
        bench.send_demand(DEMAND)
        assert len(rig.receive_demands(1.0)) == 1
        assert hub.pieces == 2


def test_a_bus_that_goes_is_noticed():
    hub = CanHub()
    settings = CanSettings(interface="socketcand", host="127.0.0.1", port=hub.port)
    bench = CanLink(RIG, settings, EMULATED.with_suffix(".dbc"))
    hub.close()
    limit = time.monotonic() + 2.0
    while bench.up and time.monotonic() < limit:
        bench.send_demand(DEMAND)
        bench.receive_frames(0.01)
    assert not bench.up
    assert bench.problem
    bench.close()


class Talkative(CanHub):
    """Sends a frame right behind its answer to a client that opens the bus."""

    def _answer(self, client, words):
        super()._answer(client, words)
        client.on_bus = True
        if words[0] == "rawmode":
            self._write(client, b"< frame 123 1.000000 00 >")


def test_a_bus_may_be_busy_as_it_is_opened():
    with both_ends("can", hub=Talkative()) as (bench, far):
        far.send_frame(FRAME)
        assert len(bench.receive_frames(1.0)) == 1


def test_a_server_that_answers_otherwise_is_one_clear_line():
    with socket.create_server(("127.0.0.1", 0)) as server:
        thread = threading.Thread(target=refuse, args=(server,))
        thread.start()
        settings = {"interface": "socketcand", "host": "127.0.0.1"}
        with pytest.raises(BenchError, match=r"socketcand can0: .*< er"):
            open_link("can", RIG, EMULATED.parent, settings | {"port": server.getsockname()[1]})
        thread.join()


def refuse(server):
    client, _ = server.accept()
    with client:
        client.sendall(b"< hi >")
        client.recv(100)
        client.sendall(b"< error no such bus >")


def test_no_such_interface_is_one_clear_line():
    with pytest.raises(BenchError, match="did you mean 'socketcan"):
        open_link("can", RIG, EMULATED.parent, {"interface": "socketcam"})
    with pytest.raises(BenchError, match="cannot open the CAN bus socketcan nocan7"):
        open_link("can", RIG, EMULATED.parent, {"channel": "nocan7"})


def test_can_without_a_dbc_file_is_refused(tmp_path):
    with pytest.raises(BenchError, match="no DBC file"):
        open_link("can", RIG.model_copy(update={"dbc": None}), tmp_path)


def test_the_hub_serves_several_and_survives_one_that_leaves():
    with link_settings("can") as settings:
        buses = [open_bus(CanSettings.model_validate(settings)) for _ in range(3)]
        buses[0].shutdown()
        buses[1].send(can.Message(arbitration_id=0x123, data=b"\x00\x0f\xff", is_extended_id=False))
        message = buses[2].recv(1.0)
        assert message is not None
        assert (message.arbitration_id, bytes(message.data)) == (0x123, b"\x00\x0f\xff")
        assert buses[1].recv(0.05) is None, "nobody hears himself"
        for bus in buses[1:]:
            bus.shutdown()
