"""YAML files whose errors name file, line and key."""

import io
import math
import os
import re
from typing import Dict, Iterator, List, Optional, Sequence, Tuple

import yaml

from omnitag.command_line import InputError

SETTING = "--set"
"""The command line option whose values override those of a file."""

_STRING, _MAPPING = "tag:yaml.org,2002:str", "tag:yaml.org,2002:map"
_INTEGER = re.compile(r"[-+]?(0|[1-9][0-9]*)")
# A leading zero: octal in YAML 1.1, decimal in YAML 1.2.
_AMBIGUOUS = re.compile(r"[-+]?0[0-9]+")


class Value:
    """A value of a YAML file with its place.

    Reads the node graph instead of constructed Python values, which have no line numbers, hide repeated
    keys, and have `1e-3` as a string.
    """

    def __init__(self, key: str, node: yaml.Node) -> None:
        self._key = key
        self._node = node

    def error(self, expected: str, found: Optional[str] = None) -> InputError:
        """The error to raise at this place; by default, `found` describes the value."""
        key = self._key + ": " if self._key else ""
        return InputError("{}: {}expected {}, found {}".format(
            _place(self._node), key, expected, found or self._describe()))

    def span(self) -> Tuple[int, int]:
        """Its place in the text: the first character, and the one after the last."""
        return self._node.start_mark.index, self._node.end_mark.index

    def text(self) -> str:
        """A string that is not empty."""
        if not isinstance(self._node, yaml.ScalarNode) or not self._node.value.strip():
            raise self.error("a string")
        return self._node.value

    def path(self) -> str:
        """A path; a relative one is relative to the folder of this file."""
        text, file = self.text(), self._node.start_mark.name
        return text if file == SETTING else os.path.join(os.path.dirname(file), text)

    def is_mapping(self) -> bool:
        """Whether `mapping` can read it."""
        return isinstance(self._node, yaml.MappingNode)

    def is_list(self) -> bool:
        """Whether `items` can read it."""
        return isinstance(self._node, yaml.SequenceNode)

    def is_integer(self) -> bool:
        """Whether `integer` can read it."""
        return self._is_plain() and bool(_INTEGER.fullmatch(self._node.value))

    def integer(self) -> int:
        """A decimal integer."""
        if not self.is_integer():
            raise self.error("an integer")
        return int(self._node.value)

    def real(self) -> float:
        """A finite number, which may be an integer."""
        text = self._node.value if self._is_plain() else ""
        try:
            number = math.nan if "_" in text or _AMBIGUOUS.fullmatch(text) else float(text)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise self.error("a finite number")
        return number

    def boolean(self) -> bool:
        """`true` or `false`."""
        text = self._node.value if self._is_plain() else ""
        if text not in ("true", "false"):
            raise self.error("true or false")
        return text == "true"

    def reals(self, count: int) -> List[float]:
        """A list of `count` finite numbers."""
        expected = "a list of {} numbers".format(count)
        items = list(self.items(expected))
        if len(items) != count:
            raise self.error(expected, "{} values".format(len(items)))
        return [item.real() for item in items]

    def items(self, expected: str = "a list") -> "Iterator[Value]":
        """The elements of a list."""
        if not self.is_list():
            raise self.error(expected)
        return (Value("{}[{}]".format(self._key, index), node)
                for index, node in enumerate(self._node.value))

    def mapping(self, keys: Sequence[str]) -> "Mapping":
        """A mapping with no keys other than these."""
        if not self.is_mapping():
            raise self.error("a mapping of keys to values")
        values = {}
        for key_node, node in self._node.value:
            name = key_node.value if isinstance(key_node, yaml.ScalarNode) else "a key of parts"
            at_key = Value(self._join(name), key_node)
            if name not in keys:
                raise at_key.error("one of the keys " + ", ".join(keys), "this unknown key")
            if name in values:
                raise at_key.error("each key once", "it again")
            values[name] = Value(self._join(name), node)
        return Mapping(self, values)

    def any_mapping(self) -> "Mapping":
        """A mapping with any keys, as in a file of another program."""
        if not self.is_mapping():
            raise self.error("a mapping of keys to values")
        return self.mapping([key.value for key, _ in self._node.value])

    def with_key(self, keys: Sequence[str], value: yaml.Node) -> "Value":
        """This mapping with `value` at the path `keys`, which may be new."""
        if not keys:
            return Value(self._key, value)
        if not self.is_mapping():
            raise Value(self._join(keys[0]), value).error("a key of a mapping",
                                                          "one of " + self._describe())
        old = [pair for pair in self._node.value if pair[0].value == keys[0]]
        inner = Value(self._join(keys[0]), old[0][1] if old else _empty_mapping(value))
        key = yaml.ScalarNode(_STRING, keys[0], value.start_mark, value.end_mark)
        pairs = [pair for pair in self._node.value if pair not in old]
        pairs.append((key, inner.with_key(keys[1:], value)._node))
        return Value(self._key, yaml.MappingNode(_MAPPING, pairs, self._node.start_mark,
                                                 self._node.end_mark))

    def _join(self, name: str) -> str:
        return "{}.{}".format(self._key, name) if self._key else name

    def _is_plain(self) -> bool:
        return isinstance(self._node, yaml.ScalarNode) and self._node.style is None

    def _describe(self) -> str:
        if self.is_list():
            return "a list"
        if self.is_mapping():
            return "a mapping"
        return "'{}'".format(self._node.value) if self._node.value else "nothing"


class Mapping:
    """The keys of a mapping, each with its value and place."""

    def __init__(self, place: Value, values: Dict[str, Value]) -> None:
        self._place = place
        self._values = values

    def __contains__(self, key: str) -> bool:
        return key in self._values

    def keys(self) -> List[str]:
        """The keys in the order of the file."""
        return list(self._values)

    def get(self, key: str) -> Optional[Value]:
        """The value of a key, or None if it is missing."""
        return self._values.get(key)

    def __getitem__(self, key: str) -> Value:
        """The value of a key; raises InputError if it is missing."""
        if key not in self._values:
            raise self.error("the key '{}'".format(key), "none")
        return self._values[key]

    def over(self, base: "Mapping") -> "Mapping":
        """This mapping, completed by the keys that only `base` has."""
        return Mapping(self._place, {**base._values, **self._values})

    def with_setting(self, setting: str, known: Sequence[str]) -> "Mapping":
        """This mapping with the setting `KEY=VALUE`.

        KEY is the path of keys, joined by dots; the first is one of `known`. Raises InputError if KEY is
        unknown or VALUE is not YAML.
        """
        name, _, text = setting.partition("=")
        node = _compose_setting(setting, text)
        first, *others = name.strip().split(".")
        if first not in known:
            raise Value(first, node).error("one of the keys " + ", ".join(known),
                                           "this unknown key")
        value = self._values.get(first, Value(first, _empty_mapping(node)))
        return Mapping(self._place, {**self._values, first: value.with_key(others, node)})

    def error(self, expected: str, found: str) -> InputError:
        """The error to raise about the mapping as a whole."""
        return self._place.error(expected, found)


def read_text(path: str) -> str:
    """The text of a file; raises InputError if it cannot be read or is not text."""
    try:
        with open(path, encoding="utf-8") as file:
            return file.read()
    except UnicodeDecodeError:
        raise InputError("{}: expected a text, found characters that are none".format(path))
    except OSError as error:
        raise InputError("{}: cannot be read: {}".format(path, error.strerror))


def read_yaml(path: str) -> Value:
    """The only document of a file; raises InputError if it is not YAML."""
    try:
        with open(path, encoding="utf-8") as file:
            node = yaml.compose(file, Loader=yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        line = "{}:".format(error.problem_mark.line + 1) if error.problem_mark else ""
        raise InputError("{}:{} expected YAML, found: {}".format(path, line, error.problem))
    except (yaml.YAMLError, UnicodeDecodeError):
        raise InputError("{}: expected YAML, found characters that are not allowed".format(path))
    except OSError as error:
        raise InputError("{}: cannot be read: {}".format(path, error.strerror))
    if node is None:
        raise InputError("{}: expected YAML, found an empty file".format(path))
    return Value("", node)


def _compose_setting(setting: str, text: str) -> yaml.Node:
    stream = io.StringIO(text)
    stream.name = SETTING
    try:
        node = yaml.compose(stream, Loader=yaml.SafeLoader)
    except yaml.YAMLError:
        node = None
    if node is None:
        raise InputError("{}: expected KEY=VALUE with a value as in YAML, found '{}'".format(
            SETTING, setting))
    return node


def _empty_mapping(origin: yaml.Node) -> yaml.MappingNode:
    return yaml.MappingNode(_MAPPING, [], origin.start_mark, origin.end_mark)


def _place(node: yaml.Node) -> str:
    """The place of a node: file and line, or the command line option."""
    mark = node.start_mark
    return mark.name if mark.name == SETTING else "{}:{}".format(mark.name, mark.line + 1)
