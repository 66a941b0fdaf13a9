"""Man pages and completion name each command and each option that the program has, and complete what they should."""
import pathlib
import re
import subprocess
import sys
import tempfile

PROGRAM = sys.argv[1]
MANUAL = pathlib.Path(__file__).resolve().parents[2] / "tools" / "manual.py"
# What is typed, and what completion must offer, all of it.
TYPED = [("sparsha exp", {"explore", "export"}), ("sparsha build --thr", {"--threads"}), ("sparsha device ch", {"check"}),
         ("sparsha device check --con", {"--conformance"}), ("sparsha --plain new --up -", {"-x", "-y", "-z"}),
         ("sparsha build --only ", {"grid"})]


def help_of(*words):
    return subprocess.run([PROGRAM, *words, "--help"], check=True, capture_output=True, text=True, timeout=60).stdout


def commands_of(text):
    return re.findall(r"^  (\w+)", text.partition("\nSubcommands:\n")[2], re.M)


def main():
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder)
        subprocess.run([sys.executable, MANUAL, PROGRAM, out, "2026-01-01"], check=True, timeout=120)
        bash, zsh = ((out / name).read_text(encoding="utf-8") for name in ("sparsha.bash", "_sparsha"))
        checked = 0
        for command in ["", *commands_of(help_of())]:
            name = f"sparsha-{command}" if command else "sparsha"
            page = (out / "man1" / f"{name}.1").read_text(encoding="utf-8").replace("\\-", "-")
            deeper = commands_of(help_of(command)) if command else []
            for words in [[command], *([command, other] for other in deeper)] if command else [[]]:
                for option in re.findall(r"(?<![\w-])--[a-z][\w-]*(?=[ ,\n])", "\n".join(
                        line[:30] for line in help_of(*words).splitlines() if line.startswith("  -"))):
                    for where, text in (("its page", page), ("bash", bash), ("zsh", zsh)):
                        if option not in text:
                            sys.exit(f"{' '.join(['sparsha', *words])} {option} is missing in {where}")
                    checked += 1
        if checked < 100:
            sys.exit(f"only {checked} options were found")
        for typed, expected in TYPED:
            words = typed.split(" ")
            script = f"""source {out}/sparsha.bash; COMP_WORDS=({' '.join(f"'{word}'" for word in words)})
                COMP_CWORD={len(words) - 1}; cd {out}/man1; _sparsha; printf '%s\\n' "${{COMPREPLY[@]}}" """
            offered = subprocess.run(["bash", "-c", script], check=True, capture_output=True, text=True).stdout.split()
            if set(offered) != expected:
                sys.exit(f"`{typed}` is completed by {offered}; expected {sorted(expected)}")
        print(f"{checked} options")


main()
