"""Turns a checkout into what is published: addresses, licences in each crate, one version.

    python3 packaging/prepare.py REPOSITORY REF

REPOSITORY is the address of the repository, such as https://github.com/OWNER/stickslip, REF the tag v1.2.3. The files
are changed in place, so use a copy. README is shown on PyPI and crates.io, where relative links lead nowhere: they
become links to REF. Fails if REF, Cargo.toml, CITATION.cff, CHANGELOG.md and the ROS 2 package differ in the version.
"""

import re
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
VERSIONS = {
    "Cargo.toml": r'^version = "(.*)"',
    "CITATION.cff": r"^version: (.*)",
    "CHANGELOG.md": r"^## (\S+)",
    "ros2/stickslip_ros/package.xml": r"<version>(.*)</version>",
    "ros2/stickslip_ros/setup.py": r'version="(.*)"',
}


def absolute(text, repository, ref):
    """Markdown whose relative links lead to the repository."""

    def link(found):
        image, words, target = found.groups()
        kind = "raw" if image else "blob"
        return f"{image}[{words}]({repository}/{kind}/{ref}/{target})"

    return re.sub(r"(!?)\[([^\]]*)\]\((?![a-z]+:|#)([^)]+)\)", link, text)


def main(repository, ref):
    for name, pattern in VERSIONS.items():
        version = re.search(pattern, (ROOT / name).read_text(encoding="utf-8"), re.MULTILINE)[1]
        if ref != f"v{version}":
            sys.exit(f"{name} has version {version}, and the tag is {ref}; they must be equal")
    # workspace dependencies name the version again
    cargo = ROOT / "Cargo.toml"
    for dependency, version in re.findall(r'^(\S+) = \{ version = "(.*?)", path', cargo.read_text(), re.MULTILINE):
        if ref != f"v{version}":
            sys.exit(f"Cargo.toml asks for {dependency} {version}, and the tag is {ref}; they must be equal")

    project = ROOT / "pyproject.toml"
    urls = f'[project.urls]\nRepository = "{repository}"\nChangelog = "{repository}/blob/{ref}/CHANGELOG.md"\n\n[project.scripts]'
    project.write_text(project.read_text().replace("[project.scripts]", urls, 1))
    readme = ROOT / "README.md"
    readme.write_text(absolute(readme.read_text(encoding="utf-8"), repository, ref), encoding="utf-8")
    crates = [path for path in ROOT.glob("crates/**/Cargo.toml") if "publish = false" not in path.read_text()]
    for crate in [*crates, ROOT / "crates/python/Cargo.toml"]:
        crate.write_text(crate.read_text().replace("[package]\n", f'[package]\nrepository = "{repository}"\n', 1))
        for licence in ROOT.glob("LICENSE-*"):
            shutil.copy(licence, crate.parent)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
