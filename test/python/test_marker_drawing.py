"""How markers look, rendered and printed, cell by cell."""

import re
import unittest

from source_tree import FileTest

import cv2
import numpy as np
from omnitag.marker_drawing import drawing_of
from omnitag.marker_map import load_marker_map
from omnitag.pattern_file import Pattern, pattern_text
from omnitag.rendering.povray import render
from omnitag.rendering.scene import board_width, marker_bitmaps, marker_scene
from omnitag.rendering.world import Boards, Material

BLACK, WHITE = 0.04, 0.78
SIZE = 0.2  # m
PIXELS = 400  # along the board


def seen(greys, border, quiet, turns, pixels):
    """What share of white each pixel of a board shows, and which are at least a pixel off all edges.

    By the format's rules alone; x to the right and y down, in units of the marker's edge from its
    upper left corner.
    """
    side = len(greys)
    steps = (np.arange(pixels) + 0.5) / pixels * (1.0 + 2.0 * quiet) - quiet
    x, y = np.meshgrid(steps, steps)
    shares = np.where((x > 0) & (x < 1) & (y > 0) & (y < 1), 0.0, 1.0)
    cell = (1.0 - 2.0 * border) / side
    column, row = (np.floor((each - border) / cell).astype(int) for each in (x, y))
    inside = (column >= 0) & (column < side) & (row >= 0) & (row < side)
    shares[inside] = (np.rot90(greys, turns) / 255.0)[row[inside], column[inside]]
    edges = np.concatenate([[0.0, 1.0], border + cell * np.arange(side + 1)])
    off = np.abs(steps[:, None] - edges).min(axis=1) > (1.0 + 2.0 * quiet) / pixels
    return shares, off[:, None] & off[None, :]


class DrawingTest(FileTest):
    def marker(self, greys, border, words=""):
        colours = np.repeat(np.array(greys)[None], 3, axis=0)
        self.write("a.patt", pattern_text(Pattern(colours)))
        return load_marker_map(self.write("map.yaml", (
            "family: artoolkit\nsize: {}\nmarkers:\n"
            "  - {{pattern: a.patt, border: {}, position: [0, 0, 0], yaw: 0{}}}\n").format(
                SIZE, border, words))).markers[0]


class RenderedPatternTest(DrawingTest):
    """Head-on from afar, against the format's rules."""

    BOARDS = Boards(0.02, 1, BLACK, WHITE, Material("plain", 0.5, 0.5, 1.0, 0.0))

    def render(self, marker, boards=BOARDS):
        """A picture of the board, without perspective."""
        width = 1e3 * board_width(marker, boards)
        # The marker's face looks along x; who looks at it has y to the right and z up.
        scene = """#version 3.7;
            global_settings {{ assumed_gamma 1.0 ambient_light rgb 1 }} background {{ rgb 0 }}
            camera {{ orthographic location <2000, 0, 0> direction <-1, 0, 0>
              right <0, {0:.12g}, 0> up <0, 0, {0:.12g}> }}
            """.format(width)
        return render(scene + marker_scene(marker, boards, 1.0), marker_bitmaps([marker], boards),
                      PIXELS, PIXELS)

    def check(self, greys, border, turns=0):
        marker = self.marker(greys, border, ", roll: {}".format(turns * np.pi / 2))
        self.assertAlmostEqual(board_width(marker, self.BOARDS), 1.25 * SIZE)
        shares, off_edges = seen(greys, border, 0.125, turns, PIXELS)
        self.assertGreater(off_edges.mean(), 0.5)
        np.testing.assert_allclose(self.render(marker)[off_edges],
                                   (BLACK + (WHITE - BLACK) * shares)[off_edges], atol=1e-4)

    def test_cells_that_fit_the_border_s(self):
        self.check(np.random.default_rng(1).integers(0, 256, (16, 16)), 0.25)

    def test_cells_that_do_not(self):
        self.check(np.random.default_rng(2).integers(0, 256, (9, 9)), 0.05)
        self.check(np.random.default_rng(3).integers(0, 256, (4, 4)), 0.4)

    def test_turned_counter_clockwise(self):
        greys = np.random.default_rng(4).integers(0, 256, (8, 8))
        for turns in (1, 2, 3):
            self.check(greys, 0.25, turns)

    def test_greys_are_linear(self):
        greys = np.full((4, 4), 128)
        greys[0, 0], greys[3, 3] = 0, 255
        picture = self.render(self.marker(greys, 0.25), self.BOARDS._replace(black=0.0, white=1.0))
        middle = picture[PIXELS // 2 - 30:PIXELS // 2 + 30, PIXELS // 2 - 30:PIXELS // 2 + 30]
        np.testing.assert_allclose(middle, 128.0 / 255.0, atol=1e-4)

    def test_a_wider_quiet_zone(self):
        boards = self.BOARDS._replace(quiet_modules=2)
        greys = np.random.default_rng(5).integers(0, 256, (4, 4))
        marker = self.marker(greys, 0.25)
        self.assertAlmostEqual(board_width(marker, boards), 1.5 * SIZE)
        shares, off_edges = seen(greys, 0.25, 0.25, 0, PIXELS)
        np.testing.assert_allclose(self.render(marker, boards)[off_edges],
                                   (BLACK + (WHITE - BLACK) * shares)[off_edges], atol=1e-4)

    def test_patterns_of_one_name_keep_their_bitmaps(self):
        one = self.marker(np.arange(16).reshape(4, 4) * 15, 0.25)
        other = self.marker(np.arange(16).reshape(4, 4).T * 15, 0.25)
        self.assertNotEqual(drawing_of(one, 1).name, drawing_of(other, 1).name)
        self.assertEqual(len(marker_bitmaps([one, other, one], self.BOARDS)), 6)


class PrintedPatternTest(DrawingTest):
    def print(self, output, *arguments):
        result = self.run_tool("print_markers", "--map", self.path("map.yaml"), "--output",
                               self.path(output), *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def test_true_size_and_greys(self):
        greys = np.random.default_rng(1).integers(0, 256, (8, 8))
        self.marker(greys, 0.2)
        self.print("m.png", "--paper", "fit")
        picture = cv2.imread(self.path("m.png"), cv2.IMREAD_GRAYSCALE)
        dark = picture < 128
        # Only across the marker are lines dark over a third of its width.
        pixels = SIZE / 0.0254 * 300.0
        columns, = np.nonzero(dark.sum(axis=0) > 0.35 * pixels)
        rows, = np.nonzero(dark[:, columns[0]:columns[-1]].sum(axis=1) > 0.35 * pixels)
        rows = rows[:1 + np.flatnonzero(np.diff(rows) > 1)[0]]  # without the line of its size
        for ends in (rows, columns):
            self.assertAlmostEqual(ends[-1] - ends[0] + 1, pixels, delta=2.0)
        whole = round(1.25 * pixels)
        top, left = rows[0] - round(0.125 * pixels), columns[0] - round(0.125 * pixels)
        printed = picture[top:top + whole, left:left + whole]
        shares, off_edges = seen(greys, 0.2, 0.125, 0, whole)
        difference = np.abs(printed - 255.0 * shares)
        # On the quiet zone are the line to cut along and the note.
        quiet = round(0.125 * pixels)
        inner = slice(quiet, whole - quiet)
        off_edges = cv2.erode(off_edges.astype(np.uint8), np.ones((5, 5), np.uint8)) > 0
        self.assertLess((difference * off_edges)[inner, inner].max(), 1.0)
        self.assertGreater(np.mean(printed[:quiet] == 255), 0.95)

    def test_names(self):
        self.marker(np.arange(16).reshape(4, 4) * 15, 0.25)
        self.assertIn("artoolkit-a.svg", self.print("m.svg", "--paper", "a3", "--checklist"))
        with open(self.path("m-artoolkit-a.svg"), encoding="utf-8") as file:
            svg = file.read()
        self.assertIn("artoolkit a", svg)
        self.assertIn("of the black border", svg)
        # The pattern's greys, from the lightest on; SVG's default is black.
        fills = re.findall(r"style=\"fill: ?#([0-9a-f]{6})", svg)
        greys = ["{0:02x}{0:02x}{0:02x}".format(15 * level) for level in range(15, 0, -1)]
        self.assertEqual([fill for fill in fills if fill in greys][-15:], greys)
        with open(self.path("m-checklist.svg"), encoding="utf-8") as file:
            self.assertIn("artoolkit a", file.read())

    def test_too_small_a_paper(self):
        self.marker(np.arange(16).reshape(4, 4) * 15, 0.25)
        self.assert_refused(
            self.run_tool("print_markers", "--map", self.path("map.yaml"), "--output",
                          self.path("m.pdf"), "--paper", "a4"),
            "map.yaml", "artoolkit a: a size of 0.2 m", "fits is a3")


if __name__ == "__main__":
    unittest.main()
