"""Every option of every command's --help stands in the README or in a page of docs, as code.

  documented_options_test.py SPARSHA"""
import importlib.util
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def manual():
    spec = importlib.util.spec_from_file_location("manual", ROOT / "tools" / "manual.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def main():
    text = "\n".join(page.read_text(encoding="utf-8") for page in [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
    # "`--only` grid", "--only grid" in a block of code; not a part of a longer name.
    named = set(re.findall(r"(?<![\w-])--[a-z][a-z-]*[a-z]", text))
    options, missing = 0, set()
    for command in manual().Help(pathlib.Path(sys.argv[1]).resolve(), []).everything():
        for flags, _, _ in command.options():
            for flag in flags:
                if not flag.startswith("--"):
                    continue
                options += 1
                if flag not in named:
                    missing.add(f"sparsha {' '.join(command.words)} {flag}")
    if options < 100:
        sys.exit(f"only {options} options were found")
    if missing:
        sys.exit("no page tells of\n" + "\n".join(sorted(missing)))
    print(f"{options} options of the commands are in the pages")


sys.exit(main())
