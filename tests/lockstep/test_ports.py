import pytest

from steering_lockstep.graph import GraphError, NodeSpec
from steering_lockstep.ports import Ports, parts, picker, section

PORTS = Ports(
    takes=(
        ("/driver/torque", "torque"),
        ("/valve/left/command", "solenoid_force"),
        ("/vehicle/rack_force", "stiffness"),
    ),
    gives=("/steering/torque", "/steering/rack", "/clock"),
    optional=frozenset({"/valve/left/command"}),
)


def spec(*inputs, outputs=()):
    return NodeSpec("n", "x:y", dict.fromkeys(inputs, 0), outputs)


def test_arguments_do_not_depend_on_the_order_of_the_node_set():
    one = spec("/driver/torque", "/valve/left/command", "/vehicle/rack_force")
    other = spec("/vehicle/rack_force", "/driver/torque", "/valve/left/command")
    driver, valve, load = [1.0, 2.0], [3.0, 4.0], [5.0, 6.0, 7.0]
    assert tuple(picker(one, PORTS)(driver + valve + load)) == (1.0, 4.0, 6.0)
    assert tuple(picker(other, PORTS)(load + driver + valve)) == (1.0, 4.0, 6.0)


def test_absent_optional_input_is_zero():
    pick = picker(spec("/driver/torque", "/vehicle/rack_force"), PORTS)
    assert tuple(pick([1.0, 2.0, 5.0, 6.0, 7.0])) == (1.0, 0.0, 6.0)


def test_missing_and_useless_inputs_are_named():
    with pytest.raises(GraphError, match="needs /vehicle/rack_force"):
        picker(spec("/driver/torque"), PORTS)
    with pytest.raises(GraphError, match="no use for the input /steering/rack"):
        picker(spec("/driver/torque", "/vehicle/rack_force", "/steering/rack"), PORTS)


def test_outputs_keep_their_numbers_in_any_order():
    wanted = spec(outputs=("/clock", "/steering/rack", "/truth/plant", "/steering/torque"))
    assert parts(wanted, PORTS) == [
        ("/clock", 6, 6),
        ("/steering/rack", 3, 6),
        ("/steering/torque", 0, 3),
    ]


def test_section_takes_the_prefix_off():
    assert section({"load.kind": "none", "loads": 1, "side": "left"}, "load") == {"kind": "none"}
