"""Types are the same where their fields are, however their text is written."""

import re

import pytest

from steering_bringup.bags.definitions import parse_definition, typestore_of
from steering_bringup.bags.meaning import (
    fields_of_definition,
    fields_of_description,
    first_difference,
)

KIND = "rig_msgs/msg/Gauge"
LINE = "=" * 80
HEADER = "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
IDL = """// generated
#include "std_msgs/msg/Header.idl"
module rig_msgs { module msg { module Gauge_Constants { const uint8 HIGH = 1; };
  struct Gauge { std_msgs::msg::Header header; @default (value=1) uint8 level;
    sequence<double> strain; string<9> name; octet flags[3]; }; }; };
"""
PLAIN = "std_msgs/Header header\nuint8 level\nfloat64[] strain\nstring<=9 name\nuint8[3] flags\n"


def fields(text):
    return fields_of_definition(KIND, typestore_of({KIND: text}).fielddefs)


@pytest.mark.parametrize(
    "text",
    [
        PLAIN,
        f"# what it is\n\n{PLAIN.replace('level', 'level 7 # up to 9')}uint8 HIGH=1\n",
        PLAIN.replace("uint8 level", "char level").replace("uint8[3]", "byte[3]"),
        PLAIN.replace("\n", "\r\n"),
        PLAIN.replace("std_msgs/Header", "std_msgs/msg/Header").rstrip("\n"),
        f"{PLAIN}{LINE}\n{HEADER}",
        f"{PLAIN}==========\n{HEADER}",
        IDL,
        f"{LINE}\nIDL: rig_msgs/msg/Gauge\n{IDL}",
    ],
)
def test_the_same_fields_in_other_words(text):
    assert first_difference(fields(text), fields(PLAIN)) == ""


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("uint8 level", "int8 level", "'level' is int8 there, uint8 here"),
        ("level", "height", "'height' there, 'level' here"),
        ("float64[]", "float32[]", "'strain' is float32\\[\\] there"),
        ("float64[]", "float64[4]", "'strain' is float64\\[4\\] there"),
        ("uint8[3]", "uint8[4]", "'flags' is uint8\\[4\\] there"),
        ("string<=9", "string", "'name' is string there, string<=9 here"),
        ("string<=9", "wstring", "'name' is wstring there"),
        ("uint8[3] flags\n", "", "'flags' only here"),
        ("flags\n", "flags\nbool more\n", "'more' only there"),
        ("std_msgs/Header", "float64", "'header' is float64 there, a message here"),
    ],
)
def test_other_fields(old, new, said):
    difference = first_difference(fields(PLAIN.replace(old, new)), fields(PLAIN))
    assert re.fullmatch(f"{said}.*", difference), difference


def test_what_is_bounded_there_may_be_longer_here():
    narrow = PLAIN.replace("<=9", "<=5").replace("float64[]", "float64[<=3]")
    assert first_difference(fields(narrow), fields(PLAIN)) == ""
    assert first_difference(fields(PLAIN), fields(narrow))


@pytest.mark.parametrize("text", ["", "???", "float64", "module x {", "uint8 a\nwhat is this\n"])
def test_what_is_no_definition_is_none(text):
    types = parse_definition(KIND, text)
    assert types == {} or KIND in types


def test_wide_strings_are_known():
    assert first_difference(fields("wstring<=5 a\n"), fields("wstring a\n")) == ""
    assert fields("wstring[] a\n")[0].kind == "wstring"


def test_a_description_as_it_is_installed():
    """char is an unsigned byte in ROS 2; the message without fields has one that fills it."""
    kind = {"capacity": 0, "string_capacity": 0, "nested_type_name": ""}
    made = {
        "type_description": {
            "type_name": KIND,
            "fields": [
                {"name": "a", "type": {**kind, "type_id": 3}},
                {"name": "b", "type": {**kind, "type_id": 59, "capacity": 9}},
                {"name": "c", "type": {**kind, "type_id": 145, "nested_type_name": "x/msg/E"}},
                {"name": "d", "type": {**kind, "type_id": 21, "string_capacity": 4}},
            ],
        },
        "referenced_type_descriptions": [
            {
                "type_name": "x/msg/E",
                "fields": [
                    {"name": "structure_needs_at_least_one_member", "type": {**kind, "type_id": 3}}
                ],
            }
        ],
    }
    text = f"char a\nfloat64[9] b\nx/E[] c\nstring<=4 d\n{LINE}\nMSG: x/E\n# nothing\n"
    assert first_difference(fields(text), fields_of_description(made)) == ""
    assert first_difference(fields_of_description(made), fields(text)) == ""
