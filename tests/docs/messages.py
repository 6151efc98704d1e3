#!/usr/bin/env python3
"""messages.py SOURCE [--table]: every text that the program says, in one table; the plain rules of messages hold for each.

    tests/docs/messages.py . --table | less          file:line, kind, text: to be read in a row

Texts are literals of two words or more in engine/, apps/ and python/: adjacent literals are joined, and {} takes the place of a value. The kind is read
from the call around the text: error, note (warnings too), help (of the command line), progress, and text (returned or stored, and part of another message).
Not listed: formats of files (numbers, markup, shaders), which have no prose.
"""
import ast
import re
import sys
from collections import Counter
from pathlib import Path

TOKEN = re.compile(r"""
    (?P<comment>//[^\n]*|/\*.*?\*/) | (?P<raw>R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)") | (?P<text>"(?:[^"\\\n]|\\.)*") | (?P<char>'(?:[^'\\\n]|\\.)+')
  | (?P<name>[A-Za-z_][\w:]*(?:(?:\.|->)[A-Za-z_]\w*)*) | (?P<number>\d[\w.']*) | (?P<sign>[^\s\w])""", re.VERBOSE | re.DOTALL)
# by the name of a call around a text, innermost first
KINDS = {
    "help": {"add_option", "add_flag", "add_flag_callback", "add_subcommand", "type_name", "CommandLine", "flag", "arg", "def"},
    "error": {"Error", "fail", "fail_set", "refuse", "refuse_it", "need", "wrong", "complain", "value_error", "only_for", "check_on_wire", "runtime_error",
              "one_of_these", "raise", "throw", "refuse_damaged", "damaged", "cut_off", "bad_file"},
    "note": {"note", "warn", "warning", "add_note", "warnings", "notes", "complaints"},
    "progress": {"say", "tell", "print", "progress", "line", "show"},
}
# words of no field; each has a plain word (docs/glossary.md)
PRIVATE = r"\b(?:goes on|went on|go on with|is told|are told|likewise|as a whole|mended|walls? (?:that )?yields?|none that|that one's|that are none|which is none|what cannot be|stands for|speaks of|comes second)\b"
LONGEST = 420  # characters: three lines of a terminal, names and numbers not counted
RULES = [
    ("asks the user", lambda kind, text: re.search(r"[a-z)\"]\?(?:\s|$)", text)),
    ("exclaims", lambda kind, text: re.search(r"[a-z]!(?:\s|$)", text)),
    ("uses a private word", lambda kind, text: re.search(PRIVATE, text)),
    ("says what is given where a message says what it got", lambda kind, text: kind == "error" and re.search(r"\bgiven\b[;,].*\bexpected\b|\{\} given\b", text)),
    ("says what it got but not what it expected", lambda kind, text: kind == "error" and re.search(r": got \{\}\s*$", text)),
    ("opens a fix and gives none", lambda kind, text: re.search(r"\bFix:\s*$", text)),
    ("is longer than a reader's patience", lambda kind, text: len(text) > LONGEST),
    ("is sorry", lambda kind, text: re.search(r"\b(?:sorry|oops|unfortunately)\b", text, re.IGNORECASE)),
    ("has two spaces between words", lambda kind, text: kind != "text" and re.search(r"[a-z,;] {2,}[a-z]", text) and "\n" not in text),
]


def is_prose(text):
    """Two words or more; no markup, path, shader, or format of a file."""
    words = re.findall(r"(?<![\w.#&])[A-Za-z][a-z]{1,}(?![\w=(])", text)
    return len(words) >= 2 and " " in text and not re.search(r"[<>{};] *\n|</|/>|^\s*[<{]\w|\bfloat\b.*;|\buniform\b|^\s*\[+\w+\]+\n|=\"|font-|px;", text)


def kind_of(calls):
    if "static_assert" in calls:
        return None  # said to who builds it
    for name in reversed(calls):
        for kind, names in KINDS.items():
            if names & set(re.split(r"\W+", name)):
                return kind
    return "text"


def cpp_texts(source):
    """(line, kind, text). Literals that stand together are one; a value added between two of them is {}."""
    calls, name, held = [], "", None  # held: [line, kind, text, depth, since]
    for token in TOKEN.finditer(source):
        kind, word = token.lastgroup, token.group()
        kind = "raw" if token.group("raw") else kind
        if kind == "comment":
            continue
        if kind in ("text", "raw"):
            text = unescaped(word[1:-1]) if kind == "text" else word[word.index("(") + 1:word.rindex(")")]
            if held and held[3] == len(calls) and re.fullmatch(r"[^,?;]*", held[4]) and (not held[4] or "+" in held[4]):
                held[2] += ("{}" if held[4].strip("+ ") else "") + text
                held[4] = ""
            else:
                if held:
                    yield held[:3]
                held = [source.count("\n", 0, token.start()) + 1, kind_of(calls), text, len(calls), ""]
            name = ""
            continue
        if word in "([{":
            calls.append(name if word == "(" or name else "")
        elif word in ")]}" and calls:
            calls.pop()
        if word == "throw" or kind == "name":
            name = word
        elif word not in "<>":
            name = ""
        if held and (len(calls) < held[3] or (len(calls) == held[3] and word in ",?:;")):
            yield held[:3]
            held = None
        elif held:
            held[4] += word if len(calls) == held[3] else ""
    if held:
        yield held[:3]


def unescaped(text):
    return re.sub(r"\\(.)", lambda match: {"n": "\n", "t": "\t", "r": "\r"}.get(match.group(1), match.group(1)), text)


def python_texts(source):
    def text_of(node):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            return node.value
        if isinstance(node, ast.JoinedStr):
            return "".join(part.value if isinstance(part, ast.Constant) else "{}" for part in node.values)
        if isinstance(node, ast.BinOp):
            sides = [text_of(node.left), text_of(node.right)]
            return None if sides == [None, None] else "".join(side if side is not None else "{}" for side in sides)
        return None

    for node in ast.walk(ast.parse(source)):
        calls = {ast.Raise: "error"}.get(type(node))
        if isinstance(node, ast.Call):
            named = getattr(node.func, "attr", getattr(node.func, "id", ""))
            calls = "error" if named.endswith("Error") else kind_of([named])
            if calls == "text":
                continue
            for part in node.args:
                if text_of(part) is not None:
                    yield part.lineno, calls, text_of(part)


def table(root):
    rows = []
    for room in ("engine", "apps", "python/seldinger", "python/src"):
        for file in sorted((root / room).rglob("*")):
            if file.suffix not in (".cpp", ".h", ".py"):
                continue
            source = file.read_text(encoding="utf-8")
            for line, kind, text in (python_texts if file.suffix == ".py" else cpp_texts)(source):
                if kind and is_prose(text):
                    rows.append((f"{file.relative_to(root).as_posix()}:{line}", kind, text))
    return rows


def main():
    rows = table(Path(sys.argv[1]))
    if "--table" in sys.argv:
        for row in rows:
            print("\t".join(row[:2] + (row[2].replace("\n", "\\n"),)))
        return 0
    complaints = [f"{place}: a text {rule}: {text!r}" for place, kind, text in rows
                  for rule, breaks in RULES if breaks(kind, text)]
    counts = Counter(kind for _, kind, _ in rows)
    print("\n".join(complaints) if complaints else f"{len(rows)} texts: " + ", ".join(f"{n} {kind}" for kind, n in counts.most_common()))
    return 1 if complaints or not all(counts[kind] for kind in KINDS) else 0


if __name__ == "__main__":
    sys.exit(main())
