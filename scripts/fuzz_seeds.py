#!/usr/bin/env python3
"""Collects what a fuzzer starts from: YAML files, and the YAML texts in C++ sources.

Writes each text into the folder `seeds` of the folder given, and their words, with
numbers at the ends of what a double holds, into its file `words`, a dictionary in libFuzzer's
format.
"""

import argparse
import re
import shutil
from pathlib import Path
from typing import List

EXTREME_NUMBERS = ["0", "-0.0", "5e-324", "1e-308", "1e-160", "1e-9", "1e9", "1e160", "1.7e308",
                   "-1e160", "2147483647", "-2147483648", ".nan", ".inf"]


def texts_of(path: Path) -> List[str]:
    """A YAML file's text, or all string literals of a C++ source that have a colon."""
    content = path.read_text(encoding="utf-8")
    if path.suffix == ".yaml":
        return [content]
    texts = re.findall(r'R"\((.*?)\)"', content, re.DOTALL)
    for adjacent in re.findall(r'(?:"(?:[^"\\\n]|\\.)*"\s*)+', content):
        text = "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', adjacent)).replace("\\n", "\n")
        if ":" in text:
            texts.append(text)
    return texts


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="where to write")
    parser.add_argument("files", type=Path, nargs="+", help="YAML files and C++ sources")
    arguments = parser.parse_args()

    texts = [text for path in arguments.files for text in texts_of(path)]
    seeds = arguments.folder / "seeds"
    shutil.rmtree(seeds, ignore_errors=True)
    seeds.mkdir(parents=True)
    for i, text in enumerate(texts):
        (seeds / f"{i}.yaml").write_text(text, encoding="utf-8")
    words = sorted(set(re.findall(r"[A-Za-z_]\w+", "\n".join(texts)))) + EXTREME_NUMBERS
    (arguments.folder / "words").write_text("".join(f'"{word}"\n' for word in words),
                                            encoding="utf-8")


if __name__ == "__main__":
    main()
