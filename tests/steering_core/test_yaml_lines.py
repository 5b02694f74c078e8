"""YAML that nobody can have meant: refused in one line with its place and a remedy."""

import pytest

from steering_core.errors import BenchError
from steering_core.yaml_lines import read_yaml

LAUGHS = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
    f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 8)}]\n" for k in range(1, 12)
)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("&a [*a]", ("line 1", "alias of itself")),
        ("x: 1\ny: &a {z: *a}", ("line 2", "alias of itself")),
        ("&a\n<<: *a", ("alias of itself",)),
        (LAUGHS, ("more than 100000 entries", "aliases")),
        ("[" * 600 + "]" * 600, ("too deep",)),
        ("a:\n\tb: 1", ("line 2", "not with tabs")),
        ("a: {b: %c}", ("line 1", "in quotes")),
        ("a: {b: *c}", ("line 1", "in quotes")),
        ("a: {b: c [deg]}", ("line 1", "in quotes")),
        ("a: 2024-13-99", ("line 1", "'2024-13-99'", "in quotes")),
        ("a: !!int b", ("line 1", "in quotes")),
        ("a: !!bool b", ("line 1", "in quotes")),
        ("a: b\n---\na: c", ("line 2", "another document")),
        ("a: 1\n# \x00", ("line 2", "not allowed")),
    ],
)
def test_it_is_refused_in_one_line(text, told, tmp_path):
    path = tmp_path / "odd.yaml"
    path.write_text(text)
    with pytest.raises(BenchError) as caught:
        read_yaml(path)
    said = str(caught.value)
    assert "\n" not in said
    for words in (str(path), *told):
        assert words in said, said


@pytest.mark.parametrize("encoding", ["latin-1", "utf-16"])
def test_another_encoding_names_line_and_remedy(encoding, tmp_path):
    path = tmp_path / "odd.yaml"
    path.write_bytes("a: 1\nb: Öl\n".encode(encoding))
    with pytest.raises(BenchError, match=r"line \d: it is not UTF-8 text: save the file as UTF-8"):
        read_yaml(path)


def test_an_alias_that_is_used_twice_is_data(tmp_path):
    path = tmp_path / "good.yaml"
    path.write_text("a: &x {b: 1}\nc: *x\nd: *x\n")
    document = read_yaml(path)
    assert document.data == {"a": {"b": 1}, "c": {"b": 1}, "d": {"b": 1}}
    assert document.where(("c", "b")).endswith("line 1")
    assert document.where(("d",)).endswith("line 3")
