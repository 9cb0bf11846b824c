"""The reference in doc/ is what scripts/make_reference makes, which sees where the sources differ from it."""

import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
READ = ["cmake", "config", "doc/reference", "msg", "scripts/make_reference", "src", "srv", "tools"]


def check(root: Path) -> str:
    """What the script says of the pages of a folder."""
    result = subprocess.run([sys.executable, str(root / "scripts" / "make_reference"), "--check"],
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
                            check=False)
    assert (result.returncode == 0) == (result.stdout == ""), result.stdout
    return result.stdout


class Reference(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        for name in READ:
            copy = self.root / name
            copy.parent.mkdir(parents=True, exist_ok=True)
            (shutil.copytree if (ROOT / name).is_dir() else shutil.copy)(ROOT / name, copy)

    def assert_seen(self, name: str, old: str, new: str, *complaints: str) -> None:
        """Whoever changes a file in this way is told so."""
        path = self.root / name
        text = path.read_text(encoding="utf-8")
        self.assertIn(old, text)
        path.write_text(text.replace(old, new), encoding="utf-8")
        found = check(self.root)
        path.write_text(text, encoding="utf-8")
        for complaint in complaints:
            self.assertIn(complaint, found)

    def test_is_what_the_script_makes(self):
        self.assertEqual(check(ROOT), "", "run scripts/make_reference")

    def test_parameters(self):
        self.assert_seen("config/localizer.yaml", "\nqueue_size: 1\n", "\nqueue_size: 2\n",
                         "parameters.md: is not what")
        self.assert_seen("config/localizer.yaml", "\nqueue_size: 1\n", "\n", "lacks queue_size")
        self.assert_seen("src/ros/parameters.cpp", '"drag_markers",', '"drag_markers", "shake_markers",',
                         "lacks parameters shake_markers")
        self.assert_seen("src/marker/marker_association.cpp", '"max_roll"', '"max_turn"',
                         "lacks `max_turn`", "has `max_roll`")
        self.assert_seen("src/ros/live_tuning.cpp", "-1.0, 1.0,", "-2.0, 1.0,", "parameters.md: is not what")

    def test_topics_and_services(self):
        server = "src/ros/localizer_server.cpp"
        self.assert_seen(server, '>("path"', '>("route"', "lacks `route`", "has `path`")
        self.assert_seen(server, "<nav_msgs::Path>", "<nav_msgs::Route>", "`path` is of type Route")
        self.assert_seen(server, '"initialpose"', "initial_topic_", "does not know the topic initial_topic_")
        self.assert_seen("src/ros/map_services.cpp", '"reload_map"', '"read_map"',
                         "lacks `read_map`", "has `reload_map`")
        self.assert_seen("src/ros/marker_dragging.cpp", "MarkerDragging::show() {",
                         'MarkerDragging::show() { node_.advertise<Shown>("shown", 1);', "lacks `shown`")

    def test_messages(self):
        self.assert_seen("msg/MapMarker.msg", "bool ignored", "bool left_out", "topics.md: is not what")
        (self.root / "msg" / "New.msg").write_text("int32 id\n", encoding="utf-8")
        self.assertIn("lacks message msg/New.msg", check(self.root))

    def test_files(self):
        self.assert_seen("src/camera/catadioptric_reader.cpp", '"rim_radius"', '"edge_radius"',
                         "lacks `mirror.edge_radius`", "has `mirror.rim_radius`")
        self.assert_seen("src/marker/marker_map_file.cpp", '"border", "name"', '"border", "colour", "name"',
                         "lacks `colour`")
        self.assert_seen("src/planning/occupancy_grid.cpp", '"mode"', '"kind"', "lacks `kind`", "has `mode`")
        self.assert_seen("src/ros/localize_bag/result_files.cpp", "stamp,x,y,yaw", "stamp,x,yaw,y",
                         "have another order")
        self.assert_seen("doc/reference/files.md", "| `border` |", "| `frame` |",
                         "lacks `border`", "has `frame`")
        (self.root / "src" / "camera" / "new_reader.cpp").write_text(
            'Camera readNew(const YamlReader& file) {\n  file.allowOnly({"model"});\n}\n', encoding="utf-8")
        self.assertIn("lacks keys src/camera/new_reader.cpp:readNew", check(self.root))

    def test_tools(self):
        self.assert_seen("cmake/ros_layer.cmake", "  tools/make_film\n", "", "has tools make_film")
        self.assert_seen("cmake/ros_layer.cmake", "  tools/make_film\n", "  tools/make_play\n",
                         "tools/make_play: is not there")


if __name__ == "__main__":
    unittest.main()
