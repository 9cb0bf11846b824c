#!/usr/bin/env python3
"""Makes units for clang-tidy: sources that each include many of the package's.

What clang-tidy takes goes into the headers of other libraries, which a unit reads once for all of its
sources. Reads a compile_commands.json, and writes into a folder the units and a compile_commands.json
of them. A unit holds sources of one folder, and no two that define the same name for themselves.
"""

import argparse
import json
import re
import shlex
from pathlib import Path
from typing import Dict, List, Set

# More share more, and take more memory: 1.5 GB at this number.
LARGEST_UNIT = 14

# clang's analyzer looks into included sources only where the name of the unit begins so.
PREFIX = "UnifiedSource"

DEFINITION = re.compile(
    r"(?:struct|class|enum class|enum|union) (\w+)"  # a type
    r"|using (\w+) ="
    r"|.*?(\w+)(?:\(|\{| =(?: |$)|\[|;)"  # a function, a constant
)


def defined_names(text: str) -> Set[str]:
    """The names that lines define which begin at the margin, as clang-format has them."""
    names = set()
    for line in text.splitlines():
        match = DEFINITION.match(line)
        if match and not line.startswith((" ", "}", "/", "#", "namespace ", "template")):
            names.update(name for name in match.groups() if name)
    return names


def own_names(source: str) -> Set[str]:
    """The names that a source defines for itself alone.

    What this overlooks, the compiler finds twice in a unit: clang-tidy then fails.
    """
    names = {"main"} if re.search(r"^int main\(", source, re.MULTILINE) else set()
    for body in re.findall(r"^namespace \{$(.*?)^\}  // namespace$", source, re.MULTILINE | re.DOTALL):
        names |= defined_names(body)
    return names


def units_of(sources: List[Path], shared: Set[str]) -> List[List[Path]]:
    """Shares sources of one folder out among as few units as their number and names allow.

    A name for itself that a header has, too, hides that from all that follow in the unit: such a source
    comes late, and none after it that uses the header's.
    """
    texts = {source: source.read_text(encoding="utf-8") for source in sources}
    own = {source: own_names(text) for source, text in texts.items()}
    units: List[List[Path]] = [[] for _ in range(-(-len(sources) // LARGEST_UNIT))]
    taken: List[Set[str]] = [set() for _ in units]
    for source in sorted(sources, key=lambda source: len(own[source] & shared)):
        words = own[source] | set(re.findall(r"\w+", texts[source])) & shared
        for index in sorted(range(len(units)), key=lambda i: len(units[i])):
            if not words & taken[index]:
                break
        else:
            index = len(units)
            units.append([])
            taken.append(set())
        units[index].append(source)
        taken[index] |= own[source]
    return [unit for unit in units if unit]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("compile_commands", type=Path)
    parser.add_argument("sources", type=Path, help="folder of the sources to take")
    parser.add_argument("headers", type=Path, help="folder of the public headers")
    parser.add_argument("output", type=Path, help="folder for the units")
    arguments = parser.parse_args()

    output = arguments.output.resolve()
    commands: Dict[Path, dict] = {}
    for entry in json.loads(arguments.compile_commands.read_text(encoding="utf-8")):
        if arguments.sources in Path(entry["file"]).parents:
            commands[Path(entry["file"])] = entry
    folders: Dict[Path, List[Path]] = {}
    for source in sorted(commands):
        folders.setdefault(source.parent, []).append(source)

    # A source may include headers of any folder.
    shared: Set[str] = set()
    for root in (arguments.headers, arguments.sources):
        for header in root.rglob("*.h"):
            shared |= defined_names(header.read_text(encoding="utf-8"))

    output.mkdir(parents=True, exist_ok=True)
    entries = []
    for folder, sources in folders.items():
        for number, unit in enumerate(units_of(sources, shared)):
            name = "_".join([PREFIX, *folder.relative_to(arguments.sources).parts, str(number)])
            path = output / f"{name}.cpp"
            path.write_text(
                "".join(f'#include "{s}"  // NOLINT(bugprone-suspicious-include)\n' for s in unit),
                encoding="utf-8")
            entry = commands[unit[0]]
            words = [str(path) if word == entry["file"] else word
                     for word in shlex.split(entry["command"])]
            entries.append({"directory": entry["directory"], "file": str(path), "arguments": words})
    (output / "compile_commands.json").write_text(json.dumps(entries), encoding="utf-8")


if __name__ == "__main__":
    main()
