"""Marker maps with ARToolKit patterns, and the tools that write such maps."""

import os
import unittest

from source_tree import FileTest

import numpy as np
from omnitag.map_evaluation import compare
from omnitag.map_merging import merge
from omnitag.marker_map import load_marker_map
from omnitag.pattern_file import Pattern, pattern_text
from omnitag.rendering.world import load_world
from test_render_sequence import WORLD

HEAD = "frame_id: map\nfamily: artoolkit\nsize: 0.3\nmarkers:\n"
PLACE = ", position: [0, 0, 0], yaw: 0"


def text_of_pattern(seed):
    """A pattern of 4 x 4 random cells."""
    return pattern_text(Pattern(np.random.default_rng(seed).integers(0, 256, (3, 4, 4))))


class PatternMapTest(FileTest):
    def setUp(self):
        super().setUp()
        for number, name in enumerate(("door.patt", "window.patt", "lamp.patt")):
            self.write(name, text_of_pattern(number))

    def write(self, name, content):
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        return super().write(name, content)

    def load(self, text, name="map.yaml"):
        return load_marker_map(self.write(name, text))

    def entries(self, *words, head=HEAD):
        return head + "".join("  - {" + each + PLACE + "}\n" for each in words)


class ReadingTest(PatternMapTest):
    def test_patterns_and_borders(self):
        os.makedirs(self.path("sub"))
        markers = self.load(self.entries("pattern: door.patt", "pattern: door.patt, border: 0.1",
                                         "family: tag16h5, id: 3", "pattern: sub/../lamp.patt")).markers
        self.assertEqual([m.pattern and m.pattern.border for m in markers], [0.25, 0.1, None, 0.25])
        self.assertEqual([m.label for m in markers], ["door", "door", "3", "lamp"])
        self.assertEqual([m.kind for m in markers],
                         ["artoolkit door", "artoolkit door", "tag16h5 id 3", "artoolkit lamp"])
        self.assertEqual(markers[0].pattern.picture.colours.tolist(),
                         np.random.default_rng(0).integers(0, 256, (3, 4, 4)).tolist())

    def test_border_at_the_top(self):
        head = HEAD.replace("size", "border: 0.125\nsize")
        markers = self.load(self.entries("pattern: door.patt", "pattern: door.patt, border: 0.4",
                                         "family: tag16h5, id: 3", head=head)).markers
        self.assertEqual([m.pattern and m.pattern.border for m in markers], [0.125, 0.4, None])

    def test_the_id_is_the_first_entry_with_that_pattern_and_border(self):
        os.makedirs(self.path("sub"))
        markers = self.load(self.entries(
            "family: tag16h5, id: 7", "pattern: door.patt", "pattern: lamp.patt", "pattern: door.patt",
            "pattern: door.patt, border: 0.3", "pattern: sub/../lamp.patt",
            "pattern: door.patt, border: 0.30, roll: 1")).markers
        self.assertEqual([m.key for m in markers],
                         [("tag16h5", 7), ("artoolkit", 1), ("artoolkit", 2), ("artoolkit", 1),
                          ("artoolkit", 4), ("artoolkit", 2), ("artoolkit", 4)])

    def test_a_pattern_is_beside_the_map(self):
        self.write("maps/patterns/desk.patt", text_of_pattern(5))
        marker, = self.load(self.entries("pattern: patterns/desk.patt"), "maps/map.yaml").markers
        self.assertEqual(os.path.realpath(marker.pattern.path),
                         os.path.realpath(self.path("maps/patterns/desk.patt")))
        absolute = self.path("door.patt")
        self.assertEqual(self.load(self.entries("pattern: " + absolute)).markers[0].pattern.path,
                         absolute)

    def test_bad_entries_are_named(self):
        self.write("short.patt", "1 2 3\n")
        self.write("bright.patt", text_of_pattern(0) + "256\n")
        for words, *parts in (
                ("family: artoolkit", "markers[0]", "the key 'pattern'"),
                ("id: 3", "markers[0].id", "a pattern instead", "'3'"),
                ("id: 3, pattern: door.patt", "markers[0].id", "a pattern instead"),
                ("family: tag36h11, pattern: door.patt", "markers[0].pattern",
                 "only in the family artoolkit", "tag36h11"),
                ("family: tag36h11, id: 3, border: 0.25", "markers[0].border",
                 "only in the family artoolkit"),
                ("pattern: door.patt, border: 0.04", "markers[0].border", "0.05 to 0.4", "'0.04'"),
                ("pattern: door.patt, border: 0.41", "markers[0].border", "0.05 to 0.4", "'0.41'"),
                ("pattern: door.patt, border: wide", "markers[0].border", "'wide'"),
                ("pattern: [door.patt]", "markers[0].pattern", "a string"),
                ("pattern: none.patt", "markers[0].pattern", "none.patt", "No such file"),
                ("pattern: short.patt", "markers[0].pattern", "short.patt", "12 N x N", "found 3"),
                ("pattern: bright.patt", "markers[0].pattern", "bright.patt:53: ", "'256'")):
            with self.subTest(words), self.assert_error("map.yaml:5: ", *parts):
                self.load(self.entries(words))
        with self.assert_error("map.yaml:1: ", "border", "0.05 to 0.4", "'0.5'"):
            self.load(self.entries("pattern: door.patt", head="border: 0.5\n" + HEAD))

    def test_a_decoy_s_pattern_is_beside_the_world(self):
        self.write("maps/map.yaml", self.entries("pattern: ../lamp.patt",
                                                 head=HEAD.replace("size", "border: 0.2\nsize")))
        world = load_world(self.write("worlds/world.yaml", WORLD.replace("map.yaml", "../maps/map.yaml")
                                      + "decoys: [{pattern: ../door.patt" + PLACE + "}]\n"))
        decoy = world.hung_markers.decoys[0].marker.pattern
        self.assertEqual((decoy.name, decoy.border), ("door", 0.2))


class WritingTest(PatternMapTest):
    def rewritten(self, text, output, tool, *arguments):
        """The text and the map that a tool writes."""
        os.makedirs(os.path.dirname(self.path(output)), exist_ok=True)
        source = self.write("maps/map.yaml", text)
        result = self.run_tool(tool, *[{"IN": source, "OUT": self.path(output)}.get(each, each)
                                       for each in arguments])
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.path(output), encoding="utf-8") as file:
            return file.read(), load_marker_map(self.path(output))

    def test_patterns_and_borders_are_kept(self):
        text = self.entries("name: a, pattern: ../door.patt", "pattern: ../lamp.patt, border: 0.3",
                            "family: tag16h5, id: 4", "pattern: ../door.patt")
        for tool, *arguments in (("disturb_files", "--map", "IN", "--output-map", "OUT"),
                                 ("convert_map", "IN", "OUT", "--to", "omnitag")):
            for output in ("maps/other.yaml", "out/deep/other.yaml", "other.yaml"):
                with self.subTest(tool=tool, output=output):
                    _, after = self.rewritten(text, output, tool, *arguments)
                    before = load_marker_map(self.path("maps/map.yaml"))
                    self.assertEqual([m.key for m in after.markers], [m.key for m in before.markers])
                    self.assertEqual([m.identity for m in after.markers],
                                     [m.identity for m in before.markers])

    def test_paths_are_relative_to_the_new_map(self):
        text = self.entries("pattern: ../door.patt", "pattern: ../lamp.patt")
        written, _ = self.rewritten(text, "out/o.yaml", "convert_map", "IN", "OUT", "--to", "omnitag")
        self.assertIn("border: 0.25\n", written)
        self.assertIn("{pattern: '../door.patt', position", written)
        written, _ = self.rewritten(text, "o.yaml", "convert_map", "IN", "OUT", "--to", "omnitag")
        self.assertIn("{pattern: 'lamp.patt', position", written)

    def test_a_folder_that_is_a_link(self):
        # Its '..' is not the folder that has the link.
        os.makedirs(self.path("far/away"))
        os.symlink(self.path("far/away"), self.path("near"))
        _, after = self.rewritten(self.entries("pattern: ../door.patt"), "near/o.yaml", "disturb_files",
                                  "--map", "IN", "--output-map", "OUT")
        self.assertEqual(after.markers[0].pattern.name, "door")

    def test_maps_without_patterns_have_no_border(self):
        written, _ = self.rewritten(self.entries("family: tag16h5, id: 4"), "o.yaml", "disturb_files",
                                    "--map", "IN", "--output-map", "OUT")
        self.assertNotIn("border", written)

    def test_formats_without_patterns_refuse_them(self):
        source = self.write("map.yaml", self.entries("pattern: door.patt"))
        for name in ("wpilib", "tagslam", "fiducial_slam", "apriltag_ros"):
            self.assert_refused(self.run_tool("convert_map", source, self.path("o"), "--to", name),
                                "map.yaml", "have ids", name, "the pattern door")
        self.assertFalse(os.path.exists(self.path("o")))


class ComparingTest(PatternMapTest):
    """Two maps number their patterns differently, and keep their files elsewhere."""

    def setUp(self):
        super().setUp()
        self.write("copy/gate.patt", text_of_pattern(0))  # the door's
        self.write("copy/bulb.patt", text_of_pattern(2))  # the lamp's
        self.write("copy/new.patt", text_of_pattern(9))
        self.first = self.load(HEAD + (
            "  - {pattern: window.patt, position: [9, 9, 1], yaw: 0}\n"
            "  - {pattern: door.patt, position: [0, 0, 1], yaw: 0.5}\n"
            "  - {pattern: lamp.patt, position: [4, 0, 1], yaw: 0.5}\n"), "a.yaml")
        self.second = self.load(HEAD + (
            "  - {pattern: bulb.patt, position: [4, 0, 1], yaw: 0.5}\n"
            "  - {pattern: new.patt, position: [2, 3, 1], yaw: -1}\n"
            "  - {pattern: gate.patt, position: [0, 0.01, 1], yaw: 0.5}\n"), "copy/b.yaml")

    def test_errors(self):
        errors = compare(self.second, self.first, set(), False)
        self.assertEqual([(e.label, round(e.distance, 6)) for e in errors],
                         [("lamp", 0.0), ("door", 0.01)])
        without = {self.first.markers[1].identity}
        self.assertEqual(len(compare(self.second, self.first, without, False)), 1)

    def test_merging(self):
        merged = merge(self.first, self.second).marker_map.markers
        self.assertEqual([(m.label, m.id) for m in merged],
                         [("window", 0), ("door", 1), ("lamp", 2), ("new", 3)])
        result = self.run_tool("merge_maps", self.path("a.yaml"), self.path("copy/b.yaml"),
                               "--output", self.path("copy/o.yaml"))
        self.assertEqual(result.returncode, 0, result.stderr)
        again = load_marker_map(self.path("copy/o.yaml")).markers
        self.assertEqual([m.identity for m in again], [m.identity for m in merged])

    def test_another_border_is_another_marker(self):
        wide = self.load(self.entries("pattern: door.patt, border: 0.3"), "wide.yaml")
        with self.assert_error("a marker that both maps have once"):
            merge(self.first, wide)

    def test_a_pattern_that_one_map_reuses_keeps_one_file(self):
        reused = self.load(HEAD + (
            "  - {pattern: bulb.patt, position: [4, 0, 1], yaw: 0.5}\n"
            "  - {pattern: gate.patt, position: [0, 0, 1], yaw: 0.5}\n"
            "  - {pattern: gate.patt, position: [7, 7, 1], yaw: 0.5}\n"), "copy/c.yaml")
        merged = merge(self.first, reused).marker_map.markers
        self.assertEqual([(m.label, m.id) for m in merged],
                         [("window", 0), ("door", 1), ("lamp", 2), ("door", 1)])
        self.assertEqual([m.position[0] for m in merged], [9.0, 0.0, 4.0, 7.0])


if __name__ == "__main__":
    unittest.main()
