#!/usr/bin/env python3
"""A list of what the program is built from and with, as CycloneDX 1.5: sbom.py VERSION PACKAGE ... > sbom.json

Versions are those of the installed Debian packages, licences the short names in their /usr/share/doc/PACKAGE/copyright. Same
packages, same bytes: no time, no number of its own.
"""
import json
import re
import subprocess
import sys
from pathlib import Path


def installed(package):
    """Version, architecture, source and homepage; None where it is not installed."""
    form = "${db:Status-Status}\t${Version}\t${Architecture}\t${source:Package}\t${Homepage}"
    done = subprocess.run(["dpkg-query", "-W", "-f", form, package], capture_output=True, text=True)
    fields = done.stdout.split("\t")
    return fields[1:] if done.returncode == 0 and fields[0] == "installed" else None


def licences(package):
    """Short names of a copyright file that machines can read; a reference to the file where it is prose."""
    path = Path("/usr/share/doc") / package / "copyright"
    text = path.read_text(errors="replace") if path.is_file() else ""
    names = []
    if re.match(r"Format:", text):
        for line in re.findall(r"^License:[ \t]*(\S.*)$", text, re.MULTILINE):
            if line.strip() not in names: names.append(line.strip())
    return names or [f"see {path}"]


def component(package):
    found = installed(package)
    if not found: raise SystemExit(f"sbom: {package} is not installed; run ./dev deps")
    version, architecture, source, homepage = found
    made = {"type": "library", "name": package, "version": version,
            "purl": f"pkg:deb/debian/{package}@{version}?arch={architecture}",
            "licenses": [{"license": {"name": name}} for name in licences(package)],
            "properties": [{"name": "debian:source", "value": source}]}
    if homepage: made["externalReferences"] = [{"type": "website", "url": homepage}]
    return made


def main():
    version, *packages = sys.argv[1:]
    bill = {"bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1,
            "metadata": {"component": {"type": "application", "name": "seldinger", "version": version,
                                       "licenses": [{"license": {"id": "Apache-2.0"}}]}},
            "components": [component(package) for package in sorted(packages)]}
    print(json.dumps(bill, indent=1))


if __name__ == "__main__":
    main()
