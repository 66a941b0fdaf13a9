"""Every line of the checklist in docs/use/accessibility.md names a test that exists, or says that it is not met."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
DEFINED = re.compile(r"^\s*(?:TEST|TEST_F|TEST_P)\(\s*(\w+)\s*,\s*(\w+)\s*\)", re.M)
ADDED = re.compile(r"add_test\(NAME\s+([\w.]+)")
NAMED = re.compile(r"`(\w+\.\w+)`")


def tests():
    names = set()
    for file in (ROOT / "tests").rglob("*.cpp"):
        names |= {f"{suite}.{name}" for suite, name in DEFINED.findall(file.read_text(encoding="utf-8"))}
    names |= set(ADDED.findall((ROOT / "tests" / "CMakeLists.txt").read_text(encoding="utf-8")))
    return names


def problems(text, known):
    section = text.split("## Checklist", 1)[1].split("\n## ", 1)[0] if "## Checklist" in text else ""
    rows = [line for line in section.splitlines() if line.startswith("|")]
    rows = [row for row in rows if not re.match(r"^\|[\s:|-]+\|$", row)][1:]
    if len(rows) < 15:
        yield "the checklist has hardly any lines"
    for row in rows:
        cells = [cell.strip() for cell in row.strip("|").split("|")]
        if len(cells) != 3:
            yield f"not three columns: {row}"
            continue
        named = NAMED.findall(cells[2])
        if not named and not cells[2].startswith("not met"):
            yield f"no test is named: {cells[0]}"
        for name in named:
            if name not in known:
                yield f"{cells[0]}: there is no test {name}"


def main():
    known = tests()
    text = (ROOT / "docs" / "use" / "accessibility.md").read_text(encoding="utf-8")
    found = list(problems(text, known))
    for problem in found:
        print(problem)
    # That it can fail.
    broken = text.replace("Phrases.", "Phrasez.", 1)
    if broken == text or not list(problems(broken, known)):
        print("a test that does not exist was not noticed")
        return 1
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
