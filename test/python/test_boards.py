"""Calibration boards, against the rules of Kalibr and the drawings of OpenCV."""

import os
import re
import unittest
import zlib

from source_tree import FileTest

import cv2
import numpy as np
from omnitag.board_file import load_board
from omnitag.marker_map import load_marker_map
from omnitag.printing.board_page import BoardSheet
from omnitag.printing.paper import PAPERS
from omnitag.printing.poster import tiles
from omnitag.rendering.free_space import FreeSpace
from omnitag.rendering.povray import render
from omnitag.rendering.scene import board_bitmaps, marker_bitmaps, world_scene
from omnitag.rendering.world import load_world
from omnitag.tag_bitmap import tag_bitmap, tag_family

BOARDS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "config", "boards")
MM_PER_POINT = 25.4 / 72.0
PIXELS_PER_MM = 300.0 / 25.4

APRILGRID = """\
target_type: 'aprilgrid' #gridtype
tagCols: 3
tagRows: 2
tagSize: 0.02
tagSpacing: 0.25
"""
CHARUCO = """\
target_type: charuco
columns: {columns}
rows: {rows}
square_size: 0.02
marker_size: 0.014
dictionary: {dictionary}
"""

# The codes of some ids in Kalibr's kalibr_create_target_pdf.
KALIBR_CODES = {0: 0xD5D628584, 1: 0xD97F18B49, 5: 0xF31DAB3AC, 100: 0x50F1D3251, 586: 0xE83BE4B73}


WORLD = """\
marker_map: map.yaml
camera: {frame_id: eye, position: [0, 0, 1.1], orientation: [1, 0, 0, 0]}
images: {start: 0, noise: 0}
ambient: 1
lights: []
materials: [{name: paint, grey: 0.5}]
room: {x: [-2, 2], y: [-2, 2], height: 3, floor: paint, walls: paint, ceiling: paint}
boards: {thickness: 0.02, quiet_modules: 2, black: 0.2, white: 0.8, back: paint}
"""


def kalibr_s_tag(code):
    """(10, 10), True is black: a tag as kalibr_create_target_pdf draws it, row 0 on top.

    It sets bit 6 i + j of the code, black where that is 0, in row i and column j, turns all by 180
    degrees, and adds a black border of two modules.
    """
    bits = np.array([[not code >> (6 * row + column) & 1 for column in range(6)] for row in range(6)])
    return np.pad(bits[::-1, ::-1], 2, constant_values=True)


class AprilgridFamilyTest(FileTest):
    def test_codes_and_widths(self):
        family = tag_family("aprilgrid")
        self.assertEqual((family.number_of_ids, family.width_at_border, family.total_width), (587, 10, 12))
        for tag_id, code in KALIBR_CODES.items():
            modules = tag_bitmap("aprilgrid", tag_id).modules
            np.testing.assert_array_equal(~modules[1:-1, 1:-1], kalibr_s_tag(code), str(tag_id))
            self.assertTrue(modules[[0, -1]].all() and modules[:, [0, -1]].all())

    def test_ids_that_there_are_not(self):
        with self.assert_error("0 to 586 in aprilgrid", "587"):
            tag_bitmap("aprilgrid", 587)

    def test_maps_take_it(self):
        head = "family: aprilgrid\nsize: 0.2\nmarkers:\n"
        entry = "  - {{id: {}, position: [0, 0, 0], yaw: 0}}\n"
        marker, = load_marker_map(self.write("map.yaml", head + entry.format(586))).markers
        self.assertEqual(marker.kind, "aprilgrid id 586")
        with self.assert_error("map.yaml:4", "0 to 586"):
            load_marker_map(self.write("map.yaml", head + entry.format(587)))


class BoardFileTest(FileTest):
    def load(self, text):
        return load_board(self.write("b.yaml", text))

    def charuco(self, columns, rows, legacy="", dictionary="DICT_4X4_50"):
        return self.load(CHARUCO.format(columns=columns, rows=rows, dictionary=dictionary)
                         + (legacy and "legacy: {}\n".format(legacy)))

    def test_aprilgrid(self):
        # Kalibr's corner (row, column) of the grid of corners is at (column // 2 * 1.25 + column % 2) *
        # tagSize to the right, and the same upwards; tag 0 is at the lower left, tag 3 above it.
        board = self.load(APRILGRID)
        self.assertEqual([(marker.family, marker.id, marker.size) for marker in board.markers],
                         [("aprilgrid", index, 0.02) for index in range(6)])
        np.testing.assert_allclose(
            [(marker.x, marker.y) for marker in board.markers],
            [(0.010, 0.010), (0.035, 0.010), (0.060, 0.010),
             (0.010, 0.035), (0.035, 0.035), (0.060, 0.035)])
        # Squares of a gap's width at each corner of each tag.
        np.testing.assert_allclose(
            sorted((square.left, square.bottom, square.width) for square in board.squares),
            [(x, y, 0.005) for x in (-0.005, 0.020, 0.045, 0.070) for y in (-0.005, 0.020, 0.045)],
            atol=1e-12)
        np.testing.assert_allclose((board.left, board.bottom, board.width, board.height),
                                   (-0.005, -0.005, 0.080, 0.055))

    def test_charuco(self):
        # Black squares at the upper left, and wherever row and column are both even or both odd.
        board = self.charuco(3, 2)
        self.assertEqual([(marker.family, marker.id, marker.size) for marker in board.markers],
                         [("DICT_4X4_50", index, 0.014) for index in range(3)])
        np.testing.assert_allclose([(marker.x, marker.y) for marker in board.markers],
                                   [(0.03, 0.03), (0.01, 0.01), (0.05, 0.01)])
        np.testing.assert_allclose([(square.left, square.bottom, square.width) for square in board.squares],
                                   [(0.0, 0.02, 0.02), (0.04, 0.02, 0.02), (0.02, 0.0, 0.02)])
        self.assertEqual((board.left, board.bottom), (0.0, 0.0))
        np.testing.assert_allclose((board.width, board.height), (0.06, 0.04))

    def test_legacy(self):
        # Even rows: a white square at the upper left, with marker 0.
        board = self.charuco(3, 2, legacy="true")
        np.testing.assert_allclose([(marker.x, marker.y) for marker in board.markers],
                                   [(0.01, 0.03), (0.05, 0.03), (0.03, 0.01)])
        self.assertIn("before OpenCV 4.6", board.label[0])
        # Odd rows: no difference.
        for rows, same in ((3, True), (4, False)):
            old, new = (self.charuco(4, rows, legacy=legacy) for legacy in ("true", "false"))
            self.assertEqual(old == new, same)

    def test_the_samples(self):
        for name, paper in (("aprilgrid", "a3"), ("aprilgrid", "tabloid"), ("charuco", "a4"),
                            ("charuco", "letter")):
            board = load_board(os.path.join(BOARDS, name + ".yaml"))
            self.assertEqual(board.kind, name)
            self.assertTrue((np.sort(BoardSheet(board).least_page) <= np.sort(PAPERS[paper])).all())

    def test_errors_name_file_key_and_what_is_expected(self):
        charuco = CHARUCO.format(columns=8, rows=5, dictionary="DICT_5X5_100")
        for good, wrong, line, parts in (
                (APRILGRID, "target_type: checkerboard", 1, ("aprilgrid, charuco", "'checkerboard'")),
                (APRILGRID, "tagCols: 0", 2, ("at least 1",)),
                (APRILGRID, "tagCols: 3.0", 2, ("an integer",)),
                (APRILGRID, "tagRows: 300", 3, ("at most 587 tags, ids 0 to 586", "3 x 300")),
                (APRILGRID, "tagSize: -0.1", 4, ("positive", "metres")),
                (APRILGRID, "tagSpacing: 0", 5, ("share of tagSize",)),
                (APRILGRID, "tagSpacing: 1.1", 5, ("share of tagSize",)),
                (charuco, "columns: 1", 2, ("at least 2",)),
                (charuco, "rows: five", 3, ("an integer",)),
                (charuco, "rows: 30", 6, ("at least 120 markers", "DICT_5X5_100, which has 100")),
                (charuco, "square_size: .inf", 4, ("finite",)),
                (charuco, "marker_size: 0.02", 5, ("less than square_size, 0.02",)),
                (charuco, "dictionary: tag36h11", 6, ("DICT_4X4_50", "'tag36h11'")),
                (charuco, "dictionary: aprilgrid", 6, ("DICT_4X4_50", "'aprilgrid'"))):
            key = wrong.split(":")[0]
            named = "dictionary" if line == 6 else key
            with self.subTest(wrong), self.assert_error("b.yaml:{}: {}: ".format(line, named), *parts):
                self.load(re.sub("(?m)^{}:.*$".format(key), wrong, good))

    def test_errors_of_keys(self):
        charuco = CHARUCO.format(columns=8, rows=5, dictionary="DICT_5X5_100")
        for text, *parts in (
                (charuco + "legacy: 1\n", "b.yaml:7: legacy: ", "true or false", "'1'"),
                (charuco + "legacy: 'true'\n", "b.yaml:7: legacy: ", "true or false"),
                (charuco + "size: 1\n", "b.yaml:7: size: ", "marker_size", "unknown key"),
                (charuco + "tagSize: 1\n", "b.yaml:7: tagSize: ", "marker_size", "unknown key"),
                (APRILGRID + "rows: 1\n", "b.yaml:6: rows: ", "tagRows", "unknown key"),
                (APRILGRID + "tagRows: 1\n", "b.yaml:6: tagRows: ", "each key once"),
                ("tagRows: 1\n", "b.yaml:1: ", "'target_type'"),
                ("target_type: aprilgrid\ntagCols: 2\n", "b.yaml:1: ", "the key 'tagRows'"),
                ("[1, 2]\n", "b.yaml:1: ", "a mapping"), ("", "b.yaml: ", "an empty file")):
            with self.subTest(text), self.assert_error(*parts):
                self.load(text)
        with self.assert_error("none.yaml: cannot be read"):
            load_board("none.yaml")


def cells_of_the_aprilgrid():
    """(55, 80), True is black: cells of 1 mm of APRILGRID, by Kalibr's rule; row 0 is the lowest.

    Its tags are 20 mm wide, at a pitch of 25 mm, with squares of 5 mm between their corners and at the
    rim.
    """
    codes = [0xD5D628584, 0xD97F18B49, 0xDD280910E, 0xE479E9C98, 0xEBCBCA822, 0xF31DAB3AC]
    black = np.zeros((55, 80), dtype=bool)
    for row in range(2):
        for column in range(3):
            tag = np.kron(kalibr_s_tag(codes[3 * row + column])[::-1], np.ones((2, 2), dtype=bool))
            black[5 + 25 * row:25 + 25 * row, 5 + 25 * column:25 + 25 * column] = tag
    for row in range(3):
        for column in range(4):
            black[25 * row:25 * row + 5, 25 * column:25 * column + 5] = True
    return black


def opencv_s_board(columns, rows, dictionary, pixels, legacy):
    """OpenCV's drawing with squares of 10 and markers of 7 times `pixels`, or None if it has none.

    Boards of even rows: versions before 4.6 know the old pattern alone, 4.6 the new one, later ones both.
    """
    aruco = cv2.aruco
    words = aruco.getPredefinedDictionary(getattr(aruco, dictionary))
    size = (10 * pixels * columns, 10 * pixels * rows)
    if hasattr(aruco, "CharucoBoard_create"):
        version = tuple(int(number) for number in re.findall(r"\d+", cv2.__version__)[:2])
        if rows % 2 == 0 and legacy != (version < (4, 6)):
            return None
        return aruco.CharucoBoard_create(columns, rows, 0.02, 0.014, words).draw(size)
    if not hasattr(aruco, "CharucoBoard"):
        return None
    board = aruco.CharucoBoard((columns, rows), 0.02, 0.014, words)
    if legacy:
        if not hasattr(board, "setLegacyPattern"):
            return None
        board.setLegacyPattern(True)
    return board.generateImage(size)


class PrintedBoardTest(FileTest):
    def print_board(self, text, output, *arguments):
        result = self.run_tool("print_markers", "--board", self.write("b.yaml", text), "--output",
                               self.path(output), *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def picture(self, text, *arguments):
        """The printed page, as shares of white."""
        self.print_board(text, "b.png", *arguments)
        return cv2.imread(self.path("b.png"), cv2.IMREAD_GRAYSCALE) / 255.0

    def sample(self, picture, sheet, x, y):
        """What the page shows at places on the board, in m."""
        width, height = sheet.least_page
        left = 0.5 * (width - sheet.cut_size[0]) + sheet.quiet_zone
        top = 8.0 + sheet.quiet_zone
        columns = (left + 1e3 * (x - sheet.board.left)) * PIXELS_PER_MM
        rows = (top + 1e3 * (sheet.board.bottom + sheet.board.height - y)) * PIXELS_PER_MM
        self.assertAlmostEqual(picture.shape[0], height * PIXELS_PER_MM, delta=1.0)
        self.assertAlmostEqual(picture.shape[1], width * PIXELS_PER_MM, delta=1.0)
        return picture[np.floor(rows).astype(int), np.floor(columns).astype(int)]

    def test_every_cell_of_an_aprilgrid(self):
        picture = self.picture(APRILGRID, "--paper", "fit")
        sheet = BoardSheet(load_board(self.path("b.yaml")))
        x, y = np.meshgrid(np.arange(80) + 0.5, np.arange(55) + 0.5)
        seen = self.sample(picture, sheet, 1e-3 * x - 0.005, 1e-3 * y - 0.005)
        np.testing.assert_array_equal(seen, np.where(cells_of_the_aprilgrid(), 0.0, 1.0))

    def test_true_scale(self):
        # Lines of the picture across the board: where it changes from white to black.
        picture = self.picture(APRILGRID, "--paper", "a4")
        black = picture < 0.5
        # The ruler's line is thinner than 1 mm, and letters are no wider than 5 mm.
        kernel = np.ones((55, 55), np.uint8)
        solid = cv2.morphologyEx(black.astype(np.uint8), cv2.MORPH_OPEN, kernel)
        rows, columns = np.nonzero(solid)
        self.assertAlmostEqual((columns.max() - columns.min() + 1) / PIXELS_PER_MM, 80.0, delta=0.1)
        self.assertAlmostEqual((rows.max() - rows.min() + 1) / PIXELS_PER_MM, 55.0, delta=0.1)
        # The ruler is the longest line below the board.
        below = black[rows.max() + 1:]
        longest = max(below.sum(axis=1)) / PIXELS_PER_MM
        self.assertAlmostEqual(longest, 100.0, delta=0.3)

    def test_charuco_is_as_opencv_draws_it(self):
        compared = 0
        for columns, rows, legacy, dictionary in ((5, 3, False, "DICT_5X5_100"),
                                                  (4, 4, False, "DICT_5X5_100"),
                                                  (4, 4, True, "DICT_5X5_100"),
                                                  (3, 3, True, "DICT_5X5_100"),
                                                  (3, 2, False, "DICT_5X5_1000")):
            with self.subTest((columns, rows, legacy)):
                pixels = 20
                drawn = opencv_s_board(columns, rows, dictionary, pixels, legacy)
                if drawn is None:
                    continue
                compared += 1
                picture = self.picture(
                    CHARUCO.format(columns=columns, rows=rows, dictionary=dictionary)
                    + "legacy: {}\n".format(str(legacy).lower()), "--paper", "fit")
                sheet = BoardSheet(load_board(self.path("b.yaml")))
                step = 0.002 / pixels
                x, y = np.meshgrid((np.arange(drawn.shape[1]) + 0.5) * step,
                                   (drawn.shape[0] - np.arange(drawn.shape[0]) - 0.5) * step)
                seen = self.sample(picture, sheet, x, y)
                # All pixels of OpenCV's drawing but those within two of an edge: a pixel of the print
                # is as wide, and versions of OpenCV round differently.
                kernel = np.ones((5, 5), np.uint8)
                framed = cv2.copyMakeBorder(drawn, 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=128)
                inside = (cv2.erode(framed, kernel) == cv2.dilate(framed, kernel))[1:-1, 1:-1]
                self.assertGreater(inside.mean(), 0.6)
                np.testing.assert_array_equal(seen[inside], (drawn / 255.0)[inside])
        if not compared:
            self.skipTest("this OpenCV draws no ChArUco boards")

    def test_a_board_lies_on_its_side_if_it_has_to(self):
        wide = CHARUCO.format(columns=12, rows=5, dictionary="DICT_5X5_100")
        self.assertEqual(self.picture(wide).shape, (2480, 3507))
        self.assertEqual(self.picture(CHARUCO.format(columns=5, rows=5, dictionary="DICT_5X5_100")).shape,
                         (3507, 2480))

    def boxes(self, path):
        """Size of each page in mm and the closed paths of each in mm: left, bottom, right, top."""
        with open(path, "rb") as file:
            pdf = file.read()
        sizes = [tuple(float(number) * MM_PER_POINT for number in box.split()[2:])
                 for box in re.findall(rb"/MediaBox \[([^\]]*)\]", pdf)]
        boxes = []
        for stream in re.findall(rb"/FlateDecode[^>]*>>\s*stream\n(.*?)\nendstream", pdf, re.DOTALL):
            content = zlib.decompress(stream)
            paths = [np.array([[float(number) for number in line.split()[:2]]
                               for line in subpath.splitlines()[:-1]])
                     for subpath in re.findall(rb"(?:[-\d. ]+ [ml]\n)+h", content)]
            found = np.array([(*path.min(axis=0), *path.max(axis=0)) for path in paths])
            if len(found) > 4:
                boxes.append(found * MM_PER_POINT)
        return sizes, boxes

    def test_pdf(self):
        self.print_board(APRILGRID, "b.pdf")
        (size,), (boxes,) = self.boxes(self.path("b.pdf"))
        np.testing.assert_allclose(size, (210.0, 297.0), atol=0.01)
        widths = boxes[:, 2] - boxes[:, 0]
        modules = sum(int(kalibr_s_tag(code).sum()) for code in (
            0xD5D628584, 0xD97F18B49, 0xDD280910E, 0xE479E9C98, 0xEBCBCA822, 0xF31DAB3AC))
        self.assertEqual(np.count_nonzero(np.abs(widths - 2.0) < 1e-3), modules)
        squares = boxes[np.abs(widths - 5.0) < 1e-3]
        self.assertEqual(len(squares), 12)
        np.testing.assert_allclose(squares[:, 2:].max(axis=0) - squares[:, :2].min(axis=0), (80.0, 55.0),
                                   atol=1e-3)

    def test_svg_has_the_label_s_words(self):
        self.print_board(APRILGRID, "b.svg")
        with open(self.path("b.svg"), encoding="utf-8") as file:
            svg = file.read()
        self.assertIn('width="595.', svg)
        # Letters are drawn; comments name the texts.
        for words in ("b.yaml   AprilGrid of 3 x 2 tags", "tagSize 20 mm, tagSpacing 0.25 (5 mm)",
                      "ids 0 to 5 from the lower left", "this line is 100 mm long"):
            self.assertIn(words, svg)

    def test_a_poster_shows_every_part_at_its_place(self):
        # 0.45 m wide: on a4, 3 x 2 sheets on their side or 3 x 2 upright.
        large = APRILGRID.replace("0.02", "0.12")
        result = self.run_tool("print_markers", "--board", self.write("b.yaml", large), "--output",
                               self.path("no.pdf"))
        self.assert_refused(result, "b.yaml", "480 x 330 mm", "a4 has 210 x 297", "fits is a2", "--poster")
        self.assertFalse(os.path.exists(self.path("no.pdf")))
        self.print_board(large, "whole.pdf", "--paper", "fit")
        (whole_size,), (whole,) = self.boxes(self.path("whole.pdf"))
        self.print_board(large, "b.pdf", "--poster")
        sizes, boxes = self.boxes(self.path("b.pdf"))
        self.assertGreater(len(sizes), 3)
        covered = np.zeros(np.ceil(whole_size[::-1]).astype(int), dtype=bool)
        for size, page in zip(sizes, boxes):
            np.testing.assert_allclose(sorted(size), (210.0, 297.0), atol=0.01)
            shift = page[-1, :2] - whole[-1, :2]
            np.testing.assert_allclose(page[-500:] - whole[-500:], np.tile(shift, (500, 2)), atol=0.01)
            left, bottom = np.rint(8.0 - shift).astype(int)
            covered[max(bottom, 0):bottom + int(size[1]) - 16, max(left, 0):left + int(size[0]) - 16] = True
        self.assertTrue(covered[8:-8, 8:-8].all())

    def test_a_poster_of_what_fits_is_one_page(self):
        self.assertIn(": 1 page\n", self.print_board(APRILGRID, "b.pdf", "--poster"))
        # It fills the paper but for the margins of less than a poster's.
        narrow = "size: 0.154\nfamily: tag36h11\nmarkers: [{id: 0, position: [0, 0, 0], yaw: 0}]\n"
        result = self.run_tool("print_markers", "--map", self.write("map.yaml", narrow), "--output",
                               self.path("m.pdf"), "--poster")
        self.assertIn(": 1 page\n", result.stdout)

    def test_the_sheets_of_a_poster_meet_where_they_are_glued(self):
        sheets = tiles((500.0, 400.0), (210.0, 297.0))
        for tile in sheets:
            for other in sheets:
                if (other.row, other.column) == (tile.row, tile.column + 1):
                    self.assertAlmostEqual(other.left + 10.0, tile.left + tile.printed[0])
                if (other.row, other.column) == (tile.row + 1, tile.column):
                    self.assertAlmostEqual(other.bottom + other.printed[1] - 10.0, tile.bottom)

    def test_bad_arguments(self):
        path = self.write("b.yaml", APRILGRID)
        output = ("--output", self.path("b.pdf"))
        self.assert_refused(self.run_tool("print_markers", "--board", "none.yaml", *output), "none.yaml")
        for arguments in (("--board", path), ("--board", path, "--map", path, *output), output,
                          ("--board", path, "--checklist", *output)):
            self.assertEqual(self.run_tool("print_markers", *arguments).returncode, 2)


class RenderedBoardTest(FileTest):
    """In a room, head-on and without perspective."""

    PIXELS_PER_MM = 4

    def world(self, more, board=APRILGRID):
        self.write("map.yaml", "family: aprilgrid\nsize: 0.2\nmarkers:\n"
                               "  - {id: 0, position: [1.9, 0, 1], yaw: 0}\n")
        self.write("b.yaml", board)
        return load_world(self.write("world.yaml", WORLD + "calibration_boards: [{board: b.yaml, "
                                     + more + "}]\n"))

    def picture(self, world, width, height, moment=0):
        """What is seen at x = -1.9, y = 0.3, z = 1.2 by who looks along -x, upright; sizes in mm."""
        camera = """camera {{ orthographic location <0, 300, 1200> direction <-1, 0, 0>
            right <0, {}, 0> up <0, 0, {}> }}
            """.format(width, height)
        bitmaps = {**marker_bitmaps(world.hung_markers.ever(), world.boards),
                   **board_bitmaps(world.hung_boards, world.boards)}
        return render(camera + world_scene(world, moment), bitmaps, self.PIXELS_PER_MM * width,
                      self.PIXELS_PER_MM * height)

    def test_every_cell_of_an_aprilgrid(self):
        # Turned by a quarter: the board's x is up, and its y to the left.
        world = self.world("position: [-1.9, 0.3, 1.2], yaw: 0, roll: {}".format(np.pi / 2))
        picture = self.picture(world, 65, 90)
        # The board's rim is two modules of 2 mm, then the wall.
        cells = np.where(cells_of_the_aprilgrid(), 0.2, 0.8)
        cells = np.pad(np.pad(cells, 4, constant_values=0.8), 1, constant_values=0.5)
        upright = np.rot90(cells[::-1])
        centres = self.PIXELS_PER_MM // 2
        for shift in (-1, 0):
            seen = picture[centres + shift::self.PIXELS_PER_MM, centres + shift::self.PIXELS_PER_MM]
            np.testing.assert_allclose(seen, upright, atol=1e-4)

    def test_charuco(self):
        world = self.world("position: [-1.9, 0.3, 1.2], yaw: 0",
                           CHARUCO.format(columns=3, rows=2, dictionary="DICT_5X5_100"))
        picture = self.picture(world, 60, 40)
        # Where squares begin, at the upper left, there is no marker.
        expected = np.array([[0.2, 0.8, 0.2], [0.8, 0.2, 0.8]])
        np.testing.assert_allclose(picture[4::80, 4::80], expected, atol=1e-4)
        modules = tag_bitmap("DICT_5X5_100", 0).modules[1:-1, 1:-1]
        marker = picture[3 * 4 + 4:17 * 4:8, 23 * 4 + 4:37 * 4:8]
        np.testing.assert_allclose(marker, np.where(modules, 0.8, 0.2), atol=1e-4)

    def test_for_a_while(self):
        world = self.world("position: [-1.9, 0.3, 1.2], yaw: 0, during: [[1, 2]]")
        for seconds, light in ((0, 0.5), (1, 0.8)):
            picture = self.picture(world, 2, 2, seconds * 10**9)
            # The board's middle is in the gap between its rows, before a wall of 0.5.
            self.assertAlmostEqual(float(picture[4, 4]), light, places=3)

    def test_a_route_keeps_off_it(self):
        space = FreeSpace(self.world("position: [0.5, 0.3, 1.2], yaw: 0"))
        self.assertLess(space.clearance(0.495, 0.3), 0.0)
        self.assertGreater(space.clearance(0.6, 0.3), 0.05)

    def test_errors(self):
        with self.assert_error("world.yaml:9: ", "calibration_boards[0].board", "a board file",
                               "b.yaml:1: target_type"):
            self.world("position: [0, 0, 0], yaw: 0", "target_type: circlegrid\n")
        with self.assert_error("world.yaml:9: ", "'yaw' or 'orientation'"):
            self.world("position: [0, 0, 0]")


if __name__ == "__main__":
    unittest.main()
