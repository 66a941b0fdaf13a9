"""report.html of a built scene as a screen reader meets it: landmarks, headings, names of pictures, tables, links.

    report_reading_test.py PROGRAM CONFIG
"""
import html.parser
import pathlib
import subprocess
import sys
import tempfile

VOID = {"meta", "img", "br", "link", "hr", "input"}


class Page(html.parser.HTMLParser):
    """A tree of elements: tag, attributes, children, and its text."""

    def __init__(self, text):
        super().__init__()
        self.root = {"tag": "", "attrs": {}, "children": [], "text": "", "parent": None}
        self.at = self.root
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        node = {"tag": tag, "attrs": dict(attrs), "children": [], "text": "", "parent": self.at}
        self.at["children"].append(node)
        if tag not in VOID:
            self.at = node

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.at = self.at["parent"]

    def handle_endtag(self, tag):
        if tag in VOID:
            return
        if self.at["tag"] != tag:
            raise ValueError(f"</{tag}> closes <{self.at['tag']}>")
        self.at = self.at["parent"]

    def handle_data(self, data):
        self.at["text"] += data


def all_of(node, *tags):
    for child in node["children"]:
        if child["tag"] in tags:
            yield child
        yield from all_of(child, *tags)


def text_of(node):
    return (node["text"] + " ".join(text_of(child) for child in node["children"])).strip()


def name_of(node, ids):
    """What a screen reader calls it."""
    attrs = node["attrs"]
    labelled = " ".join(text_of(ids[i]) for i in attrs.get("aria-labelledby", "").split() if i in ids)
    return labelled or attrs.get("aria-label") or attrs.get("alt") or text_of(node)


def problems(text):
    page = Page(text).root
    everything = list(all_of(page, *{n["tag"] for n in walk(page)}))
    ids = {}
    for node in everything:
        if "id" in node["attrs"]:
            if node["attrs"]["id"] in ids:
                yield f"two elements with the id {node['attrs']['id']}"
            ids[node["attrs"]["id"]] = node
    document = next(all_of(page, "html"), None)
    if document is None or not document["attrs"].get("lang"):
        yield "the page's language is not named"
    if not any(text_of(t) for t in all_of(page, "title")):
        yield "no title"
    for landmark in ("header", "nav", "main"):
        if sum(1 for n in everything if n["tag"] == landmark) != 1:
            yield f"not one {landmark}"
    links = list(all_of(page, "a"))
    if not links or links[0]["attrs"].get("href") != "#main":
        yield "the first link does not skip to the content"
    for link in links:
        target = link["attrs"].get("href", "")
        if not text_of(link):
            yield f"a link without words: {target}"
        if target.startswith("#") and target[1:] not in ids:
            yield f"a link to nowhere: {target}"
    level = 0
    for heading in all_of(page, "h1", "h2", "h3", "h4", "h5", "h6"):
        here = int(heading["tag"][1])
        if here > level + 1:
            yield f"a heading of level {here} below one of level {level}: {text_of(heading)}"
        if not text_of(heading):
            yield "an empty heading"
        level = here
    if sum(1 for _ in all_of(page, "h1")) != 1:
        yield "not one h1"
    for node in all_of(page, "img"):
        if len(node["attrs"].get("alt", "")) < 10:
            yield f"a picture without a description: {node['attrs'].get('alt')}"
    for node in all_of(page, "svg"):
        if node["attrs"].get("role") != "img" or not name_of(node, ids):
            if node["attrs"].get("aria-hidden") != "true":
                yield "a drawing without a description"
    for node in everything:
        if node["attrs"].get("role") == "region" or node["tag"] in ("section", "nav"):
            if not node["attrs"].get("aria-label") and not node["attrs"].get("aria-labelledby"):
                yield f"a {node['tag']} without a name"
        for i in node["attrs"].get("aria-labelledby", "").split():
            if i not in ids:
                yield f"named by {i}, which is not there"
    tables = list(all_of(page, "table"))
    for table in tables:
        caption = next(all_of(table, "caption"), None)
        where = text_of(caption) if caption else "a table"
        if not where or caption is None:
            yield "a table without a caption"
        for cell in all_of(table, "th"):
            if cell["attrs"].get("scope") not in ("col", "row"):
                yield f"{where}: a header of neither column nor row: {text_of(cell)}"
        for head in all_of(table, "thead"):
            if any(True for _ in all_of(head, "td")):
                yield f"{where}: a column without a header"
    if len(tables) < 3 or not any(True for _ in all_of(page, "img")):
        yield "hardly anything to read"


def walk(node):
    yield node
    for child in node["children"]:
        yield from walk(child)


# One fault each; what is found then.
FAULTS = [
    (" lang='en'", "", "language"),
    (" scope='col'", "", "neither column nor row"),
    ("<caption>", "<p>", "caption"),
    ("id='main'", "id='mine'", "nowhere"),
    ("<h1>", "<h4>", "h1"),
    (" alt='", " alt='' title='", "picture without"),
    (" role='img'", "", "drawing without"),
]


def main():
    program, config = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder) / "scene"
        subprocess.run([program, "build", config, "--set", "grid={spacing_mm: 3}", "--out", str(scene), "--quiet"],
                       check=True, stdout=subprocess.DEVNULL)
        text = (scene / "report.html").read_text(encoding="utf-8")
    found = list(problems(text))
    for problem in found:
        print(problem)
    for old, new, expected in FAULTS:
        broken = text.replace(old, new)
        if old == "<caption>":
            broken = broken.replace("</caption>", "</p>")
        if old == "<h1>":
            broken = broken.replace("</h1>", "</h4>")
        if broken == text or not any(expected in problem for problem in problems(broken)):
            found.append(expected)
            print(f"not noticed: {old} -> {new}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
