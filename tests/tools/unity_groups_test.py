"""Sources share a group in tools/unity-groups.py only where no name of one can be taken for that of another."""
import pathlib
import subprocess
import sys
import tempfile

GROUPS = pathlib.Path(__file__).resolve().parents[2] / "tools" / "unity-groups.py"
HOLDS = """#include <vector>
namespace sparsha {
namespace {
%s
}  // namespace
%s
}  // namespace sparsha
"""


def source(own="", text=""):
    return HOLDS % (own, text)


# What two sources hold, and whether they may share a group.
PAIRS = [
    ("nothing in common", source("int one() { return 1; }"), source("int two() { return 2; }"), True),
    ("the same function", source("int one() { return 1; }"), source("int one() { return 2; }"), False),
    ("the same constant", source("constexpr double kMost = 1.0;"), source("constexpr double kMost{2.0};"), False),
    ("the same class", source("class Reader final : public Base<int> { int n; };"), source("struct Reader;"), False),
    ("the same alias", source("using Row = std::vector<int>;"), source("using Row = int;"), False),
    ("the same template", source("template <typename T> T least(T a) { return a; }"), source("int least(int a) { return a; }"), False),
    ("a static function", "static int one() { return 1; }\n", source("int one() { return 2; }"), False),
    ("a name of one that the other calls", source("int size(int n) { return n; }"), source("", "int f(int n) { return size(n); }"), False),
    ("a name of one that is a member elsewhere", source("int size(int n) { return n; }"), source("", "int f(V v) { return v.size(); }"), True),
    ("a name of one that the other qualifies", source("int size(int n) { return n; }"), source("", "int f(V v) { return std::size(v); }"), True),
    ("a name within a function", source("int f() { const int inner = 1; return inner; }"), source("", "int g() { int inner = 2; return inner; }"), True),
    ("a name in a comment and a literal", source("int one() { return 1; }"), source("", '// one\nconst char* g() { return "one{"; }'), True),
    ("a macro", source("int one() { return 1; }"), "#define TWO 2\n" + source(), False),
    ("names of a namespace for the whole file", source("int one() { return 1; }"), "using namespace std;\n" + source(), False),
    ("another namespace", source("int one() { return 1; }"), source("int two() { return 2; }").replace("sparsha {", "sparsha::test {"), True),
    ("a namespace that hides another of its name", source("", "int f() { return test::one(); }"), source().replace("sparsha {", "sparsha::test {"), False),
    ("a namespace that both know", source("", "int f() { return test::one(); }\nnamespace sparsha::test {}"),
     source().replace("sparsha {", "sparsha::test {"), True),
    ("the same meaning of an alias", source("using Row = std::vector<int>;"), source("using Row = std::vector<int>;"), True),
    ("the same name from elsewhere", source("using testing::Each;"), source("using testing::Each;"), True),
    ("a name from elsewhere that is another's own", source("using testing::Each;"), source("struct Each {};"), False),
    ("a name from elsewhere and one from somewhere else", source("using testing::Each;"), source("using other::Each;"), False),
    ("classes of one base", source("class One : public Base {};"), source("class Two : public Base {};"), True),
    ("the same names of a namespace for the whole file", "using namespace std;\n" + source(), "using namespace std;\n" + source(), True),
    ("a header of macros", source(), "#include <epoxy/gl.h>\n" + source(), False),
    ("the same header of macros", "#include <epoxy/gl.h>\n" + source(), "#include <epoxy/gl.h>\n" + source(), True),
    ("two tests of a suite", source("TEST(Suite, One) { int a; }"), source("TEST(Suite, Two) { int a; }"), True),
    ("a helper of a test", source("TEST(Suite, One) { f(); }\nint f() { return 1; }"), source("int f() { return 2; }"), False),
]


def groups(root, lines, names):
    done = subprocess.run([sys.executable, str(GROUPS), str(lines), *names], cwd=root, capture_output=True, text=True, check=True)
    return dict(pair.split("|") for pair in done.stdout.split(";") if pair)


def main():
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for what, one, other, expected in PAIRS:
            (root / "a.cpp").write_text(one, encoding="utf-8")
            (root / "b.cpp").write_text(other, encoding="utf-8")
            found = groups(root, 1000, ["b.cpp", "a.cpp"])
            if found != groups(root, 1000, ["a.cpp", "b.cpp"]) or (len(found) == 2 and found["a.cpp"] == found["b.cpp"]) != expected:
                failures += 1
                print(f"{what}: {found}, expected {'one group' if expected else 'no group'}")
        for n in range(4):
            (root / f"{n}.cpp").write_text("\n" * 10, encoding="utf-8")
        found = groups(root, 20, [f"{n}.cpp" for n in range(4)])
        if sorted(found.values()) != ["0", "0", "1", "1"]:
            failures += 1
            print(f"four sources of 10 lines in groups of 20: {found}")
    print(f"{len(PAIRS) + 1} cases, {failures} wrong")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
