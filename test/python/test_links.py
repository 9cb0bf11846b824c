"""The links within the documentation lead somewhere."""

import re
import unittest
from pathlib import Path
from typing import List, Set

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "worlds" / "README.md",
         *sorted((ROOT / "doc").glob("**/*.md"))]


def text_of(page: Path) -> str:
    """A page without its code."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"^    .*$", "", text, flags=re.MULTILINE)


def anchors_of(page: Path) -> List[str]:
    """The anchors of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", text_of(page), re.MULTILINE)
    return [re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings]


def broken_links(page: Path) -> Set[str]:
    """The links to files and headings that are not there."""
    broken = set()
    for link in re.findall(r"\]\(([^)\s]+)\)", text_of(page)):
        path, _, anchor = link.partition("#")
        target = page.parent / path if path else page
        if link.startswith(("http://", "https://")):
            continue
        if not target.exists() or (anchor and anchors_of(target).count(anchor) != 1):
            broken.add(link)
    return broken


class Links(unittest.TestCase):

    def test_lead_somewhere(self):
        for page in PAGES:
            with self.subTest(page.relative_to(ROOT)):
                self.assertEqual(broken_links(page), set())

    def test_lead_to_every_page(self):
        """From the README, directly or by way of others."""
        reached = [ROOT / "README.md"]
        for page in reached:
            links = re.findall(r"\]\(([^)\s#]+\.md)", text_of(page))
            reached += [path for path in sorted({(page.parent / link).resolve() for link in links})
                        if path not in reached and path.exists()]
        self.assertEqual(set(PAGES) - set(reached), set())


if __name__ == "__main__":
    unittest.main()
