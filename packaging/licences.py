"""Licence texts of all crates that are compiled into the program and the Python package.

    python3 packaging/licences.py            writes THIRD-PARTY-LICENSES.txt
    python3 packaging/licences.py --check    fails if that file is out of date

The MIT, BSD and Apache licences ask that their text goes with every copy. Texts are those that the crates ship;
each is written once, under the crates that it comes with. Of a crate that offers a choice, MIT is taken.
"""

import json
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FILE = ROOT / "THIRD-PARTY-LICENSES.txt"
BUILT = ("stickslip-cli", "stickslip-python")
NAMES = ("LICENSE*", "LICENCE*", "COPYING*", "COPYRIGHT*", "NOTICE*", "UNLICENSE*", "license*")


def compiled_in(metadata):
    """Packages that are compiled into `BUILT`, on any platform, in the order of their names."""
    packages = {package["id"]: package for package in metadata["packages"]}
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    rest = [id for id, package in packages.items() if package["name"] in BUILT]
    found = set()
    while rest:
        id = rest.pop()
        if id in found:
            continue
        found.add(id)
        for dependency in nodes[id]["deps"]:
            if any(kind["kind"] is None for kind in dependency["dep_kinds"]):
                rest.append(dependency["pkg"])
    others = [packages[id] for id in found if packages[id]["source"]]
    return sorted(others, key=lambda package: (package["name"], package["version"]))


def main():
    command = ["cargo", "metadata", "--format-version", "1", "--locked"]
    metadata = json.loads(subprocess.run(command, cwd=ROOT, check=True, capture_output=True).stdout)
    texts, without = defaultdict(list), []
    for package in compiled_in(metadata):
        name = f"{package['name']} {package['version']} ({package['license']})"
        folder = Path(package["manifest_path"]).parent
        files = {file for pattern in NAMES for file in folder.glob(pattern) if file.is_file()}
        mit = {file for file in files if "MIT" in file.name.upper()}
        for file in sorted(mit if " AND " not in package["license"] and mit else files):
            text = "\n".join(line.rstrip() for line in file.read_text(errors="replace").strip().splitlines())
            texts[text].append(name)
        if not files:
            without.append(name)
    rule = "=" * 100
    parts = [f"{rule}\n{chr(10).join(dict.fromkeys(names))}\n{rule}\n\n{text}\n" for text, names in texts.items()]
    if without:
        parts.append(f"{rule}\nThese crates ship no licence text; their licences are named.\n{rule}\n" + "\n".join(without) + "\n")
    written = "\n".join(parts)
    if "--check" not in sys.argv:
        FILE.write_text(written)
        print(f"{FILE.name}: {len(texts)} texts, {len(without)} crates without one")
    elif not FILE.exists() or FILE.read_text() != written:
        sys.exit(f"{FILE.name} is out of date; run: python3 packaging/licences.py")


if __name__ == "__main__":
    main()
