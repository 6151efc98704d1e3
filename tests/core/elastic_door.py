"""Engine, optional libraries and command take nothing from engine/elastic, the walls that deform, but its door (contact/wall_body.h).

    elastic_door.py SOURCE BUILD

Reads the symbols of what was built. A program without walls that deform (-DSELDINGER_ELASTIC=OFF) has rigid_only.cpp in their
place: what is taken has to be what that file defines, and all of it.
"""
import pathlib
import re
import subprocess
import sys


def symbols(file, option):
    """{object: names}; an archive has many objects, an object no name"""
    out = subprocess.run(["nm", "-C", option, file], capture_output=True, text=True, check=True).stdout
    found, name = {"": set()}, ""
    for line in out.splitlines():
        if line.endswith(".o:"):
            name = line[:-1]
            found[name] = set()
        elif match := re.match(r"[0-9a-f ]{16} ([A-Za-z]) (.*)", line):
            if match[1] in "TDBRU":
                found[name].add(match[2])
    return found


def main():
    source, build = map(pathlib.Path, sys.argv[1:])
    room = {path.name + ".o" for path in source.glob("engine/elastic/**/*.cpp")}
    library = build / "libseldinger.a"
    defined = symbols(library, "--defined-only")
    is_elastic = {name: "engine_elastic_" in name or name in room for name in defined}
    if not any(is_elastic.values()):
        print("elastic_door.py: built without engine/elastic")
        return 77
    elastic = set().union(*(names for name, names in defined.items() if is_elastic[name]))
    own = set().union(*(names for name, names in defined.items() if not is_elastic[name]))
    wanted = [names for name, names in symbols(library, "--undefined-only").items() if not is_elastic.get(name)]
    for other in (*build.glob("libseldinger_*.a"), *build.glob("CMakeFiles/seldinger_app.dir/**/*.o")):
        wanted += symbols(other, "--undefined-only").values()
    taken = set().union(*wanted) & elastic - own
    stands_in = re.findall(r"^\S.* (\w+)\(const .*\)", (source / "engine/physics/contact/rigid_only.cpp").read_text(), re.M)
    door = {f"seldinger::{name}" for name in stands_in}
    calls = {re.sub(r"\(.*|\[abi:.*", "", name) for name in taken}
    print("taken from engine/elastic:", *sorted(calls), sep="\n  ")
    if calls != door:
        print("rigid_only.cpp stands in for:", *sorted(door), sep="\n  ")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
