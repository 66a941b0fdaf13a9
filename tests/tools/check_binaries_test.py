"""Programs with one fault each: tools/check-binaries.py names it, and passes the one without."""
import json
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
# How a source is compiled, and what is said of that.
STRONG = "-fstack-protector-strong "
COMMANDS = [
    (STRONG + "-O3 -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2", ""),
    (STRONG + "-O3 -D_FORTIFY_SOURCE=2 -O1", ""),
    (STRONG + "-O3", "not compiled with _FORTIFY_SOURCE=2"),
    (STRONG + "-O3 -D_FORTIFY_SOURCE=2 -U_FORTIFY_SOURCE", "not compiled with _FORTIFY_SOURCE=2"),
    (STRONG + "-O3 -D_FORTIFY_SOURCE=1", "not compiled with _FORTIFY_SOURCE=2"),
    (STRONG + "-D_FORTIFY_SOURCE=2", "does nothing"),
    (STRONG + "-O3 -D_FORTIFY_SOURCE=2 -O0", "does nothing"),
    ("-fno-stack-protector -fstack-protector-all -O3 -D_FORTIFY_SOURCE=2", ""),
    ("-O3 -D_FORTIFY_SOURCE=2", "its stack is not guarded"),
    ("-fstack-protector -O3 -D_FORTIFY_SOURCE=2", "its stack is not guarded"),
    (STRONG + "-fno-stack-protector -O3 -D_FORTIFY_SOURCE=2", "its stack is not guarded"),
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

        code, said = run("--with", "program", name)
        expect(code == 0, "a program that is there", said)
        code, said = run("--with", "libmissing.so", name)
        expect(code == 1 and "libmissing.so: it is not among" in said, "a library that is not read", said)

        commands = folder / "commands.json"
        for flags, expected in COMMANDS:
            entry = {"directory": name, "file": "main.cpp", "command": f"c++ {flags} -c main.cpp"}
            commands.write_text(json.dumps([entry]), encoding="utf-8")
            code, said = run("--commands", str(commands), name)
            right = code == 1 and said.count("error: ") == 1 and expected in said if expected else code == 0
            expect(right, f"compiled with '{flags}', not '{expected}'", said)
        commands.write_text("[]", encoding="utf-8")
        for call, holds in (("0", False), ("memcpy(to, from, size)", True)):
            source.write_text("#include <cstring>\nchar to[8];\nint main(int size, char** v) { const char* from = v[0]; "
                              f"(void)from; (void)size; return ({call}) != 0; }}\n", encoding="utf-8")
            build(["-O2", "-U_FORTIFY_SOURCE", "-D_FORTIFY_SOURCE=2"], "sparsha")
            code, said = run("--commands", str(commands), name)
            expect((code == 0) == holds and ("checked functions" in said) != holds, f"a program of {call}", said)
    return 1 if failures else 0


sys.exit(main())
