"""The units in which clang-tidy reads the sources."""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from typing import Dict, List

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "unite_sources.py"


def source(own: str) -> str:
    return f"namespace omnitag {{\nnamespace {{\n\n{own}\n\n}}  // namespace\n}}  // namespace omnitag\n"


class UniteSources(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)

    def units(self, texts: Dict[str, str]) -> List[List[str]]:
        """The names of the sources in each unit."""
        commands = []
        for name, text in texts.items():
            path = self.root / "src" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
            if path.suffix == ".h":
                continue
            commands.append({"directory": "/build", "file": str(path),
                             "command": f"c++ -DNAME=\\\"x\\\" -o x.o -c {path}"})
        listing = self.root / "compile_commands.json"
        listing.write_text(json.dumps(commands), encoding="utf-8")
        output = self.root / "units"
        subprocess.run([sys.executable, SCRIPT, listing, self.root / "src", self.root, "units"],
                       check=True, cwd=self.root)
        units = []
        for entry in json.loads((output / "compile_commands.json").read_text(encoding="utf-8")):
            self.assertEqual(entry["arguments"],
                             ["c++", '-DNAME="x"', "-o", "x.o", "-c", entry["file"]])
            self.assertTrue(Path(entry["file"]).is_absolute(), "as it is compiled elsewhere")
            # As clang's analyzer wants it.
            self.assertTrue(Path(entry["file"]).name.startswith("UnifiedSource"))
            lines = Path(entry["file"]).read_text(encoding="utf-8").splitlines()
            units.append([str(Path(line.split('"')[1]).relative_to(self.root / "src"))
                          for line in lines])
        return units

    def test_a_folder_is_a_unit(self):
        texts = {"a/1.cpp": source("int one() { return 1; }"),
                 "a/2.cpp": source("int two() { return 2; }"), "b/1.cpp": source("")}
        self.assertEqual(self.units(texts), [["a/1.cpp", "a/2.cpp"], ["b/1.cpp"]])

    def test_what_defines_the_same_name_is_apart(self):
        for first, second in (
                ("int same() { return 1; }", "int same(int x) {\n  return x;\n}"),
                ("constexpr int kSame = 1;", "const std::array<int, 2> kSame = {1, 2};"),
                ("const char* const kSame =\n    \"a\";", "int kSame = 1;"),
                ("struct Same {\n  int a;\n};", "using Same = std::vector<int>;"),
                ("std::vector<int> same(\n    int a) {\n}", "double same = 0.0;"),
                ("template <typename T>\nT same(T a) {\n  return a;\n}", "int same(int a) {\n}")):
            units = self.units({"a/1.cpp": source(first), "a/2.cpp": source(second)})
            self.assertEqual(units, [["a/1.cpp"], ["a/2.cpp"]], first)

    def test_what_hides_a_public_name_hides_it_from_nobody_that_uses_it(self):
        header = "namespace omnitag {\n\nstruct Public {\n  int member;\n};\n\nint offered(int a);\n\n}\n"
        hides_function = source("int offered(double a) {\n}")
        units = self.units({"a/1.cpp": source("struct Public {\n  int b;\n};"), "a/2.cpp": hides_function,
                            "a/3.cpp": source("int b(Public a) {\n  return offered(a.member);\n}"),
                            "b/public.h": header})
        self.assertEqual(units, [["a/3.cpp", "a/1.cpp", "a/2.cpp"]])
        units = self.units({"a/1.cpp": hides_function,
                            "a/2.cpp": source("using Public = int;\nint a = offered(1);")})
        self.assertEqual(units, [["a/1.cpp"], ["a/2.cpp"]])

    def test_programs_are_apart(self):
        units = self.units({"a/1.cpp": "int main() {\n}\n", "a/2.cpp": "int main(int argc) {\n}\n"})
        self.assertEqual(units, [["a/1.cpp"], ["a/2.cpp"]])

    def test_uses_are_no_definitions(self):
        units = self.units({"a/1.cpp": source("int one(int x) {\n  return same(x);\n}"),
                            "a/2.cpp": source("int two(int x) {\n  return same(x);\n}")})
        self.assertEqual(units, [["a/1.cpp", "a/2.cpp"]])

    def test_units_are_of_equal_size(self):
        units = self.units({f"a/{i:02}.cpp": source(f"int f{i}() {{\n}}") for i in range(20)})
        self.assertEqual([len(unit) for unit in units], [10, 10])


if __name__ == "__main__":
    unittest.main()
