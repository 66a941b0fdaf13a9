#!/usr/bin/env python3
"""Man pages, completion for bash and zsh and the schema of configurations, made from what the program says of itself, so that they
cannot disagree with it: each command's --help is read, and those of its own commands, and the keys of `sparsha config keys`.

  tools/manual.py SPARSHA OUT [DATE]   writes OUT/man1/sparsha.1, OUT/man1/sparsha-COMMAND.1, OUT/man5/sparsha-config.5,
                                       OUT/sparsha.bash, OUT/_sparsha, OUT/sparsha.schema.json
"""
import datetime
import json
import pathlib
import re
import subprocess
import sys

COLUMN = 30  # where descriptions begin
EXIT = [("0", "Done."), ("1", "Anything that is none of the following."), ("2", "The command line or the configuration is wrong."),
        ("3", "Input data are wrong."), ("4", "The device is missing or does not answer.")]


class Help:
    """One command's --help: what it does, how it is called, and its rows of each heading."""

    def __init__(self, program, words):
        text = subprocess.run([program, *words, "--help"], check=True, capture_output=True, text=True, timeout=60).stdout
        lines = text.splitlines()
        usage = next(i for i, line in enumerate(lines) if line.startswith("Usage: "))
        self.words = words
        self.purpose = " ".join(lines[:usage]).strip()
        self.usage = lines[usage].removeprefix("Usage: ")
        self.sections = {}
        self.after = []
        heading = None
        for line in lines[usage + 1:]:
            if re.match(r"^\S.*:$", line):
                heading = line[:-1]
                self.sections[heading] = []
            elif heading and re.match(r"^  \S", line):
                name, _, words_after = line.strip().partition("  ") if len(line) > COLUMN and line[COLUMN - 1] == " " \
                    else (line.strip(), "", "")
                self.sections[heading].append([name.strip(), words_after.strip()])
            elif heading and line.startswith(" " * COLUMN):
                self.sections[heading][-1][1] = (self.sections[heading][-1][1] + " " + line.strip()).strip()
            elif line.strip():
                self.after.append(line.strip())
        commands = [row[0] for row in self.sections.get("Subcommands", [])]
        self.commands = [Help(program, [*words, name]) for name in commands]

    def options(self):
        """(["-o", "--out"], "TEXT", description) of every heading but those of commands and arguments."""
        for heading, rows in self.sections.items():
            if heading in ("Subcommands", "Positionals"):
                continue
            for name, description in rows:
                flags, _, value = name.partition(" ")
                yield flags.split(","), value, description

    def everything(self):
        yield self
        for command in self.commands:
            yield from command.everything()


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return "\\&" + text if text.startswith(".") else text


def rows_of(page):
    for heading, rows in page.sections.items():
        if heading == "Subcommands":
            continue
        yield f".SH {'ARGUMENTS' if heading == 'Positionals' else heading.upper()}"
        for name, description in rows:
            bold, _, value = name.partition(" ")
            yield f".TP\n.B {roff(bold)}" + (f" \\fI{roff(value)}\\fR" if value else "")
            yield roff(description) or "\\&"


def man_page(page, date, version):
    name = "-".join(["sparsha", *page.words])
    yield f'.TH "{roff(name).upper()}" 1 "{date}" "{roff(version)}" "User commands"'
    yield f".SH NAME\n{roff(name)} \\- {roff(page.purpose.removeprefix('Sparsha: '))}"
    yield f".SH SYNOPSIS\n.B {roff(page.usage)}"
    yield from rows_of(page)
    if page.commands:
        yield ".SH COMMANDS"
        for command in page.commands:
            yield f".TP\n.B {roff(command.words[-1])}\n{roff(command.purpose)}"
            for flags, value, description in () if len(page.words) == 0 else command.options():
                if "--help" not in flags:
                    yield f".RS\n.TP\n.B {roff(', '.join(flags))} \\fI{roff(value)}\\fR\n{roff(description)}\n.RE"
    if page.after:
        yield ".SH NOTES\n" + "\n".join(roff(line) for line in page.after)
    yield ".SH EXIT STATUS"
    for code, meaning in EXIT:
        yield f".TP\n.B {code}\n{meaning}"
    others = [f".BR sparsha\\-{command.words[0]} (1)" for command in page.commands] if not page.words else [".BR sparsha (1)"]
    yield ".SH SEE ALSO\n" + ",\n".join(others)


def config_page(program, date, version):
    rows = json.loads(subprocess.run([program, "config", "keys", "--json"], check=True, capture_output=True, text=True).stdout)
    yield f'.TH "SPARSHA\\-CONFIG" 5 "{date}" "{roff(version)}" "File formats"'
    yield ".SH NAME\nsparsha\\-config \\- keys of the configuration of a scene"
    yield ".SH DESCRIPTION\nA YAML file. Paths are relative to it; only scans is required. Limits of numbers are inclusive."
    for row in rows:
        path = row["key"]
        if "." not in path:
            yield f".SH {roff(path).upper()}\n{roff(row['text'])}."
            continue
        yield f".TP\n.B {roff(path)}"
        default = " Required." if row["required"] else f" Default {row['default']}." if row["default"] else ""
        yield roff(f"{row['text']}. Value: {row['value']}.{default}")
    yield ".SH SEE ALSO\n.BR sparsha\\-config (1)"


def choices(value):
    """The words that an option may take, where --help lists them."""
    found = re.search(r"\{([^}]*)\}", value)
    return found.group(1).split(",") if found else []


def takes_folder_or_file(value):
    return value.startswith("TEXT") and not choices(value)


def bash(root):
    yield "# Completion of sparsha for bash; made by tools/manual.py from the program's --help."
    yield "_sparsha() {"
    yield '  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} path= i'
    yield "  for ((i = 1; i < COMP_CWORD; ++i)); do"
    yield '    case "$path ${COMP_WORDS[i]}" in'
    nested = [" " + " ".join(page.words) for page in root.everything() if page.words]
    yield "      " + " | ".join(f"'{path}'" for path in nested) + ') path="$path ${COMP_WORDS[i]}" ;;'
    yield "    esac\n  done"
    yield '  case "$path $before" in'
    for page in root.everything():
        for flags, value, _ in page.options():
            if choices(value):
                at = "".join(f" {word}" for word in page.words)
                yield "    " + " | ".join(f"'{at} {flag}'" for flag in flags) + \
                    f") COMPREPLY=($(compgen -W '{' '.join(choices(value))}' -- \"$word\")); return ;;"
    yield "  esac"
    yield '  case "$path" in'
    for page in root.everything():
        words = [flag for flags, _, _ in page.options() for flag in flags] + [command.words[-1] for command in page.commands]
        at = "".join(f" {word}" for word in page.words)
        yield f"    '{at}') COMPREPLY=($(compgen -W '{' '.join(words)}' -- \"$word\")) ;;"
    yield "  esac"
    yield '  if [[ $word != -* && -n $path ]]; then COMPREPLY+=($(compgen -f -- "$word")); fi'
    yield "}\ncomplete -o filenames -F _sparsha sparsha"


def quoted(text):
    return text.replace("'", "'\\''").replace("[", "\\[").replace("]", "\\]").replace(":", "\\:")


def zsh_arguments(page):
    for flags, value, description in page.options():
        action = f":value:({' '.join(choices(value))})" if choices(value) else ":file:_files" if takes_folder_or_file(value) \
            else ":number:" if value else ""
        for flag in flags:
            yield f"'*{flag}[{quoted(description)}]{action}'"


def zsh(root):
    yield "#compdef sparsha"
    yield "# Made by tools/manual.py from the program's --help."
    for page in reversed(list(root.everything())):
        yield "_".join(["_sparsha", *page.words]) + "() {"
        arguments = list(zsh_arguments(page))
        if page.commands:
            yield "  local -a commands; local state line\n  commands=("
            for command in page.commands:
                yield f"    '{command.words[-1]}:{quoted(command.purpose)}'"
            yield "  )"
            arguments += ["'1:command:->command'", "'*::argument:->argument'"]
        else:
            arguments.append("'*:file:_files'")
        yield "  _arguments -C \\\n    " + " \\\n    ".join(arguments)
        if page.commands:
            prefix = "_".join(["_sparsha", *page.words])
            yield f"  case $state in\n    command) _describe command commands ;;\n    argument) {prefix}_$line[1] ;;\n  esac"
        yield "}"
    yield '_sparsha "$@"'


def main():
    if len(sys.argv) not in (3, 4):
        print(__doc__, file=sys.stderr)
        return 2
    program, out = sys.argv[1], pathlib.Path(sys.argv[2])
    date = sys.argv[3] if len(sys.argv) == 4 else datetime.date.today().isoformat()
    version = subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout.split("\n")[0]
    root = Help(program, [])
    (out / "man1").mkdir(parents=True, exist_ok=True)
    for page in [root, *root.commands]:
        name = "-".join(["sparsha", *page.words])
        (out / "man1" / f"{name}.1").write_text("\n".join(man_page(page, date, version)) + "\n", encoding="utf-8")
    (out / "man5").mkdir(exist_ok=True)
    (out / "man5" / "sparsha-config.5").write_text("\n".join(config_page(program, date, version)) + "\n", encoding="utf-8")
    schema = subprocess.run([program, "config", "schema"], check=True, capture_output=True, text=True).stdout
    (out / "sparsha.schema.json").write_text(schema, encoding="utf-8")
    (out / "sparsha.bash").write_text("\n".join(bash(root)) + "\n", encoding="utf-8")
    (out / "_sparsha").write_text("\n".join(zsh(root)) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
