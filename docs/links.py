"""Checks that the links of a book's pages lead to files and headings.

    links.py FOLDER
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    def __init__(self, path: Path):
        super().__init__()
        self.links, self.names = [], set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        self.names.add(attributes.get("id"))
        self.links.extend(attributes[key] for key in ("href", "src") if attributes.get(key))


def problem(page: Path, link: str, pages: dict) -> bool:
    """Whether a link of a page leads nowhere."""
    parts = urlsplit(link)
    if parts.scheme or parts.netloc:
        return False
    target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
    if target.is_dir() and (target / "index.html").exists():
        target = target / "index.html"
    if not target.exists():
        return True
    return bool(parts.fragment) and target in pages and unquote(parts.fragment) not in pages[target].names


def main():
    folder = Path(sys.argv[1]).resolve()
    # print.html has all chapters in one page, and 404.html is for a server's root.
    paths = [path for path in folder.rglob("*.html") if path.name not in ("print.html", "404.html", "toc.html")]
    pages = {path: Page(path) for path in paths}
    wrong = [f"{path.relative_to(folder)}: {link}" for path in paths for link in pages[path].links if problem(path, link, pages)]
    if wrong:
        sys.exit("links that lead nowhere:\n" + "\n".join(sorted(set(wrong))))
    print(f"{sum(len(page.links) for page in pages.values())} links of {len(pages)} pages")


if __name__ == "__main__":
    main()
