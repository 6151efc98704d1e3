#!/usr/bin/env python3
"""Stages the source of the site: docs/ as it is, README.md as its index, and what they link to outside docs/ beside them.

    stage_site.py REPOSITORY FOLDER

A link to a file that is not there, or to a heading that a page does not have, is an error that names page and link. Headings
have the names that GitHub gives them, which are those of Python-Markdown but for runs of hyphens; a link that works in one of
the two only is an error as well.
"""
import os
import pathlib
import re
import shutil
import sys

LINK = re.compile(r"(?<!\\)(\]\()([^()\s]+)(\))")
ELSEWHERE = "source"  # folder of the site for files from outside docs/


def without_code(text):
    """The same text with fenced and indented code and spans of code blanked: no links are looked for there."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group())
    text = re.sub(r"^```.*?^```", blank, text, flags=re.M | re.S)
    text = re.sub(r"(?<=\n\n)((?: {4}|\t).*\n)+", blank, text)
    return re.sub(r"`[^`\n]+`", blank, text)


def anchors(page):
    """(as GitHub names headings, as Python-Markdown does)"""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    ours, theirs = set(), set()
    for title in re.findall(r"^#+ +(.*?)(?: *\{#.*\})?$", text, flags=re.M):
        title = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title)  # the words of a link
        plain = re.sub(r"[^\w\s-]", "", title).strip().lower()
        ours.add(re.sub(r"\s", "-", plain))
        theirs.add(re.sub(r"[-\s]+", "-", plain))
    return ours, theirs


class Stage:
    def __init__(self, repository, folder):
        self.repository, self.folder, self.complaints, self.staged = repository, folder, [], {}

    def place_of(self, file):
        """Where a file of the repository lies in the site."""
        inside = file.relative_to(self.repository)
        if inside == pathlib.Path("README.md"):
            return pathlib.Path("index.md")
        if inside == pathlib.Path("CHANGELOG.md"):
            return inside
        return inside.relative_to("docs") if inside.parts[0] == "docs" else pathlib.Path(ELSEWHERE) / inside

    def add(self, file):
        if file in self.staged:
            return self.staged[file]
        place = self.staged[file] = self.place_of(file)
        target = self.folder / place
        target.parent.mkdir(parents=True, exist_ok=True)
        if file.suffix == ".md":
            target.write_text(self.page(file, place), encoding="utf-8")
        else:
            shutil.copyfile(file, target)
        return place

    def page(self, file, place):
        text, where = file.read_text(encoding="utf-8"), file.relative_to(self.repository)
        result, end = [], 0
        for match in LINK.finditer(without_code(text)):
            link = match.group(2)
            if re.match(r"[a-z]+:", link):
                continue
            path, _, anchor = link.partition("#")
            target = (file.parent / path).resolve() if path else file
            if self.repository not in [target, *target.parents] or not target.exists():
                self.complaints.append(f"{where}: {link}: there is no such file")
                continue
            if target.is_dir():
                self.complaints.append(f"{where}: {link}: a folder; link to a file in it")
                continue
            if anchor and target.suffix == ".md" and not all(anchor in names for names in anchors(target)):
                self.complaints.append(f"{where}: {link}: {target.name} has no such heading")
            relative = os.path.relpath(self.add(target), place.parent) if path else ""
            result += [text[end:match.start(2)], relative + ("#" + anchor if anchor else "")]
            end = match.end(2)
        return "".join(result) + text[end:]


def main():
    repository, folder = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
    shutil.rmtree(folder, ignore_errors=True)
    stage = Stage(repository, folder)
    for page in [repository / "README.md", repository / "CHANGELOG.md", *sorted((repository / "docs").glob("*.md"))]:
        stage.add(page)
    print("\n".join(stage.complaints), file=sys.stderr, end="\n" if stage.complaints else "")
    return 1 if stage.complaints else 0


if __name__ == "__main__":
    sys.exit(main())
