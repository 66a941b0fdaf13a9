#!/usr/bin/env python3
"""The reference of docs/configuration.md, made from `sparsha config keys --json`, so that page and program cannot disagree.

  tools/config-reference.py SPARSHA            fails where the page says something else
  tools/config-reference.py SPARSHA --write    makes the page's part again"""
import json
import pathlib
import subprocess
import sys

PAGE = pathlib.Path(__file__).resolve().parents[1] / "docs" / "configuration.md"
BEGIN = "<!-- made by tools/config-reference.py --write -->\n"
END = "<!-- end of what tools/config-reference.py wrote -->\n"


def rows(program):
    return json.loads(subprocess.run([program, "config", "keys", "--json"], check=True, capture_output=True, text=True).stdout)


def cell(text):
    return text.replace("|", "\\|")


def reference(program):
    text = ""
    for row in rows(program):
        path = row["key"]
        if "." not in path and "[]" not in path:
            value = "" if row["value"] in ("block", "block; or nothing") else f" Value: {row['value']}."
            default = f" Default `{row['default']}`." if row["default"] else ""
            needed = " Required." if row["required"] else ""
            text += f"\n### Keys of {path}\n\n{row['text']}.{value}{default}{needed}\n"
            table = False
            continue
        if not table:
            text += "\n| key | value | default | meaning |\n| --- | --- | --- | --- |\n"
            table = True
        default = "required" if row["required"] else f"`{row['default']}`" if row["default"] else ""
        text += f"| `{path}` | {cell(row['value'])} | {default} | {cell(row['text'])} |\n"
    return text + "\n"


def main():
    if len(sys.argv) < 2 or sys.argv[2:] not in ([], ["--write"]):
        sys.exit(__doc__)
    page = PAGE.read_text(encoding="utf-8")
    before, begin, rest = page.partition(BEGIN)
    written, end, after = rest.partition(END)
    if not begin or not end:
        sys.exit(f"{PAGE.name} has no part that this script writes")
    wanted = reference(sys.argv[1])
    if sys.argv[2:]:
        PAGE.write_text(before + BEGIN + wanted + END + after, encoding="utf-8")
    elif written != wanted:
        sys.exit(f"{PAGE.name} differs from what the program says of its keys; tools/config-reference.py SPARSHA --write makes it again")
    print(f"{wanted.count(chr(10) + '| `')} keys")


main()
