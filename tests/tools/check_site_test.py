"""A site with one fault each: tools/check-site.py names it, and says nothing of a site without fault."""
import pathlib
import subprocess
import sys
import tempfile

CHECK = pathlib.Path(__file__).resolve().parents[2] / "tools" / "check-site.py"
PAGE = '<html lang="en"><head><title>Page</title></head><body><main role="main">{}</main></body></html>'
GOOD = '<h1 id="top">Page</h1><h2>Part</h2><p><a href="#top">up</a> <a href="other.html#top">other</a><img src="a.png" alt="A"></p><table><tr><th><b>mm</b></th></tr></table>'
FAULTS = [
    ('<a href="gone.html">x</a>', "gone.html leads nowhere"),
    ('<a href="other.html#gone">x</a>', "other.html#gone: there is no such place"),
    ('<a href="#gone">x</a>', "#gone: there is no such place"),
    ('<img src="a.png">', "image a.png has no text"),
    ('<img src="gone.png" alt="G">', "gone.png leads nowhere"),
    ("<h4>deep</h4>", "a heading of level 4 follows one of level 2"),
    ("<h1>again</h1>", "2 first headings"),
    ("<table><tr><th> </th><th>mm</th></tr></table>", "the head of a table's column has no text"),
]


def check(text):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        (root / "a.png").touch()
        (root / "other.html").write_text(PAGE.format('<h1 id="top">Other</h1>'), encoding="utf-8")
        (root / "page.html").write_text(text, encoding="utf-8")
        done = subprocess.run([sys.executable, CHECK, root], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout


wrong = [] if check(PAGE.format(GOOD))[0] == 0 else ["a site without fault is refused"]
cases = [(PAGE.format(GOOD + added), expected) for added, expected in FAULTS]
cases.append((PAGE.format(GOOD).replace(' lang="en"', ""), "no language"))
cases.append((PAGE.format(GOOD).replace("<title>Page</title>", ""), "no title"))
for text, expected in cases:
    code, said = check(text)
    if code != 1 or f"page.html: {expected}" not in said or said.count("\n") != 1:
        wrong.append(f"expected '{expected}', but it said {said!r}")
print("\n".join(wrong) if wrong else f"{len(cases)} faults are found")
sys.exit(1 if wrong else 0)
