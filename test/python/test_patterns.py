"""ARToolKit patterns: their files, how alike they are, and where they come from."""

import os
import unittest

from source_tree import FileTest

import cv2
import numpy as np
from omnitag.marker_map import load_marker_map
from omnitag.pattern_file import Pattern, pattern_text, read_pattern
from omnitag.pattern_likeness import likeness, likeness_to_itself
from omnitag.pattern_picture import pattern_from_picture

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")

# Blue, green and red planes of a picture of 4 x 4 cells, and the same turned counter-clockwise by 90,
# 180 and 270 degrees, written by hand.
PATTERN = """\
   0   1   2   3
   4   5   6   7
   8   9  10  11
  12  13  14  15
 100 101 102 103
 104 105 106 107
 108 109 110 111
 112 113 114 115
 200 210 220 230
 204 214 224 234
 208 218 228 238
 212 222 232   0

   3   7  11  15
   2   6  10  14
   1   5   9  13
   0   4   8  12
 103 107 111 115
 102 106 110 114
 101 105 109 113
 100 104 108 112
 230 234 238   0
 220 224 228 232
 210 214 218 222
 200 204 208 212

  15  14  13  12
  11  10   9   8
   7   6   5   4
   3   2   1   0
 115 114 113 112
 111 110 109 108
 107 106 105 104
 103 102 101 100
   0 232 222 212
 238 228 218 208
 234 224 214 204
 230 220 210 200

  12   8   4   0
  13   9   5   1
  14  10   6   2
  15  11   7   3
 112 108 104 100
 113 109 105 101
 114 110 106 102
 115 111 107 103
 212 208 204 200
 222 218 214 210
 232 228 224 220
   0 238 234 230

"""


def grey_pattern(greys):
    """A pattern without colours."""
    return Pattern(np.repeat(np.array(greys, dtype=float)[None], 3, axis=0))


class PatternFileTest(FileTest):
    def test_the_first_block_is_read(self):
        pattern = read_pattern(self.write("a.patt", PATTERN))
        self.assertEqual(pattern.side, 4)
        self.assertEqual(pattern.colours[0].tolist(), np.arange(16).reshape(4, 4).tolist())
        self.assertEqual(pattern.colours[2, 3].tolist(), [212, 222, 232, 0])
        self.assertAlmostEqual(pattern.luma[0, 1], 0.114 * 1 + 0.587 * 101 + 0.299 * 210)
        # Row by row; a person would say: the red is missing in the lower right corner.
        self.assertAlmostEqual(pattern.luma[3, 3], 0.114 * 15 + 0.587 * 115)

    def test_written_as_it_was_read(self):
        self.assertEqual(pattern_text(read_pattern(self.write("a.patt", PATTERN))), PATTERN)

    def test_blocks_are_turned(self):
        generator = np.random.default_rng(2)
        for side in (4, 16, 33, 64):
            colours = generator.integers(0, 256, (3, side, side))
            path = self.write("a.patt", pattern_text(Pattern(colours)))
            with open(path, encoding="utf-8") as file:
                blocks = np.array(file.read().split(), dtype=int).reshape(4, 3, side, side)
            for block, turns in zip(blocks, range(4)):
                np.testing.assert_array_equal(block, [np.rot90(plane, turns) for plane in colours])
            np.testing.assert_array_equal(read_pattern(path).colours, colours)

    def test_any_white_space_and_decimals(self):
        text = " ".join(PATTERN.split()).replace(" 0 1 ", "\t0.0\n1. ", 1)
        np.testing.assert_array_equal(read_pattern(self.write("b.patt", text)).colours,
                                      read_pattern(self.write("a.patt", PATTERN)).colours)

    def test_bad_files_are_named(self):
        numbers = "12 N x N numbers with N from 4 to 64"
        for text, *parts in (
                ("", numbers, "found 0"),
                (PATTERN.replace(" 238\n", " \n", 1), numbers, "found 191"),
                (PATTERN + " 7\n", numbers, "found 193"),
                ("3 " * 12 * 9, numbers, "found 108"),
                ("3 " * 12 * 65 * 65, numbers, "found 50700"),
                (PATTERN.replace(" 238", " 256", 1), "a.patt:11: ", "from 0 to 255", "'256'"),
                (PATTERN.replace("   4   5", "  -4   5"), "a.patt:2: ", "from 0 to 255", "'-4'"),
                (PATTERN.replace("   7\n", " nan\n", 1), "a.patt:2: ", "'nan'"),
                (PATTERN.replace("   7\n", " 1_0\n", 1), "a.patt:2: ", "'1_0'"),
                ("90 92 94 96 " * 48, "contrast", "at least 5", "found 2.2")):
            with self.subTest(parts), self.assert_error("a.patt:", *parts):
                read_pattern(self.write("a.patt", text))
        with self.assert_error("none.patt: cannot be read", "No such file"):
            read_pattern(self.path("none.patt"))


class LikenessTest(unittest.TestCase):
    def test_brightness_and_contrast_do_not_matter(self):
        greys = np.random.default_rng(1).uniform(50, 200, (16, 16))
        found = likeness(grey_pattern(greys), grey_pattern(30 + 0.5 * greys))
        self.assertAlmostEqual(found.correlation, 1.0)
        self.assertEqual(found.degrees, 0)

    def test_turned(self):
        greys = np.random.default_rng(1).uniform(0, 255, (16, 16))
        for turns in range(4):
            found = likeness(grey_pattern(np.rot90(greys, turns)), grey_pattern(greys))
            self.assertAlmostEqual(found.correlation, 1.0)
            self.assertEqual(found.degrees, 90 * turns)

    def test_correlation_as_numpy_has_it(self):
        a, b = np.random.default_rng(1).uniform(0, 255, (2, 8, 8))
        expected = max(np.corrcoef(a.ravel(), np.rot90(b, turns).ravel())[0, 1] for turns in range(4))
        self.assertAlmostEqual(likeness(grey_pattern(a), grey_pattern(b)).correlation, expected)
        own = max(np.corrcoef(a.ravel(), np.rot90(a, turns).ravel())[0, 1] for turns in (1, 2, 3))
        self.assertAlmostEqual(likeness_to_itself(grey_pattern(a)).correlation, own)

    def test_other_numbers_of_cells(self):
        greys = np.random.default_rng(1).uniform(0, 255, (4, 4))
        finer = grey_pattern(np.kron(greys, np.ones((3, 3))))
        self.assertAlmostEqual(likeness(grey_pattern(greys), finer).correlation, 1.0)
        # A half that is black, on 4 and on 6 cells.
        halves = [grey_pattern(np.repeat([[0] * n, [255] * n], n // 2, axis=0)) for n in (4, 6)]
        self.assertAlmostEqual(likeness(*halves).correlation, 1.0)


class PatternFromPictureTest(FileTest):
    def picture(self, pixels, name="picture.png"):
        cv2.imwrite(self.path(name), pixels)
        return self.path(name)

    def test_cells_are_means(self):
        pixels = np.random.default_rng(3).integers(0, 256, (80, 80, 3), dtype=np.uint8)
        colours = pattern_from_picture(self.picture(pixels), 8).colours
        means = pixels.reshape(8, 10, 8, 10, 3).mean(axis=(1, 3))
        np.testing.assert_allclose(colours, np.moveaxis(means, 2, 0), atol=0.501)

    def test_cells_that_share_pixels(self):
        # 6 pixels on 4 cells: each cell has one pixel and half of the next.
        row = np.array([0, 60, 90, 30, 240, 120], dtype=np.uint8)
        pixels = np.repeat(np.repeat(row[None, :, None], 6, axis=0), 3, axis=2)
        self.assertEqual(pattern_from_picture(self.picture(pixels), 4).colours[1, 2].tolist(),
                         [20, 80, 100, 160])

    def test_transparent_is_white(self):
        pixels = np.zeros((16, 16, 4), dtype=np.uint8)
        pixels[:8, :, 3] = 255
        luma = pattern_from_picture(self.picture(pixels), 4).luma
        np.testing.assert_allclose(luma[:, 0], [0, 0, 255, 255])

    def test_sixteen_bits_and_grey(self):
        levels = np.tile(np.array([0, 21845, 43690, 65535], dtype=np.uint16), (4, 1))
        np.testing.assert_allclose(pattern_from_picture(self.picture(levels), 4).luma[2],
                                   [0, 85, 170, 255], atol=1.0)

    def test_bad_pictures(self):
        with self.assert_error("picture.png", "square", "found 40 x 30 pixels"):
            pattern_from_picture(self.picture(np.zeros((30, 40), np.uint8)), 16)
        with self.assert_error("picture.png", "at least 16 x 16 pixels", "found 15 x 15"):
            pattern_from_picture(self.picture(np.zeros((15, 15), np.uint8)), 16)
        with self.assert_error("text.png", "expected a picture"):
            pattern_from_picture(self.write("text.png", "none"), 16)
        with self.assert_error("none.png", "cannot be read"):
            pattern_from_picture(self.path("none.png"), 16)


class MakePatternTest(FileTest):
    def picture(self, name, greys):
        cv2.imwrite(self.path(name), np.kron(np.array(greys, np.uint8), np.ones((40, 40), np.uint8)))
        return self.path(name)

    def make(self, picture, *arguments):
        return self.run_tool("make_pattern", picture, "--output", self.path("out.patt"), *arguments)

    def test_pattern_of_a_picture(self):
        greys = [[0, 0, 0, 255], [0, 255, 255, 255], [0, 255, 0, 255], [255, 255, 255, 255]]
        result = self.make(self.picture("p.png", greys), "--size", "8")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertNotIn("warning", result.stdout)
        np.testing.assert_allclose(read_pattern(self.path("out.patt")).luma,
                                   np.kron(greys, np.ones((2, 2))))

    def test_what_is_hard_to_recognize_is_said(self):
        striped = self.make(self.picture("p.png", [[0], [255], [255], [0]] * np.ones((1, 4))))
        self.assertIn("alike when turned by 180 degrees", striped.stdout)
        pale = self.make(self.picture("p.png", [[120, 160], [120, 120]]))
        self.assertIn("warning: little contrast", pale.stdout)
        self.assert_refused(self.make(self.picture("p.png", [[128, 130], [128, 129]])), "p.png",
                            "contrast", "found 0.")

    def test_how_like_others_it_is(self):
        corner = [[0, 255, 255], [255, 255, 255], [255, 255, 255]]
        self.make(self.picture("p.png", corner), "--size", "6")
        os.rename(self.path("out.patt"), self.path("corner.patt"))
        half = np.repeat([[0], [0], [255]], 3, axis=1)
        self.make(self.picture("p.png", half), "--size", "6")
        os.rename(self.path("out.patt"), self.path("half.patt"))
        result = self.make(self.picture("p.png", np.rot90(corner)), "--size", "6", "--beside",
                           self.path("corner.patt"), self.path("half.patt"))
        self.assertEqual(result.returncode, 0, result.stderr)
        lines = result.stdout.splitlines()
        self.assertIn("corner.patt turned by 90 degrees: correlation 1.00", result.stdout)
        self.assertEqual(sum("too like" in line and "corner.patt" in line for line in lines), 1)
        # One black cell of nine, within the six of the other: sqrt(1/8 * 1/2).
        self.assertTrue(any("half.patt turned by" in line and line.endswith("correlation 0.25")
                            for line in lines), result.stdout)
        self.assertEqual(sum("warning" in line for line in lines), 1)

    def test_bad_input(self):
        good = self.picture("p.png", [[0, 255], [255, 255]])
        self.assert_refused(self.make(self.path("none.png")), "none.png")
        self.assert_refused(self.make(good, "--beside", self.path("none.patt")), "none.patt")
        self.assertFalse(os.path.exists(self.path("out.patt")))
        self.assert_refused(self.run_tool("make_pattern", good, "--output", good), "p.png",
                            "overwritten")
        for arguments in (("--size", "3"), ("--size", "65"), ("--size", "many")):
            self.assertEqual(self.make(good, *arguments).returncode, 2)
        self.assertEqual(self.run_tool("make_pattern", good).returncode, 2)


class OwnPatternsTest(unittest.TestCase):
    """The patterns of the package, and the map that uses them."""

    def patterns(self):
        marker_map = load_marker_map(os.path.join(ROOT, "maps", "paper_artoolkit.yaml"))
        return marker_map, {marker.pattern.name: marker.pattern.picture
                            for marker in marker_map.markers}

    def test_they_are_unlike(self):
        _, patterns = self.patterns()
        greys = {name: pattern.luma.ravel() for name, pattern in patterns.items()}
        self.assertEqual(len(greys), 9)
        for name, pattern in patterns.items():
            for other in patterns:
                turns = (1, 2, 3) if other == name else (0, 1, 2, 3)
                for turn in turns:
                    correlation = np.corrcoef(greys[other], np.rot90(pattern.luma, turn).ravel())
                    self.assertLess(correlation[0, 1], 0.5, (name, other, turn))

    def test_the_map_is_that_of_the_paper(self):
        marker_map, _ = self.patterns()
        paper = load_marker_map(os.path.join(ROOT, "maps", "paper.yaml"))
        self.assertEqual(len(marker_map.markers), 17)
        for marker, same in zip(marker_map.markers, paper.markers):
            self.assertEqual((marker.name, marker.size), (same.name, same.size))
            np.testing.assert_array_equal(marker.position, same.position)
            np.testing.assert_allclose(marker.normal, same.normal, atol=1e-12)


if __name__ == "__main__":
    unittest.main()
