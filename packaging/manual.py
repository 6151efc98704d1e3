#!/usr/bin/env python3
"""manual.py OPTIONS.md VERSION FOLDER: the command's man page and bash completion, FOLDER/seldinger.1.gz and FOLDER/seldinger.bash.

docs/options.md is what `--help` of every command says (docs/options in ctest), so both say what the program does.
"""
import gzip
import html
import re
import sys
from pathlib import Path

ROW = re.compile(r"\| `((?:\\\||[^`])*)` \| (.*?) \|(?: (`[^|]*) \|)?")  # the third cell: commands that share the option
SHARED = "Several commands"


def read(page):
    """[(command, what it does, [(option, meaning)])] in the page's order."""
    commands, shared = [], []
    for line in page.splitlines():
        if line.startswith("## "):
            if line != f"## {SHARED}":
                commands.append((line[3:], "", []))
        elif row := ROW.fullmatch(line):
            option, meaning, names = plain(row[1]), plain(row[2]), re.findall(r"`([^`]+)`", row[3] or "")
            if names:
                shared.append((option, meaning, names))
            else:
                commands[-1][2].append((option, meaning))
        elif commands and line and not line.startswith("|"):
            name, _, rows = commands.pop()
            commands.append((name, plain(re.sub(r" More: .*", "", line)), rows))
    for option, meaning, names in shared:
        owners = [rows for name, _, rows in commands if name in names]
        if len(owners) != len(names):
            sys.exit(f"manual.py: {option} is of {names}; not all of them are commands of the page")
        for rows in owners:
            rows.append((option, meaning))
    if not commands or not all(does for _, does, _ in commands):
        sys.exit("manual.py: the page has no commands, or one without a word on it; tests/docs/options.py --write makes it")
    return commands


def plain(text):
    return html.unescape(re.sub(r"\\([|\[])", r"\1", text))


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text[:1] in (".", "'") else text


def manual(commands, version):
    lines = [f'.TH SELDINGER 1 "" "seldinger {version}" "User Commands"', ".SH NAME",
             "seldinger \\- simulation of guidewires, catheters and sheaths in blood vessels",
             ".SH SYNOPSIS", ".B seldinger", ".I COMMAND", "[\\fIOPTION\\fR]...", ".SH DESCRIPTION",
             "Pushes, pulls and turns instruments inside vessels, and estimates the error of forces and tip. A first run:", ".PP",
             ".nf", ".RS", "seldinger run aortic\\-arch \\-o demo", "seldinger render demo", "seldinger report demo", ".RE", ".fi",
             ".SH COMMANDS"]
    for name, does, rows in commands:
        lines += [f".SS {roff(name)}", roff(does)]
        for option, meaning in rows:
            lines += [".TP", f".B {roff(option)}", roff(meaning)]
    lines += [".SH EXIT STATUS", "0 done; 2 the command line or the scene is wrong; 3 a file is missing or unusable; 4 the simulation stopped;",
              "5 no usable OpenCL device, or no OpenGL for pictures; 6 nothing meets what was asked for; 75 stopped by a limit, the state is saved; 130 interrupted.",
              ".SH SEE ALSO", "The pages of the site: /usr/share/doc/seldinger/html/index.html, where the package has them."]
    return "\n".join(lines) + "\n"


COMPLETION = """# bash completion of seldinger(1), made by packaging/manual.py from docs/options.md
_seldinger() {
    local word=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[1]} prefix
    if [ "$COMP_CWORD" -eq 1 ]; then
        COMPREPLY=($(compgen -W "%(first)s --help --version" -- "$word"))
        return
    fi
    case "$command ${COMP_WORDS[2]}" in
%(below)s    esac
    case "$word" in
        -*) case "$command" in
%(options)s            esac ;;
        *)  case "$command ${COMP_WORDS[COMP_CWORD - 1]}" in
                %(groups)s
                %(scenes)s)
                    prefix=$(dirname -- "$(dirname -- "$(command -v seldinger)")")/share/seldinger/scenes
                    COMPREPLY=($(compgen -W "$(cd "$prefix" 2>/dev/null && printf '%%s\\n' *.toml reference/*.toml | sed 's|.*/||; s|[.]toml$||; /[*]/d')" -- "$word")) ;;
            esac ;;
    esac
}
complete -o bashdefault -o default -F _seldinger seldinger
"""


def completion(commands):
    first = [name for name, _, _ in commands if " " not in name]
    below = {}
    for name, _, _ in commands:
        if " " in name:
            below.setdefault(name.split()[0], []).append(name.split()[1])
    words = {name: " ".join(dict.fromkeys(re.findall(r"(?<![\w-])--?[a-z][a-z-]*", " ".join(option for option, _ in rows))))
             for name, _, rows in commands}
    taking = [name for name, _, rows in commands if any(option == "SCENE" for option, _ in rows)]
    inner = [f'        "{" ".join((top, sub))}") command="{top} {sub}" ;;\n' for top, subs in below.items() for sub in subs]
    options = [f'                "{name}") COMPREPLY=($(compgen -W "{words[name]} --help" -- "$word")) ;;\n' for name, _, _ in commands]
    groups = [f'"{top} {top}") COMPREPLY=($(compgen -W "{" ".join(subs)}" -- "$word")) ;;' for top, subs in below.items()]
    return COMPLETION % {"first": " ".join(first), "below": "".join(inner), "options": "".join(options), "groups": "\n                ".join(groups),
                         "scenes": " | ".join(f'"{name} {name}"' for name in taking)}


def main():
    page, version, folder = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
    commands = read(page.read_text(encoding="utf-8"))
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "seldinger.1.gz", "wb") as file, gzip.GzipFile("", "wb", 9, file, mtime=0) as packed:  # the same bytes each time
        packed.write(manual(commands, version).encode())
    (folder / "seldinger.bash").write_text(completion(commands), encoding="utf-8")


if __name__ == "__main__":
    main()
