#!/usr/bin/env python3
"""Which sources of a target may be compiled as one (cmake/unity.cmake), as a list for CMake.

  tools/unity-groups.py LINES FILE...     prints `FILE|NUMBER;FILE|NUMBER...`, files of one number are one group

Sources share a group when none of them uses a name that another one keeps for itself (in an unnamed namespace, or static):
such a name would be defined twice, or found where another was meant; and when they open the same namespaces, since a
namespace within one of them hides another of its name. What defines macros or opens other namespaces for its
whole text stays alone. A group has at most LINES lines, so that the cores share them evenly. The same files in whatever
order get the same groups."""
import re
import sys

TEXT = re.compile(r'//[^\n]*|/\*.*?\*/|R"([^(\s]*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\'', re.S)
WORD = re.compile(r"[A-Za-z_]\w*")
# Of a whole file: macros and names that are meant for it alone.
ALONE = re.compile(r"^\s*#\s*(?:define|undef|pragma)\b|^using namespace\b|^#include\s*<(?:X11|epoxy|GL)/", re.M)
NAMESPACE = re.compile(r"\bnamespace\s+([\w:]+)\s*\{")
NAMED = re.compile(r"\b(?:class|struct|union|enum(?:\s+class|\s+struct)?|concept|using|namespace)\s+(?:\[\[[^\]]*\]\]\s*)?([A-Za-z_]\w*)")
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
    """Names that are declared in unnamed namespaces, or static or aliases of the whole file."""
    text = re.sub(r"^[ \t]*#(?:\\\n|[^\n])*", "", text, flags=re.M)
    names, unnamed = set(), []
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
        opens_unnamed = c == "{" and re.search(r"\bnamespace\s*$", statement)
        local = unnamed and depth == unnamed[-1] or re.match(r"\s*(?:static|using\s+\w+\s*=|namespace\s+\w+\s*=)", statement)
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
    return names


def used_names(text):
    """Names that are looked up from where they stand, or declared there."""
    return {match.group(0) for match in WORD.finditer(text) if not re.search(r"(?:\.|->|::)\s*$", text[max(match.start() - 3, 0):match.start()])}


class Source:
    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            whole = file.read()
        text = plain(whole)
        self.path = path
        self.lines = whole.count("\n")
        self.alone = bool(ALONE.search(whole))
        self.own = own_names(text)
        self.used = used_names(text)
        self.namespaces = frozenset(NAMESPACE.findall(text))

    def clashes(self, other):
        return self.namespaces != other.namespaces or bool(self.own & other.used or other.own & self.used)


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
