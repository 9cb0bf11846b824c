import re
import unittest
import zlib

from source_tree import FileTest

import cv2
import numpy as np
from omnitag.marker_map import load_marker_map
from omnitag.printing.checklist import row_of
from omnitag.printing.paper import PAPERS
from omnitag.tag_bitmap import FAMILIES, tag_bitmap, tag_family

MM_PER_POINT = 25.4 / 72.0
HEAD = "frame_id: map\nfamily: tag36h11\nsize: 0.1\nmarkers:\n"

# The code of tag36h11 id 0 in the family's first publication: 6 x 6 bits, row by row, 1 is white.
TAG36H11_0 = 0xD5D628584


def white_modules_of_tag36h11_0():
    """The bits within a black border, which is within a white one; row 0 is the upper edge."""
    modules = np.pad(np.zeros((8, 8), dtype=bool), 1, constant_values=True)
    modules[2:8, 2:8] = np.array([int(bit) for bit in "{:036b}".format(TAG36H11_0)]).reshape(6, 6)
    return modules


class TagBitmapTest(FileTest):
    def test_widths_and_counts(self):
        # Bits, border and count as published with the families.
        for name, ids, at_border, total in (("tag16h5", 30, 6, 8), ("tag25h9", 35, 7, 9),
                                            ("tag36h11", 587, 8, 10),
                                            ("tagStandard41h12", 2115, 5, 9)):
            family = tag_family(name)
            self.assertEqual((family.number_of_ids, family.width_at_border, family.total_width),
                             (ids, at_border, total))

    def test_pattern(self):
        np.testing.assert_array_equal(tag_bitmap("tag36h11", 0).modules,
                                      white_modules_of_tag36h11_0())

    def test_aruco_is_read_as_it_is_drawn(self):
        # By OpenCV's detector, which looks at the picture alone.
        parameters = (cv2.aruco.DetectorParameters() if hasattr(cv2.aruco, "ArucoDetector")
                      else cv2.aruco.DetectorParameters_create())
        for name, tag_id in (("DICT_4X4_50", 17), ("DICT_5X5_100", 23), ("DICT_6X6_250", 111),
                             ("DICT_7X7_1000", 999), ("DICT_ARUCO_ORIGINAL", 1000)):
            modules = np.pad(tag_bitmap(name, tag_id).modules, 2, constant_values=True)
            picture = np.kron(255 * modules.astype(np.uint8), np.ones((20, 20), np.uint8))
            dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, name))
            corners, ids, _ = cv2.aruco.detectMarkers(picture, dictionary, parameters=parameters)
            self.assertEqual(ids.ravel().tolist(), [tag_id], name)
            # The first is the upper left one of the upright marker.
            np.testing.assert_allclose(corners[0][0][0], (59.5, 59.5), atol=1.0)

    def test_every_family_draws(self):
        for name in FAMILIES:
            if name.startswith("DICT_") and not hasattr(cv2.aruco, name):
                continue
            bitmap = tag_bitmap(name, tag_family(name).number_of_ids - 1)
            self.assertEqual(bitmap.modules.shape, (bitmap.family.total_width,) * 2)

    def test_unknown_tags_are_refused(self):
        with self.assert_error("tag36h11", "'aruco'"):
            tag_family("aruco")
        for tag_id in (-1, 587):
            with self.assert_error("0 to 586", str(tag_id)):
                tag_bitmap("tag36h11", tag_id)


def filled_boxes(content):
    """Bounding boxes in points of the subpaths of a PDF content stream that are closed."""
    boxes = []
    for subpath in re.findall(rb"(?:[-\d. ]+ [ml]\n)+h", content):
        points = np.array([[float(number) for number in line.split()[:2]]
                           for line in subpath.splitlines()[:-1]])
        boxes.append((*points.min(axis=0), *points.max(axis=0)))
    return np.array(boxes)


class PrintMarkersTest(FileTest):
    def pages(self, entries, *arguments):
        """Page size in mm and boxes of the closed paths in mm, of each page."""
        result = self.run_tool("print_markers", "--map", self.write("map.yaml", HEAD + entries),
                               "--output", self.path("m.pdf"), *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.path("m.pdf"), "rb") as file:
            pdf = file.read()
        sizes = [tuple(float(number) * MM_PER_POINT for number in box.split()[2:])
                 for box in re.findall(rb"/MediaBox \[([^\]]*)\]", pdf)]
        contents = [zlib.decompress(stream) for stream in
                    re.findall(rb"/FlateDecode[^>]*>>\s*stream\n(.*?)\nendstream", pdf, re.DOTALL)]
        boxes = [filled_boxes(content) * MM_PER_POINT for content in contents]
        return sizes, [box for box in boxes if len(box) > 4]

    def test_one_page_for_each_family_id_and_size(self):
        sizes, boxes = self.pages(
            "  - {id: 1, position: [0, 0, 0], yaw: 0}\n"
            "  - {id: 1, name: again, position: [1, 0, 0], yaw: 0}\n"
            "  - {id: 1, size: 0.05, position: [2, 0, 0], yaw: 0}\n"
            "  - {id: 1, family: tag16h5, position: [3, 0, 0], yaw: 0}\n")
        self.assertEqual(len(boxes), 3)
        np.testing.assert_allclose(sizes, [(210.0, 297.0)] * 3, atol=0.01)

    def test_true_size(self):
        _, (boxes,) = self.pages("  - {id: 0, position: [0, 0, 0], yaw: 0}\n")
        widths = boxes[:, 2] - boxes[:, 0]
        modules = boxes[np.abs(widths - 100.0 / 8.0) < 1e-3]
        self.assertEqual(len(modules), np.count_nonzero(~white_modules_of_tag36h11_0()))
        left, bottom = modules[:, :2].min(axis=0)
        right, top = modules[:, 2:].max(axis=0)
        self.assertAlmostEqual(right - left, 100.0, places=3)
        self.assertAlmostEqual(top - bottom, 100.0, places=3)
        drawn = np.ones((10, 10), dtype=bool)
        for x, y in np.rint((modules[:, :2] - (left, bottom)) / 12.5).astype(int):
            drawn[8 - y, x + 1] = False
        np.testing.assert_array_equal(drawn, white_modules_of_tag36h11_0())

    def test_a_tag_that_is_too_large(self):
        big = "  - {id: 5, size: 0.2, position: [0, 0, 0], yaw: 0}\n"
        path = self.write("map.yaml", HEAD + big)
        self.assert_refused(
            self.run_tool("print_markers", "--map", path, "--output", self.path("no.pdf")),
            "map.yaml", "id 5", "0.2 m", "a4 has 210 x 297", "fits is a3")
        with self.assertRaises(FileNotFoundError):
            open(self.path("no.pdf"), "rb")
        self.assertEqual(len(self.pages(big, "--paper", "a3")[0]), 1)
        (width, height), = self.pages(big, "--paper", "fit")[0]
        self.assertTrue(250.0 < width < 280.0 and 290.0 < height < 320.0)

    def test_a_poster_shows_every_part_at_its_place(self):
        # 0.5 m at the corners: more than an a4 page in either direction.
        big = "  - {id: 0, size: 0.5, position: [0, 0, 0], yaw: 0}\n"
        sizes, boxes = self.pages(big, "--poster")
        (whole_size,), (whole,) = self.pages(big, "--paper", "fit")
        printed = np.array(sizes[0]) - 16.0
        covered = np.zeros(np.ceil(whole_size).astype(int), dtype=bool)
        for size, page in zip(sizes, boxes):
            np.testing.assert_allclose(sorted(size), (210.0, 297.0), atol=0.01)
            # All of the page is drawn on each sheet, shifted, and cut off at its margins.
            shift = page[-1, :2] - whole[-1, :2]
            np.testing.assert_allclose(page[-40:] - whole[-40:], np.tile(shift, (40, 2)),
                                       atol=0.01)
            left, bottom = np.rint(8.0 - shift).astype(int)
            covered[max(left, 0):left + int(printed[0]), max(bottom, 0):bottom + int(printed[1])] = True
        self.assertTrue(covered[8:-8, 8:-8].all())

    def test_papers(self):
        # ISO 216: each A or B is the next larger one halved, and A0 has a square metre, B0 a metre's
        # width. The US sizes are in inches.
        for series, width in (("a", 1000.0 / 2 ** 0.25), ("b", 1000.0)):
            height = width * 2 ** 0.5
            for number in range(6):
                np.testing.assert_allclose(PAPERS["{}{}".format(series, number)], (width, height),
                                           atol=1.5)
                width, height = height / 2, width
        for name, inches in (("letter", (8.5, 11)), ("legal", (8.5, 14)), ("tabloid", (11, 17)),
                             ("ansi_c", (17, 22)), ("ansi_d", (22, 34)), ("ansi_e", (34, 44)),
                             ("arch_a", (9, 12)), ("arch_b", (12, 18)), ("arch_c", (18, 24)),
                             ("arch_d", (24, 36)), ("arch_e1", (30, 42)), ("arch_e", (36, 48))):
            np.testing.assert_allclose(PAPERS[name], 25.4 * np.array(inches))

    def test_the_paper_that_fits_is_of_the_same_series(self):
        path = self.write("map.yaml", HEAD + "  - {id: 5, size: 0.2, position: [0, 0, 0], yaw: 0}\n")
        for paper, fits in (("a4", "a3"), ("b5", "b3"), ("letter", "tabloid"), ("arch_a", "arch_b")):
            self.assert_refused(
                self.run_tool("print_markers", "--map", path, "--output", self.path("no.pdf"),
                              "--paper", paper), "the smallest paper that fits is {},".format(fits))

    def test_one_picture_for_each_page(self):
        two = ("  - {id: 0, position: [0, 0, 0], yaw: 0}\n"
               "  - {id: 3, position: [1, 0, 0], yaw: 0}\n")
        result = self.run_tool("print_markers", "--map", self.write("map.yaml", HEAD + two),
                               "--output", self.path("m.png"))
        self.assertEqual(result.returncode, 0, result.stderr)
        picture = cv2.imread(self.path("m-tag36h11-0.png"), cv2.IMREAD_GRAYSCALE)
        # a4 at 300 dots per inch
        np.testing.assert_allclose(picture.shape, (297.0 / 25.4 * 300.0, 210.0 / 25.4 * 300.0), atol=1.0)
        black = np.argwhere(picture < 64)
        modules = picture[black[:, 0].min():black[:, 0].min() + 1181,
                          black[:, 1].min():black[:, 1].min() + 1181]
        sampled = cv2.resize(modules, (8, 8), interpolation=cv2.INTER_AREA) > 127
        np.testing.assert_array_equal(sampled, white_modules_of_tag36h11_0()[1:-1, 1:-1])
        self.assertIsNotNone(cv2.imread(self.path("m-tag36h11-3.png")))

    def test_the_checklist_says_where_markers_hang(self):
        hung = ("  - {id: 0, name: door, position: [1, -2, 1.5], yaw: 1.5708}\n"
                "  - {id: 3, position: [1, 0, 1.2], yaw: 0, roll: 0.7854}\n"
                "  - {id: 4, position: [0, 0, 3], orientation: [1, 0, 0, 0]}\n")
        path = self.write("map.yaml", HEAD + hung)
        rows = [row_of(marker) for marker in load_marker_map(path).markers]
        self.assertEqual(rows[0], ("door", "tag36h11 0", "0.1", "1.000", "-2.000", "1.500", "1.450",
                                   "90.0°"))
        # Its lowest point is a corner, half a diagonal below the centre.
        self.assertEqual(rows[1][6:], ("{:.3f}".format(1.2 - 0.05 * 2 ** 0.5), "0.0°, turned 45.0°"))
        self.assertEqual(rows[2][7], "down")
        sizes, boxes = self.pages(hung, "--checklist")
        self.assertEqual((len(sizes), len(boxes)), (4, 3))

    def test_bad_input(self):
        good = self.write("map.yaml", HEAD + "  - {id: 5, position: [0, 0, 0], yaw: 0}\n")
        self.assert_refused(self.run_tool("print_markers", "--map", "none.yaml", "--output",
                                          self.path("m.pdf")), "none.yaml")
        self.assert_refused(self.run_tool("print_markers", "--map", good, "--output",
                                          self.path("none/m.pdf")), "none/m.pdf")
        output = ("--output", self.path("m.pdf"))
        self.assert_refused(self.run_tool("print_markers", "--map", good, "--output", "m.jpg"),
                            "--output", ".png", "m.jpg")
        for arguments in ((), ("--map", good), ("--map", good, *output, "--paper", "c5")):
            self.assertEqual(self.run_tool("print_markers", *arguments).returncode, 2)


if __name__ == "__main__":
    unittest.main()
