#!/usr/bin/env python3
"""Static HTML: every link and image leads to a file, and to a place in it where it names one; each page has a title, a
language, one first heading and no heading that skips a level; images and heads of table columns have a text. check-site.py FOLDER"""
import html.parser
import pathlib
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.links, self.places, self.levels, self.faults = [], {""}, [], []
        self.title = False
        self.main = 0  # depth of tags within the page's own text
        self.head = None  # text of the table head that is being read
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.places.update(found[key] for key in ("id", "name") if found.get(key))
        self.title = self.title or tag == "title"
        for key in ("href", "src"):
            if key in found:
                self.links.append(found[key] or "")
        if found.get("role") == "main":
            self.main = 1
        if len(tag) == 2 and tag[0] == "h" and tag[1].isdigit() and self.main:
            self.levels.append(int(tag[1]))
        if tag == "img" and not found.get("alt"):
            self.faults.append(f"image {found.get('src')} has no text")
        if tag == "th":
            self.head = ""
        if tag == "html" and not found.get("lang"):
            self.faults.append("no language")

    def handle_data(self, data):
        if self.head is not None:
            self.head += data

    def handle_endtag(self, tag):
        if tag == "th":
            if not (self.head or "").strip():
                self.faults.append("the head of a table's column has no text")
            self.head = None

    def headings(self):
        if self.levels.count(1) != 1:
            yield f"{self.levels.count(1)} first headings; expected one"
        for before, after in zip(self.levels, self.levels[1:]):
            if after > before + 1:
                yield f"a heading of level {after} follows one of level {before}"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(root.rglob("*.html"))}
    faults, links = [], 0
    for path, page in pages.items():
        own = path.name not in ("404.html", "search.html")
        found = page.faults + (list(page.headings()) if own else []) + ([] if page.title else ["no title"])
        for link in page.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc or path.name == "404.html":
                continue
            links += 1
            target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
            if not target.is_file():
                found.append(f"{link} leads nowhere")
            elif target in pages and urllib.parse.unquote(parts.fragment) not in pages[target].places:
                found.append(f"{link}: there is no such place")
        faults += [f"{path.relative_to(root)}: {fault}" for fault in found]
    print("\n".join(faults) if faults else f"{len(pages)} pages and {links} links are in order")
    return 1 if faults or not pages else 0


sys.exit(main())
