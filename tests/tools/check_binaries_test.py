"""Programs with one fault each: tools/check-binaries.py names it, and passes the one without."""
import pathlib
import subprocess
import sys
import tempfile

CHECK = pathlib.Path(__file__).resolve().parents[2] / "tools" / "check-binaries.py"
COMPILER = sys.argv[1]
GUARDS = ["-pie", "-fPIE", "-fcf-protection=full", "-Wl,-z,relro,-z,now"]
ORIGIN = "-Wl,--enable-new-dtags,-rpath,$ORIGIN/../lib/sparsha"
# Flags, and what is said of the program.
CASES = [
    (["-Wl,-rpath,$ORIGIN:"], "empty element"),
    (["-Wl,-rpath,:$ORIGIN"], "empty element"),
    (["-Wl,-rpath,$ORIGIN::$ORIGIN/lib"], "empty element"),
    (["-Wl,-rpath,lib"], "names 'lib'"),
    (["-Wl,-rpath,."], "names '.'"),
    (["-Wl,-rpath,$ORIGINS/lib"], "names '$ORIGINS/lib'"),
    (["-Wl,-rpath,/usr/local/lib"], "names '/usr/local/lib'"),
    (["-Wl,--disable-new-dtags,-rpath,/build/lib"], "its RPATH names '/build/lib'"),
    (["-Wl,-z,lazy"], "without full RELRO"),
    (["-Wl,-z,norelro"], "without full RELRO"),
    (["-no-pie"], "not position-independent"),
]


def run(*arguments):
    done = subprocess.run([sys.executable, str(CHECK), *arguments], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def main():
    failures = 0

    def expect(holds, what, said):
        nonlocal failures
        if not holds:
            failures += 1
            print(f"{what}:\n{said}")

    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        source = folder / "main.cpp"
        source.write_text("int main() { return 0; }\n", encoding="utf-8")

        def build(flags, file="program"):
            subprocess.run([COMPILER, *GUARDS, *flags, str(source), "-o", str(folder / file)], check=True)

        code, said = run(name)
        expect(code != 0 and "no program" in said, "a folder without programs", said)
        for flags in ([], [ORIGIN], [ORIGIN, "-Wl,-rpath,$ORIGIN"]):
            build(flags)
            code, said = run("--hardened", name)
            expect(code == 0 and "1 programs" in said, f"a program without fault ({flags})", said)
        for flags, expected in CASES:
            build(flags)
            code, said = run("--hardened", name)
            expect(code == 1 and said.count("error: ") == 1 and expected in said, f"{flags}: not '{expected}'", said)
        build([])
        build(["-c"], "part.o")
        code, said = run("--hardened", name)
        expect(code == 0 and "1 objects" in said, "a marked object", said)
        build(["-c", "-fcf-protection=none"], "part.o")
        code, said = run("--hardened", name)
        expect(code == 1 and "control-flow" in said, "an object without marks", said)
        code, said = run(name)
        expect(code == 0, "guards that nobody asked for", said)
    return 1 if failures else 0


sys.exit(main())
