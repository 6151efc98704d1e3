#!/usr/bin/env python3
"""test_sbom.py DEV: `./dev sbom` lists every package of `./dev deps` once, with a version and a licence, the same twice."""
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path


def main():
    dev = Path(sys.argv[1])
    if not shutil.which("dpkg-query"):
        print("no dpkg here")
        return 77
    lists = re.findall(r"^(?:build_)?packages=\((.*?)^\)", dev.read_text(), re.MULTILINE | re.DOTALL)
    wanted = [name for names in lists for name in names.split() if not name.startswith('"$')]
    runs = [subprocess.run([dev, "sbom"], capture_output=True, text=True) for _ in range(2)]
    if "is not installed" in runs[0].stderr:
        print(runs[0].stderr.strip())
        return 77
    assert runs[0].returncode == 0, runs[0].stderr
    assert runs[0].stdout == runs[1].stdout
    bill = json.loads(runs[0].stdout)
    assert bill["bomFormat"] == "CycloneDX" and bill["metadata"]["component"]["version"]
    assert [c["name"] for c in bill["components"]] == sorted(wanted)
    for c in bill["components"]:
        assert c["version"] and c["version"] in c["purl"], c
        assert c["licenses"] and all(entry["license"]["name"] for entry in c["licenses"]), c
    known = {c["name"]: [entry["license"]["name"] for entry in c["licenses"]] for c in bill["components"]}
    assert any("MPL" in name for name in known["libeigen3-dev"])
    return 0


if __name__ == "__main__":
    sys.exit(main())
