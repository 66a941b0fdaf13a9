#!/usr/bin/env python3
"""WCAG 2.2, levels A and AA, of static pages as a browser shows them: axe-core in Chromium, at the width of a desk and of a phone.
At the phone's width no page may be wider than the screen (1.4.10 Reflow). Fails on each violation; what axe cannot decide is counted.

  check-wcag.py FOLDER AXE.MIN.JS [--pictures OUT]"""
import concurrent.futures
import html
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

TAGS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
WIDTHS = {"desk": (1280, 900), "phone": (390, 844)}
# A frame of the phone's width, since browsers without a window keep a least width of their own.
FRAME = """<!DOCTYPE html><html lang="en"><title>frame</title><body style="margin:0">
<iframe id="page" src="{page}" style="width:{width}px;height:{height}px;border:0"></iframe><pre id="result"></pre><script>
const page = document.getElementById("page");
page.onload = async () => {{
  const view = page.contentWindow, text = await (await fetch("{axe}")).text();
  view.eval(text);
  const found = await view.axe.run(view.document, {{runOnly: {tags}}});
  document.getElementById("result").textContent = "RESULT" + JSON.stringify({{
    violations: found.violations.map(v => ({{id: v.id, help: v.help, nodes: v.nodes.map(n => n.target.join(" ") + " " + n.html.slice(0, 120))}})),
    undecided: found.incomplete.map(v => v.id), passes: found.passes.length,
    wide: view.document.documentElement.scrollWidth}}) + "END";
}};
</script></body></html>"""


def browser(*words):
    program = next((found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))), None)
    if program is None:
        sys.exit("no Chromium is installed (packages-nightly.txt)")
    return subprocess.run([program, "--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
                           "--allow-file-access-from-files", "--disable-web-security", *words],
                          capture_output=True, text=True, timeout=180, check=False)


def judged(page, axe, size, folder):
    width, height = size
    frame = folder / f"{abs(hash((page, width)))}.html"
    frame.write_text(FRAME.format(page=page.as_uri(), axe=axe.as_uri(), tags=json.dumps(TAGS), width=width, height=height), encoding="utf-8")
    done = browser(f"--user-data-dir={frame.with_suffix('')}", "--virtual-time-budget=60000", "--dump-dom", frame.as_uri())
    found = re.search(r"RESULT(.*?)END</pre>", done.stdout, re.S)
    if not found:
        return {"violations": [{"id": "none", "help": "the page was not judged", "nodes": [done.stderr[-300:]]}], "undecided": [],
                "passes": 0, "wide": 0}
    return json.loads(html.unescape(found[1]))


def main():
    if len(sys.argv) not in (3, 5):
        sys.exit(__doc__)
    root, axe = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    pages = sorted(page for page in root.rglob("*.html") if page.name != "404.html")
    if len(sys.argv) == 5:
        out = pathlib.Path(sys.argv[4])
        out.mkdir(parents=True, exist_ok=True)
        for page in pages:
            browser("--window-size=1280,1600", f"--screenshot={out / page.stem}-desk.png", page.as_uri())
    faults, passes, undecided = [], 0, 0
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(min(2, os.cpu_count() or 1)) as threads:
        tasks = {(page, name): threads.submit(judged, page, axe, size, pathlib.Path(folder)) for page in pages for name, size in WIDTHS.items()}
        for (page, name), task in tasks.items():
            found = task.result()
            passes += found["passes"]
            undecided += len(found["undecided"])
            for fault in found["violations"]:
                faults.append(f"{page.relative_to(root)} ({name}): {fault['id']}: {fault['help']}; "
                              f"{len(fault['nodes'])} places, the first {fault['nodes'][0]}")
            if found["wide"] > WIDTHS[name][0] + 1:
                faults.append(f"{page.relative_to(root)} ({name}): reflow: it is {found['wide']} pixels wide on a screen of {WIDTHS[name][0]}")
    print("\n".join(faults))
    print(f"{len(pages)} pages at {len(WIDTHS)} widths: {passes} rules passed, {len(faults)} violated, {undecided} left to people")
    return 1 if faults or not passes else 0


sys.exit(main())
