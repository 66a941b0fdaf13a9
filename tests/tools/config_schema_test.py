"""`sparsha config schema` is a schema that python3-jsonschema takes, takes every configuration of the tree, of the pages and of
`sparsha new`, refuses each kind of fault, and never refuses what the program takes.

  config_schema_test.py SPARSHA"""
import copy
import json
import pathlib
import random
import re
import subprocess
import sys
import tempfile

try:
    import jsonschema
    import yaml
except ImportError as error:
    print(f"{error}: python3-jsonschema and python3-yaml are in packages-nightly.txt")
    sys.exit(77)

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
ROOT = pathlib.Path(__file__).resolve().parents[2]


class Editor(yaml.SafeLoader):
    """Plain scalars as editors read them, by YAML 1.2: `on` and `off` are texts, 1e-3 is a number."""

    yaml_implicit_resolvers = {}


for tag, pattern, first in [("bool", r"true|false", "tf"), ("null", r"~|null|", "~n"), ("int", r"[-+]?[0-9]+", "-+0123456789"),
                            ("float", r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", "-+.0123456789")]:
    Editor.add_implicit_resolver(f"tag:yaml.org,2002:{tag}", re.compile(f"^({pattern})$"), [*first, ""] if tag == "null" else [*first])


def number(loader, node):
    return float(node.value)


Editor.add_constructor("tag:yaml.org,2002:float", number)


MODE = "{frequency_hz: 300, decay_s: 1}"
REGION = "name: r, box_m: [0, 0, 1, 1]"
# (configuration without its scans, whether it is taken)
JUDGED = [
    ("guide: {path: drawn}", False), ("guide: {path: drawn, line_m: [[0, 0], [1, 0]]}", True), ("guide: {path: part}", False),
    ("guide: {path: part}\nparts: [{name: p, box_m: [0, 0, 1, 1]}]", True), ("guide: {path: outline}", True), ("guide: {force_n: 1}", True),
    ("guide: {path: part, line_m: [[0, 0], [1, 0]]}", False), ("guide: {line_m: [[0, 0], [1, 0]]}", False),
    ("unroll: {}", True), ("unroll: {}\naround: {}", False), ("unroll:\naround:", False), ("around: {}", True),
    ("unroll: {}\ngrid: {bounds_m: [0, 0, 1, 1]}", False), ("unroll: {}\ngrid: {size: 100}", True),
    ("unroll: {}\norientation: {face: auto}", False), ("unroll: {}\norientation: {look_from: [1, 0, 0]}", True),
    ("unroll: {slope_deg: 3, shape: cone}", True), ("unroll: {slope_deg: 3, shape: auto}", False), ("unroll: {slope_deg: 3}", False),
    ("unroll: {axis: [0, 0, 1], centre_m: [0, 0, 0]}", True), ("unroll: {axis: auto, centre_m: [0, 0, 0]}", False),
    (f"audio: {{regions: [{{{REGION}, modal: {{modes: []}}}}]}}", False),
    (f"audio: {{regions: [{{{REGION}, modal: {{modes: [{', '.join([MODE] * 32)}]}}}}]}}", True),
    (f"audio: {{regions: [{{{REGION}, modal: {{modes: [{', '.join([MODE] * 33)}]}}}}]}}", False),
    (f'audio: {{regions: [{{{REGION}, clip: ""}}]}}', False), (f"audio: {{regions: [{{{REGION}, clip: a.wav}}]}}", True),
    ('audio: {labels: ""}', False), ('audio: {labels: {file: ""}}', False), ("audio: {labels: {file: a.png}}", True),
    ('parts: [{name: "", box_m: [0, 0, 1, 1]}]', False), ('parts: [{name: " ", box_m: [0, 0, 1, 1]}]', False),
    ("parts: [{name: 5, box_m: [0, 0, 1, 1]}]", True), ("parts: [{name: p, box_m: [0, 0, 0, 1, 1, 1]}]", False),
    ("around: {}\nparts: [{name: p, box_m: [0, 0, 0, 1, 1, 1]}]", True),
    ("audio: {regions: [{name: r, box_m: [0, 0, 0, 1, 1, 1], material: bronze}]}", False),
    ("around:\naudio: {regions: [{name: r, box_m: [0, 0, 0, 1, 1, 1], material: bronze}]}", True),
    ("parts: [{name: p, label: 3}]", False), ("audio:\nparts: [{name: p, label: 3}]", False),
    ("audio: {labels: a.png}\nparts: [{name: p, label: 3}]", True),
    ("audio: {regions: [{name: r, label: 3, material: bronze}]}", False),
    ("audio: {labels: a.png, regions: [{name: r, label: 3, material: bronze}]}", True),
    ("parts: [{name: p, box_m: [0, 0, 1, 1], mu_dynamic: 0.2}]", False),
    ("friction:\nparts: [{name: p, box_m: [0, 0, 1, 1], mu_dynamic: 0.2}]", True),
    ('filters: [{field: {name: "", min: 1}}]', False), ("filters: [{field: {name: confidence, min: 1}}]", True),
    ('grid: {size: "5"}', False), ('grid: {spacing_mm: "5"}', False), ("grid: {spacing_mm: 5 mm}", False),
    ('fill: {max_gap_mm: "5"}', False), ('texture: ""', False), ("haptics: hello", False), ("grid: {spacing_mm: 1e-1}", True),
]


def load(text):
    return yaml.load(text, Editor)


def program(*words, code=0, **more):
    done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, timeout=120, check=False, **more)
    if code is not None and done.returncode != code:
        sys.exit(f"{' '.join(map(str, words))} ended with {done.returncode}: {done.stderr}")
    return done


def configurations():
    """(where, text) of every configuration: files, blocks of pages, what the program writes itself."""
    for file in sorted([*(ROOT / "configs").glob("*.yaml"), *(ROOT / "data").rglob("*.yaml"), *(ROOT / "tests").rglob("*.yaml")]):
        yield file.relative_to(ROOT), file.read_text(encoding="utf-8")
    for page in sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]):
        for block in re.findall(r"^```yaml\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S):
            yield page.relative_to(ROOT), block
    yield "sparsha new", program("new", *sorted((ROOT / "data" / "relief").glob("*.p[cl][dy]"))).stdout


def places(value, path=()):
    """Every block and scalar of a document."""
    yield path, value
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        yield from places(item, (*path, key))


def changed(document, path, new):
    document = copy.deepcopy(document)
    at = document
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = new
    return document


def main():
    schema = json.loads(program("config", "schema").stdout)
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    faults, taken, documents = [], 0, []
    for where, text in configurations():
        document = load(text)
        if not isinstance(document, dict) or "surface" in document or "sampler" in document:
            continue  # of `sparsha simulate`, or no map
        partial = "scans" not in document
        if partial and not set(document) <= set(schema["properties"]):
            continue  # a block within a block, or the texts of speech
        whole = {"scans": [{"file": "a.ply"}], **document}
        wrong = [error.message for error in validator.iter_errors(whole)]
        if wrong:
            faults.append(f"{where}: {wrong[0]}")
        taken += 1
        documents.append(whole)
    if taken < 8:
        faults.append(f"only {taken} configurations were found")

    # One fault each.
    refused = 0
    for document in documents:
        for path, value in places(document):
            mutants = []
            if isinstance(value, dict):
                mutants.append(changed(document, (*path, "no_such_key"), 1))
            elif path and not isinstance(value, list):
                mutants.append(changed(document, path, {"no_such_key": {}}))
            for mutant in mutants:
                refused += 1
                if validator.is_valid(mutant):
                    faults.append(f"the schema takes a fault at {path}")
    if refused < 200:
        faults.append(f"only {refused} faults were tried")

    # What is to be beside what, and what is too much or too little: judged by both.
    for fragment, accepted in JUDGED:
        text = "scans: [{file: a.ply}]\n" + fragment
        if validator.is_valid(load(text)) != accepted:
            faults.append(f"the schema {'refuses' if accepted else 'takes'} {fragment}")
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "c.yaml"
            file.write_text(text, encoding="utf-8")
            done = program("build", file, "--validate", code=None)
            # A scan that is not there is found behind the configuration.
            if (done.returncode == 2) == accepted:
                faults.append(f"the program {'refuses' if accepted else 'takes'} {fragment}: {done.stderr}")

    # Whatever the program takes, an editor takes: values of one place put at another, by chance.
    chance = random.Random(40)
    values = [(path, value) for document in documents for path, value in places(document) if path and not isinstance(value, dict)]
    agreed = 0
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "c.yaml"
        for _ in range(120):
            document = chance.choice(documents)
            path = chance.choice([path for path, value in places(document) if path and path[0] != "scans"] or [None])
            if path is None:
                continue
            # Every other time of the same key, which is taken more often.
            of_key = [value for other, value in values if other[-1] == path[-1]] if chance.random() < 0.5 else []
            mutant = changed(document, path, chance.choice(of_key or [value for _, value in values]))
            file.write_text(json.dumps(mutant, indent=1), encoding="utf-8")
            done = program("build", file, "--validate", code=None)
            if done.returncode == 0:
                agreed += 1
                if not validator.is_valid(mutant):
                    faults.append(f"the program takes what the schema refuses, at {path}: {mutant}")
    print("\n".join(faults) if faults else f"{taken} configurations, {refused} faults, {agreed} changes that the program takes")
    return 1 if faults else 0


sys.exit(main())
