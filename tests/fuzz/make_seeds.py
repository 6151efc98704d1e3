#!/usr/bin/env python3
"""Small files to begin fuzzing with, a folder for each target: make_seeds.py DIR. All are valid, so that no other program comes to
harm over them (tests/fuzz/seeds_open.py reads them with VTK). Every encoding that a reader knows, once; scenes are the
project's own, and their words DIR/scene.dict. What the engine's own writers make is fuzz_seeds.cpp's."""
import base64
import gzip
import math
import pathlib
import re
import struct
import sys
import zlib


def tube(sides=6, rings=4, radius=3.0, length=12.0):
    points, faces = [], []
    for i in range(rings):
        for k in range(sides):
            a = 2 * math.pi * k / sides
            points.append((i * length / (rings - 1), round(radius * math.cos(a), 3), round(radius * math.sin(a), 3)))
    for i in range(rings - 1):
        for k in range(sides):
            a, b = i * sides + k, i * sides + (k + 1) % sides
            faces += [(a, b, a + sides), (b, b + sides, a + sides)]
    return points, faces


TETRAHEDRON = [(0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 0, 3)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]


def flat(rows):
    return [value for row in rows for value in row]


def obj(points, faces):
    lines = ['v ' + ' '.join(map(str, p)) for p in points] + ['f ' + ' '.join(str(i + 1) for i in f) for f in faces]
    return ('\n'.join(lines) + '\n').encode()


def stl(points, faces):
    records = b''.join(struct.pack('<12fH', 0, 0, 0, *flat(points[i] for i in f), 0) for f in faces)
    return b' ' * 80 + struct.pack('<I', len(faces)) + records


def stl_text(points, faces):
    lines = ['solid s']
    for f in faces:
        lines += ['facet normal 0 0 0', 'outer loop'] + ['vertex %g %g %g' % points[i] for i in f] + ['endloop', 'endfacet']
    return '\n'.join(lines + ['endsolid s', '']).encode()


def ply(points, faces, form):
    head = ['ply', f'format {form} 1.0', 'comment seed', f'element vertex {len(points)}', 'property float x',
            'property double y', 'property float z', f'element face {len(faces)}', 'property uchar flag',
            'property list uchar int vertex_indices', 'element edge 1', 'property list ushort short more', 'end_header', '']
    text = '\n'.join(head).encode()
    if form == 'ascii':
        body = [' '.join(map(str, p)) for p in points] + [f'0 {len(f)} ' + ' '.join(map(str, f)) for f in faces] + ['2 1 2', '']
        return text + '\n'.join(body).encode()
    order = '<' if 'little' in form else '>'
    for p in points:
        text += struct.pack(order + 'fdf', *p)
    for f in faces:
        text += struct.pack(f'{order}BB{len(f)}i', 0, len(f), *f)
    return text + struct.pack(order + 'Hhh', 2, 1, 2)


def vtk(points, faces, binary, modern):
    head = f'# vtk DataFile Version {"5.1" if modern else "4.2"}\nseed SPACE=RAS\n{"BINARY" if binary else "ASCII"}\nDATASET POLYDATA\n'

    def numbers(form, values):
        return struct.pack(f'>{len(values)}{form}', *values) + b'\n' if binary else ' '.join(map(str, values)).encode() + b'\n'
    text = head.encode() + b'FIELD FieldData 2\nSPACE 1 1 string\n' + (b'\xc3RAS\n' if binary else b'RAS\n')
    text += b'METADATA\nINFORMATION 0\n\nTime%20s 1 2 double\n' + numbers('d', (0.5, 10.0))
    text += f'POINTS {len(points)} float\n'.encode() + numbers('f', flat(points))
    if modern:
        offsets = list(range(0, 3 * len(faces) + 1, 3))
        text += f'POLYGONS {len(offsets)} {3 * len(faces)}\nOFFSETS vtktypeint64\n'.encode() + numbers('q', offsets)
        return text + b'CONNECTIVITY vtktypeint64\n' + numbers('q', flat(faces))
    return text + f'POLYGONS {len(faces)} {4 * len(faces)}\n'.encode() + numbers('i', flat((3, *f) for f in faces))


def block(raw, packed):
    if not packed:
        return struct.pack('<I', len(raw)), raw
    data = zlib.compress(raw)
    return struct.pack('<4I', 1, len(raw), len(raw), len(data)), data


def vtp(points, faces, form, packed, lines=False):
    """form: ascii, binary (base64 in place), raw or base64 (appended)"""
    kind, cells = ('Lines', [range(len(points))]) if lines else ('Polys', faces)
    offsets, end = [], 0
    for c in cells:
        end += len(c)
        offsets.append(end)
    arrays = [('Points', 'Float32', 'f', flat(points)), ('connectivity', 'Int32', 'i', flat(cells)), ('offsets', 'Int32', 'i', offsets)]
    if lines:
        arrays.append(('MaximumInscribedSphereRadius', 'Float32', 'f', [1.5] * len(points)))
    tags, appended = [], b''
    for name, type_, code, values in arrays:
        tag = f'<DataArray type="{type_}" Name="{name}" NumberOfComponents="{3 if name == "Points" else 1}" format='
        head, data = block(struct.pack(f'<{len(values)}{code}', *values), packed)
        coded = base64.b64encode(head) + base64.b64encode(data)
        if form == 'ascii':
            tags.append(f'{tag}"ascii">{" ".join(map(str, values))}</DataArray>')
        elif form == 'binary':
            tags.append(f'{tag}"binary">{coded.decode()}</DataArray>')
        else:
            tags.append(f'{tag}"appended" offset="{len(appended)}"/>')
            appended += head + data if form == 'raw' else coded
    text = '<VTKFile type="PolyData" byte_order="LittleEndian"'
    text += ' compressor="vtkZLibDataCompressor"' if packed else ''
    text += f'><PolyData><Piece NumberOfPoints="{len(points)}" NumberOf{kind}="{len(cells)}">'
    text += f'<Points>{tags[0]}</Points><{kind}>{tags[1]}{tags[2]}</{kind}>'
    text += f'<PointData>{tags[3]}</PointData>' if lines else ''
    text = (text + '</Piece></PolyData>').encode()
    if form in ('raw', 'base64'):
        text += f'<AppendedData encoding="{form}">_'.encode() + appended + b'</AppendedData>'
    return text + b'</VTKFile>'


def raw(points, faces):
    data = bytes([len(points) - 3, 0]) + bytes(int(128 + 8 * c) % 256 for c in flat(points))
    return data + bytes(flat(faces))


def labels():
    """A bar of label 1 with a part beside it, in each format."""
    cells = [(x, y, z) for z in range(8) for y in range(6) for x in range(5)]
    voxels = bytes(1 if 1 <= x <= 3 and 1 <= y <= 4 and z < 7 else 2 if (x, y, z) == (0, 5, 7) else 0 for x, y, z in cells)
    nifti = struct.pack('<i36x8h14xhh', 348, 3, 5, 6, 8, 1, 1, 1, 1, 2, 8) + struct.pack('<2x8f3fhB', 1, 1, 1, 1, 1, 1, 1, 1, 352, 0, 0, 0, 2)
    nifti = (nifti.ljust(254, b'\0') + struct.pack('<h24x12f', 1, 1, 0, 0, 5, 0, 1, .2, 6, 0, 0, 2, 7)).ljust(344, b'\0') + b'n+1\0\0\0\0\0'
    nrrd = 'NRRD0004\ndimension: 3\ntype: {}\nspace: RAS\nsizes: 5 6 8\nencoding: {}\nspace directions: (1,0,0) (0,1,0) (0,0,2)\n{}\n'
    meta = 'NDims = 3\nTransformMatrix = 0 1 0 1 0 0 0 0 1\nOffset = 1 2 3\nElementSpacing = 1 1 2\nDimSize = 5 6 8\n{}ElementDataFile = LOCAL\n'
    packed, ascii = zlib.compress(voxels), ' '.join(str(v / 2) for v in voxels if v < 3).encode()
    return {'plain.nii': nifti + voxels, 'packed.nii.gz': gzip.compress(nifti + voxels),
            'raw.nrrd': nrrd.format('uint8', 'raw', 'Segment0_Name:=a\nSegment0_LabelValue:=1\n').encode() + voxels,
            'packed.nrrd': nrrd.format('uint8', 'gzip', 'space origin: (1,2,3)\n').encode() + gzip.compress(voxels),
            'text.nrrd': nrrd.format('float', 'ascii', '').encode() + ascii, 'raw.mha': meta.format('ElementType = MET_UCHAR\n').encode() + voxels,
            'packed.mha': meta.format(f'ElementType = MET_UCHAR\nCompressedData = True\nCompressedDataSize = {len(packed)}\n').encode() + packed}


def scenes():
    """Each scene of the project, with its mesh and what it includes by the names that the target has; then a sweep of each key."""
    root = pathlib.Path(__file__).resolve().parents[2]
    files = sorted([*root.glob('assets/scenes/**/*.toml'), *root.glob('tests/golden/*.toml'), *root.glob('assets/instruments/*.toml')])
    return {'-'.join(file.relative_to(root).parts): re.sub(r'(?m)^(mesh|centreline)( *= *)".*"', r'\1\2"mesh.stl"', file.read_text())
            for file in files}


PART = 'include = "part.toml"\n[scene]\nduration_s = 1.0\ndt_s = 0.01\n\x1e{}\x1ewire.preset="cobra-2-5f"\ncontact.normal="barrier"\nfeed.keys=[]\n'
SWEEP = """[vary]
"wire.bend_nm2" = [4.0e-5, 5.0e-5]
"contact.detection" = ["capsule", "nodes"]
"wire.density" = {min = 6000.0, max = 8000.0, n = 6}
"contact.mu_sliding" = {min = 0.01, max = 0.3, n = 6, log = true}
"feed.keys" = [[{t_s = 0.0, advance_m = 0.004}], [{t_s = 0.0, advance_m = 0.005}]]
"""


def words_of(texts):
    """A dictionary of libFuzzer's: keys, tables and words in quotes."""
    words = {word for text in texts for word in re.findall(r'(?m)^ *([\w.]+) *=|^(\[+[\w.]+\]+)|("[\w-]+")', text) for word in word if word}
    return ''.join('"%s"\n' % word.replace('"', '\\"') for word in sorted(words))


def page(path='/ws', more='', frames=b''):
    lines = [f'GET {path} HTTP/1.1', 'Host: 127.0.0.1:8080', 'Upgrade: websocket', 'Connection: Upgrade', 'Sec-WebSocket-Version: 13',
             'Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==' + more, '', '']
    return '\r\n'.join(lines).encode() + b'\x1e' + frames


def frame(text, opcode=1, last=True):
    """As a browser masks it, by a mask of zeros."""
    head = bytes([opcode | (0x80 if last else 0)])
    head += bytes([0x80 | len(text)]) if len(text) < 126 else bytes([0x80 | 126]) + struct.pack('>H', len(text))
    return head + bytes(4) + text


def pages():
    wish = b'{"push": 0.03, "turn": -2, "instrument": 1, "fluoro": true, "contrast": false, "pause": true, "reset": true}'
    return {'plain': b'GET /?token=secret HTTP/1.1\r\nHost: localhost\r\nCookie: a=b; seldinger_token=secret\r\nOrigin: http://localhost\r\n\r\n',
            'wish': page(frames=frame(wish)), 'token': page('/ws?x=y&token=secret', '\r\nOrigin: http://127.0.0.1:8080', frame(b'{}')),
            'pieces': page(frames=frame(wish[:20], last=False) + frame(b'ping', 9) + frame(wish[20:], 0) + frame(wish, 2)),
            'long': page(frames=frame(b' ' * 900 + wish)), 'closed': page(frames=frame(wish) + frame(b'\x03\xe8bye', 8))}


def main():
    names = ('stl', 'obj', 'ply', 'vtp', 'vtk', 'label', 'centreline', 'pipeline', 'pipeline_raw', 'scene', 'sweep', 'web')
    seeds = {name: {} for name in names}
    for label, mesh in (('tetrahedron', TETRAHEDRON), ('tube', tube(5, 3))):
        seeds['stl'][label] = stl(*mesh)
        seeds['stl'][label + '_text'] = stl_text(*mesh)
        seeds['obj'][label] = obj(*mesh)
        for form in ('ascii', 'binary_little_endian', 'binary_big_endian'):
            seeds['ply'][f'{label}_{form}'] = ply(*mesh, form)
        for binary in (False, True):
            for modern in (False, True):
                seeds['vtk'][f'{label}_{binary}_{modern}'] = vtk(*mesh, binary, modern)
        for form in ('ascii', 'binary', 'raw', 'base64'):
            for packed in (False, True):
                seeds['vtp'][f'{label}_{form}_{packed}'] = vtp(*mesh, form, packed)
                seeds['centreline'][f'{label}_{form}_{packed}'] = vtp(*mesh, form, packed, lines=True)
    line = '# vtk DataFile Version 4.2\nx\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 2 0 0 1 1 0\nLINES 3 9\n2 1 0\n2 1 2\n2 3 1\n'
    seeds['centreline']['legacy'] = (line + 'POINT_DATA 4\nSCALARS Radius float\nLOOKUP_TABLE default\n1 1 1 1\nNORMALS n float\n' + '0 0 1 ' * 4).encode()
    square = 'v 0 0 0\nv 1 0 0\\\n\nv 1 1 0\nv 0 1 1e-3\nvt 0 0\nvn 0 0 1\n'
    for label, face in (('normals', '-4//1 -3//1 -2//1 4//1'), ('textures', '1/1 2/1 3/1 4/1'), ('both', '1/1/1 2/1/1 3/1/1')):
        seeds['obj'][label] = f'# rich\n{square}f {face}\n'.encode()
    seeds['pipeline_raw']['two'] = raw(TETRAHEDRON[0] + tube(5, 3)[0], TETRAHEDRON[1] + [tuple(i + 4 for i in f) for f in tube(5, 3)[1]])
    for sides, rings in ((4, 3), (6, 4), (8, 6)):
        mesh = tube(sides, rings)
        seeds['pipeline'][f'tube{sides}'] = obj(*mesh)
        seeds['pipeline'][f'torn{sides}'] = obj(mesh[0], mesh[1][:-3] + mesh[1][:2])
        seeds['pipeline_raw'][f'tube{sides}'] = raw(*mesh)
    texts = scenes()
    seeds['scene'] = {name: text.encode() for name, text in texts.items()}
    seeds['scene']['layers'] = PART.format(next(iter(texts.values()))).encode()
    seeds['sweep'] = {'all': SWEEP.encode()}
    seeds['web'], seeds['label'] = pages(), labels()
    for target, files in seeds.items():
        folder = pathlib.Path(sys.argv[1]) / target
        folder.mkdir(parents=True, exist_ok=True)
        for label, data in files.items():
            (folder / label).write_bytes(data)
    (pathlib.Path(sys.argv[1]) / 'scene.dict').write_text(words_of([*texts.values(), SWEEP]))


if __name__ == '__main__':
    main()
