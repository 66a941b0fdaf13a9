#!/usr/bin/env python3
"""Which sources of a target may be compiled as one (cmake/unity.cmake), as a list for CMake.

  tools/unity-groups.py LINES FILE...     prints `FILE|NUMBER;FILE|NUMBER...`, files of one number are one group

Sources share a group when none of them uses a name that another one keeps for itself (in an unnamed namespace, or static):
such a name would be defined twice, or found where another was meant. For the same reason two sources stay apart when only
one of them knows of a namespace within theirs (`testing::` may be GoogleTest's or one of ours), takes all names of another
one (`using namespace`) or includes headers with macros of plain words. A name that is taken from elsewhere (`using testing::Each;`, `namespace p =
pipeline;`, `using Clock = std::chrono::steady_clock;`) is no obstacle to a source that takes the same one. What defines
macros stays alone. A group has at most LINES lines, so that the cores share them evenly. The same files in whatever order
get the same groups."""
import functools
import os
import re
import sys

TEXT = re.compile(r'//[^\n]*|/\*.*?\*/|R"([^(\s]*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\'', re.S)
WORD = re.compile(r"[A-Za-z_]\w*")
# Of a whole file: macros and names that are meant for it alone.
ALONE = re.compile(r"^\s*#\s*(?:define|undef|pragma)\b", re.M)
MACROS = re.compile(r"^#include\s*<((?:X11|epoxy|GL)/[^>]+)>", re.M)  # headers whose macros are words of others' texts
NAMESPACE = re.compile(r"\bnamespace\s+([\w:]+)\s*\{")
ALL_OF = re.compile(r"^using namespace\s+([\w:]+)\s*;", re.M)
TAKEN = re.compile(r"\s*using\s+(?:typename\s+)?((?:\w*::)*(\w+))\s*$|\s*(?:using|namespace)\s+(\w+)\s*=(.*)$", re.S)
NAMED = re.compile(r"\b(?:class|struct|union|enum(?:\s+class|\s+struct)?|concept|using|namespace)\s+(?:\[\[[^\]]*\]\]\s*)?([A-Za-z_]\w*)")
BASES = re.compile(r"^(\s*(?:class|struct)\s+\w+(?:\s+final)?\s*):.*$", re.S)  # of a class, which are declared elsewhere
DECLARED = re.compile(r"([A-Za-z_]\w*)\s*(?=[({=;\[,])")
KEYWORDS = frozenset("""alignas alignof and auto bool break case catch char class concept const consteval constexpr constinit
  const_cast continue decltype default delete do double dynamic_cast else enum explicit export extern false final float for
  friend goto if inline int long mutable namespace new noexcept not nullptr operator or override private protected public
  register reinterpret_cast requires return short signed sizeof static static_assert static_cast struct switch template this
  throw true try typedef typeid typename union unsigned using virtual void volatile while std size_t""".split())
TESTS = re.compile(r"\s*(?:TEST|TEST_F|TEST_P|TYPED_TEST|INSTANTIATE_TEST_SUITE_P)\s*\(")  # names that GoogleTest makes its own


def plain(text):
    """The text without comments and literals."""
    return TEXT.sub(lambda match: " " if match.group(0).startswith("/") else '""', text)


def declared(statement):
    """Names that a statement of namespace scope declares."""
    names = set(NAMED.findall(statement))
    statement = BASES.sub(r"\1", statement)
    flat, level, at = [], 0, 0
    for match in re.finditer(r"[()<>]", statement):  # what stands in angle brackets or parentheses is a type or an argument
        if level == 0:
            flat.append(statement[at:match.start()])
        at = match.end()
        if match.group(0) in ")>":
            level = max(level - 1, 0)
        else:
            if level == 0:
                flat.append(match.group(0))
            level += 1
    if level == 0:
        flat.append(statement[at:])
    return names | {name for name in DECLARED.findall("".join(flat) + ";") if name not in KEYWORDS}


def own_names(text):
    """Names that are declared in unnamed namespaces or static; and what each name means that is taken from elsewhere."""
    text = re.sub(r"^[ \t]*#(?:\\\n|[^\n])*", "", text, flags=re.M)
    names, taken, unnamed = set(), {}, []
    depth = parens = begin = 0
    for match in re.finditer(r"[{};()]", text):
        c = match.group(0)
        if c in "()":
            parens += 1 if c == "(" else -1
            continue
        if c == ";" and parens:
            continue
        statement = text[begin:match.start()]
        begin = match.end()
        if c == ";" and (take := TAKEN.match(statement)):
            whole, last, alias, meaning = take.groups()
            name, meaning = (alias, "".join(meaning.split())) if alias else (last, whole)
            if taken.setdefault(name, meaning) != meaning:
                names.add(name)  # not the same everywhere in this file
            continue
        if ALL_OF.match(statement.strip() + c):
            continue
        opens_unnamed = c == "{" and re.search(r"\bnamespace\s*$", statement)
        local = unnamed and depth == unnamed[-1] or re.match(r"\s*static\b", statement)
        if c != "}" and local and parens == 0 and not opens_unnamed and not TESTS.match(statement):
            names |= declared(statement)
        if c == "{":
            depth += 1
            if opens_unnamed:
                unnamed.append(depth)
        elif c == "}":
            if unnamed and depth == unnamed[-1]:
                unnamed.pop()
            depth -= 1
    return names, taken


def used_names(text):
    """Names that are looked up from where they stand, or declared there."""
    return {match.group(0) for match in WORD.finditer(text) if not re.search(r"(?:\.|->|::)\s*$", text[max(match.start() - 3, 0):match.start()])}


LEADS = re.compile(r"(?<![\w:])([A-Za-z_]\w*)\s*::")
INCLUDED = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.M)
ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


@functools.lru_cache(maxsize=None)
def opened(path):
    """Full names of the namespaces that a file of ours opens, itself or by what it includes."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    names = set(NAMESPACE.findall(text))
    for name in INCLUDED.findall(text):
        places = (os.path.join(os.path.dirname(path), name), os.path.join(ROOT, name))
        found = next((place for place in places if os.path.isfile(place)), None)
        if found and os.path.normpath(found) != os.path.normpath(path):
            names |= opened(os.path.normpath(found))
    return frozenset(names)


class Source:
    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            whole = file.read()
        text = plain(whole)
        self.path = path
        self.lines = whole.count("\n")
        self.alone = bool(ALONE.search(whole))
        self.own, self.taken = own_names(text)
        self.used = used_names(text)
        self.leads = frozenset(LEADS.findall(text))
        self.opened = opened(os.path.normpath(os.path.abspath(path)))
        self.whole_text = (frozenset(ALL_OF.findall(text)), frozenset(MACROS.findall(whole)))

    def clashes(self, other):
        return self.whole_text != other.whole_text or self.hides_of(other) or other.hides_of(self)

    def hides_of(self, other):
        """Whether a name of this source would mean something else than it does in the other one."""
        if any(name.rsplit("::", 1)[-1] in other.leads for name in self.opened - other.opened if "::" in name):
            return True
        return bool(self.own & other.used) or any(
            name in other.used | other.taken.keys() and other.taken.get(name) != meaning for name, meaning in self.taken.items())


def groups(paths, most_lines):
    found = []
    for source in (Source(path) for path in sorted(paths)):
        for group in found:
            fits = sum(member.lines for member in group) + source.lines <= most_lines
            if fits and not source.alone and not group[0].alone and not any(source.clashes(member) for member in group):
                group.append(source)
                break
        else:
            found.append([source])
    return [[member.path for member in group] for group in found]


def main():
    most_lines, paths = int(sys.argv[1]), sys.argv[2:]
    named = [f"{path}|{number}" for number, group in enumerate(groups(paths, most_lines)) for path in group if len(group) > 1]
    print(";".join(named), end="")


if __name__ == "__main__":
    main()
