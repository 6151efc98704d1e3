#!/usr/bin/env python3
"""Reads every mesh among the seeds of make_seeds.py with VTK: what the project keeps or makes does no harm elsewhere.
Ends with 1 where a reader ended by a signal or gave no answer, with 77 without VTK."""
import importlib.util
import pathlib
import subprocess
import sys
import tempfile

READERS = {'stl': 'vtkSTLReader', 'obj': 'vtkOBJReader', 'ply': 'vtkPLYReader', 'vtp': 'vtkXMLPolyDataReader', 'vtk': 'vtkPolyDataReader',
           'centreline': 'vtkXMLPolyDataReader', 'pipeline': 'vtkOBJReader'}
READ = '''import sys, vtk
for path in sys.argv[2:]:
    print(path, flush=True)
    reader = getattr(vtk, 'vtkPolyDataReader' if path.endswith('/legacy') else sys.argv[1])()
    reader.SetFileName(path)
    reader.Update()'''


def main():
    if not importlib.util.find_spec('vtk'):
        return 77
    harmed = 0
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, pathlib.Path(__file__).with_name('make_seeds.py'), folder], check=True)
        for target, reader in READERS.items():
            paths = sorted(pathlib.Path(folder, target).iterdir())
            done = subprocess.run([sys.executable, '-c', READ, reader, *map(str, paths)], capture_output=True, text=True, timeout=120)
            read = done.stdout.splitlines()
            if done.returncode != 0 or len(read) != len(paths):
                print(f'{target}: exit {done.returncode} at {read[-1:]}')
                harmed += 1
    return 1 if harmed else 0


if __name__ == '__main__':
    sys.exit(main())
