#!/usr/bin/env python3
"""Fails on references in pages, comments and scripts to pages, sections, images or files that do not exist."""
import bisect
import fnmatch
import pathlib
import re
import subprocess
import sys
import urllib.parse

SKIPPED = 77  # exit code for CTest where there is no checkout, as in an unpacked archive
SOURCES = (".h", ".cpp", ".txt", ".cmake", ".in", ".py", ".sh", ".yaml")
BROKEN_ON_PURPOSE = ("tests/tools/check_links_test.py", "tests/tools/check_rooms_test.py", "tests/tools/included_lines_test.py")
SCRIPTS = ("Makefile", ".ci/run")
# Names of files that a page or comment gives without a folder must exist somewhere in the tree when they end so.
BARE = (".h", ".cpp", ".py")
BARE_IN_COMMENT = re.compile(r"(?<![\w./*-])[\w-]+\.(?:h|cpp|py|sh)(?![\w/])")
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.S)
STRING = re.compile(r'"(?:\\.|[^"\\\n])*"')
INCLUDED = re.compile(r"^[ \t]*#[ \t]*include[ \t]*<([^>\n]+)>", re.M)
PATH_END = r"\.(?:h|cpp|py|sh|yaml|md|svg|cmake)"

FENCE = re.compile(r"^ {0,3}(`{3,}|~{3,})[^\n]*\n.*?^ {0,3}\1[`~]*[ \t]*$", re.M | re.S)
CODE = re.compile(r"(?<!`)(`+)(?!`)(.+?)(?<!`)\1(?!`)", re.S)
HEADING = re.compile(r"^ {0,3}#{1,6}[ \t]+(.*?)[ \t]*#*[ \t]*$|^ {0,3}([^\s#|>-][^\n]*)\n {0,3}(?:=+|-{2,})[ \t]*$", re.M)
LINK = re.compile(r"\]\(\s*(<[^>]*>|[^()\s]*(?:\([^()\s]*\)[^()\s]*)*)(?:\s+(?:\"[^\"]*\"|'[^']*'))?\s*\)")
DEFINITION = re.compile(r"^ {0,3}\[[^\]^][^\]]*\]:[ \t]*(<[^>]*>|\S+)", re.M)
ATTRIBUTE = re.compile(r"<(?:a|img|source)\b[^>]*?\b(?:href|src|srcset)=[\"']([^\"']+)[\"']", re.I)
ANCHOR = re.compile(r"<\w+\b[^>]*?\b(?:id|name)=[\"']([^\"']+)[\"']", re.I)
# A page, and the sections of it that are named behind it: docs/touch.md, "Proxy" and "Governor". A comment may go on in
# the next line.
GAP = r"(?:[ \t]|\n[ \t]*(?://[/!<]*|#+)?)*"
SECTIONS = rf"`?{GAP}(?:,{GAP}(?:sections?{GAP})?|and{GAP})\"([^\"]+)\""
PAGE = re.compile(r"(?<![\w./-])([\w./-]*[\w-]\.md)\b")
SECTION = re.compile(SECTIONS)
TOKEN = re.compile(r"[\w.*-]+(?:/[\w.*-]+)*/?")


class Tree:
    """The files of a checkout by their names, and the headings and anchors of its pages."""

    def __init__(self, root, files):
        self.root = root
        self.files = set(files)
        self.folders = {str(parent) for name in files for parent in pathlib.PurePosixPath(name).parents}
        self.names = {name.rsplit("/", 1)[-1] for name in files}
        self.top = {name.split("/")[0] for name in files if "/" in name}
        self.pages = {name: Page((root / name).read_text(encoding="utf-8")) for name in files if name.endswith(".md")}

    def has(self, name):
        return name in self.files or name in self.folders

    def find(self, path, beside):
        """The file or folder that `path` means, from the root or from the folder of the file that names it."""
        for start in ("", beside.rpartition("/")[0]):
            name = normal(start, path)
            if name is not None and (self.has(name) or any(fnmatch.fnmatch(f, name) for f in self.files)):
                return name
        return None


class Page:
    """A Markdown page: text without code, code alone, headings and anchors. Offsets are those of the page."""

    def __init__(self, text):
        self.fences = [match.span() for match in FENCE.finditer(text)]
        prose = blank(text, self.fences)
        self.spans = [match.span(2) for match in CODE.finditer(prose)]
        self.prose = blank(prose, self.spans)
        patterns = (LINK, DEFINITION, ATTRIBUTE)
        self.targets = [match.span(1) for pattern in patterns for match in pattern.finditer(self.prose)]
        self.headings, self.anchors = [], set(ANCHOR.findall(self.prose))
        count = {}
        for match in HEADING.finditer(prose):
            heading = plain(match.group(1) or match.group(2) or "")
            self.headings.append(heading)
            base = slug(heading)
            self.anchors.add(f"{base}-{count[base]}" if base in count else base)
            count[base] = count.get(base, 0) + 1


def blank(text, spans):
    for begin, end in spans:
        text = text[:begin] + re.sub(r"[^\n]", " ", text[begin:end]) + text[end:]
    return text


def plain(heading):
    heading = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[`*]", "", heading).strip()


def slug(heading):
    """As GitHub makes it: lower case, letters, digits, hyphens and underscores stay, blanks become hyphens."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def normal(folder, path):
    """The name from the root; None where `path` leaves the tree."""
    parts = folder.split("/") if folder else []
    for part in path.split("/"):
        if part == ".." and not parts:
            return None
        if part == "..":
            parts.pop()
        elif part not in ("", "."):
            parts.append(part)
    return "/".join(parts) or "."


def links(tree, name):
    """Links and images of a page: where each is, and what is wrong with it."""
    page = tree.pages[name]
    for begin, end in page.targets:
        target = urllib.parse.unquote(page.prose[begin:end].strip("<>"))
        if re.match(r"[a-zA-Z][\w+.-]*:|//", target):
            continue
        path, _, anchor = target.partition("#")
        found = normal(name.rpartition("/")[0], path) if path else name
        problem = ""
        if path.startswith("/") or found is None or not tree.has(found):
            problem = f"{target}: no such file"
        elif anchor and found in tree.pages and anchor.lower() not in tree.pages[found].anchors:
            problem = f"{target}: no such heading in {found}"
        yield begin, problem


def pages(tree, name, text):
    """Names of pages in plain text, and the sections that are quoted behind them."""
    if name in tree.pages:
        text = blank(text, [*tree.pages[name].fences, *tree.pages[name].targets])
    text = blank(text, [match.span() for match in re.finditer(r"\bhttps?://\S+", text)])
    for match in PAGE.finditer(text):
        path = match.group(1)
        found = tree.find(path, name)
        if found is None and "/" not in path:  # "see architecture.md"
            found = next((page for page in tree.pages if page.rsplit("/", 1)[-1] == path), None)
        yield match.start(), "" if found in tree.pages else f"{path}: no such page"
        if found not in tree.pages:
            continue
        section = SECTION.match(text, match.end())
        while section:
            heading = re.sub(r"\n[ \t]*(?://[/!<]*|#+)?", " ", section.group(1))
            heading = " ".join(heading.split()).rstrip(".,")
            exists = heading in tree.pages[found].headings
            yield section.start(1), "" if exists else f'{path}, "{heading}": no such section'
            section = SECTION.match(text, section.end())


def looks_tracked(tree, token, in_span):
    first, _, rest = token.partition("/")
    if not rest:
        return in_span and token.endswith(BARE) and not token.startswith((".", "*"))
    if first in tree.top:
        return True
    # Other folders with a file of ours: a room that was renamed. CAPITALS stand for a user's own names.
    return in_span and not first.isupper() and re.search(PATH_END + "$", token) is not None


def paths(tree, name):
    """Paths of files and folders in the code of a page."""
    page, text = tree.pages[name], (tree.root / name).read_text(encoding="utf-8")
    for spans, in_span in ((page.spans, True), (page.fences, False)):
        for begin, end in spans:
            for match in re.finditer(r"[^\s`\"',;:(){}=]+", text[begin:end]):
                token = match.group()
                if not TOKEN.fullmatch(token) or not looks_tracked(tree, token, in_span):
                    continue
                exists = tree.find(token, name) is not None if "/" in token else token in tree.names
                yield begin + match.start(), "" if exists else f"{token}: no such file"


def named_files(tree, name, text):
    """Paths of code from the root in a source file: comments, messages and scripts."""
    others = {path.rsplit("/", 1)[-1] for path in INCLUDED.findall(text)}  # headers of the system and of libraries
    tops = "|".join(sorted(map(re.escape, tree.top)))
    text = re.sub(r"^[ \t]*#[ \t]*include\b.*", lambda line: " " * len(line.group()), text, flags=re.M)
    for match in re.finditer(rf"(?<![\w./-])(?:{tops})/[\w./-]*?[\w-]\.(?:h|cpp|py|sh|svg|cmake(?:\.in)?)\b", text):
        exists = any(tree.find(path, name) is not None for path in (match.group(), f"include/{match.group()}"))
        yield match.start(), "" if exists else f"{match.group()}: no such file"
    if name.endswith((".h", ".cpp")):
        yield from bare_names(tree.names | others, blank(text, [match.span() for match in STRING.finditer(text)]))


def bare_names(known, text):
    """Names of files without a folder in the comments of a C++ file."""
    for comment in COMMENT.finditer(text):
        for match in BARE_IN_COMMENT.finditer(comment.group()):
            exists = match.group() in known
            yield comment.start() + match.start(), "" if exists else f"{match.group()}: no such file"


def references(tree, name):
    """Of each reference in a file the line and what is wrong with it; empty when nothing is."""
    text = (tree.root / name).read_text(encoding="utf-8")
    found = list(pages(tree, name, text))
    found += [*links(tree, name), *paths(tree, name)] if name in tree.pages else named_files(tree, name, text)
    lines = [match.start() for match in re.finditer("\n", text)]
    return sorted({(bisect.bisect_left(lines, offset) + 1, offset, problem) for offset, problem in found})


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)
    try:
        listed = subprocess.run(["git", "-C", str(root), "ls-files", "-z"], capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError) as error:
        print(f"error: git does not list the files of {root} ({error}); expected a checkout of the repository")
        return SKIPPED
    tree = Tree(root, [name for name in listed.split("\0") if name and (root / name).is_file()])
    checked = [name for name in sorted(tree.files) if name in tree.pages or name in SCRIPTS or name.endswith(SOURCES)]
    checked = [name for name in checked if name not in BROKEN_ON_PURPOSE]
    found = [(name, *reference) for name in checked for reference in references(tree, name)]
    broken = list(dict.fromkeys(f"{name}:{line}: {problem}" for name, line, _, problem in found if problem))
    print("\n".join(broken) if broken else f"{len(found)} references in {len(checked)} files name something that exists")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
