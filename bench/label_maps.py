#!/usr/bin/env python3
"""Label maps written by nibabel, pynrrd and SimpleITK, read by `seldinger vessel`: how far the surface's axis is from the tube that
was voxelised, in the smallest voxel's edge, and its radius. usage: label_maps.py build/seldinger. Exit 77 without these packages."""
import pathlib
import subprocess
import sys
import tempfile

try:
    import nibabel
    import nrrd
    import numpy as np
    import SimpleITK
except ImportError as missing:
    print(f'skipped: {missing}; pip install nibabel pynrrd SimpleITK numpy')
    sys.exit(77)

CENTRE, RADIUS = np.array([31.0, -47.0, 120.0]), 4.5  # [mm], LPS
AXIS = np.array([0.3, 0.45, 0.84]) / np.linalg.norm([0.3, 0.45, 0.84])
RAS, LAS = np.diag([-1.0, -1, 1]), np.diag([1.0, -1, 1])


def turned(axis, degrees):
    c, s, m = np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), np.eye(3)
    i, j = [k for k in range(3) if k != axis]
    m[i, i], m[i, j], m[j, i], m[j, j] = c, -s, s, c
    return m


def from_axis(points):
    off = points - CENTRE
    return off - (off @ AXIS)[..., None] * AXIS


def files(folder, steps, spacing, sheared):
    """The name of each file that is written, with its writer."""
    shape = np.array([90, 90, 40] if spacing[2] > 1 else [60, 60, 60])
    origin = CENTRE - steps @ ((shape - 1) / 2) + [0.13, -0.21, 0.17]
    index = np.stack(np.meshgrid(*map(np.arange, shape), indexing='ij'), -1)
    label = 5 * (np.linalg.norm(from_axis(index @ steps.T + origin), axis=-1) < RADIUS).astype(np.uint8)
    affine = np.eye(4)
    affine[:3, :3], affine[:3, 3] = RAS @ steps, RAS @ origin
    for kind, end in (('u1', 'nii.gz'), ('<i2', 'nii'), ('>i2', 'nii'), ('<f8', 'nii.gz')):
        image = nibabel.Nifti1Image(label.astype(kind), affine, nibabel.Nifti1Header(endianness='>' if kind[0] == '>' else '<'))
        image.header.set_data_dtype(kind)
        nibabel.save(image, folder / f'nibabel-{kind[-2:]}{"-big" * (kind[0] == ">")}.{end}')
    nibabel.save(nibabel.Nifti2Image(label, affine), folder / 'nibabel-version2.nii')
    for name, to in (('left-posterior-superior', np.eye(3)), ('RAS', RAS), ('left-anterior-superior', LAS)):
        for encoding in ('raw', 'gzip', 'ascii'):
            nrrd.write(str(folder / f'pynrrd-{name[:7]}-{encoding}.nrrd'), label, {
                'space': name, 'space directions': (to @ steps).T, 'space origin': to @ origin, 'encoding': encoding})
    nrrd.write(str(folder / 'pynrrd-layers.seg.nrrd'), np.stack([0 * label, label]), {
        'space': 'left-posterior-superior', 'space directions': np.vstack([[np.nan] * 3, steps.T]), 'space origin': origin,
        'kinds': ['list', 'domain', 'domain', 'domain'], 'Segment0_Name': 'other', 'Segment0_Layer': '0', 'Segment0_LabelValue': '5',
        'Segment1_Name': 'aorta', 'Segment1_Layer': '1', 'Segment1_LabelValue': '5'})
    if sheared:  # none of ITK's images is
        return
    nibabel.save(nibabel.Nifti1Image(label, None, quaternion_header(affine)), folder / 'nibabel-quaternion.nii')
    image = SimpleITK.GetImageFromArray(np.ascontiguousarray(label.transpose(2, 1, 0)))
    image.SetOrigin(origin.tolist())
    image.SetSpacing(spacing)
    image.SetDirection((steps / spacing).flatten().tolist())
    for end in ('mha', 'mhd', 'nrrd', 'nii', 'nii.gz'):
        for packed in (False, True):
            SimpleITK.WriteImage(image, str(folder / f'SimpleITK{"-packed" * packed}.{end}'), packed)


def quaternion_header(affine):
    header = nibabel.Nifti1Header()
    header.set_qform(affine, 1)
    header.set_sform(None, 0)
    return header


def surface(program, file, folder):
    label = ['--label', 'aorta'] if file.name.endswith('.seg.nrrd') else []
    subprocess.run([program, 'vessel', file, *label, '-o', folder], check=True, stdout=subprocess.DEVNULL)
    records = np.fromfile(folder / 'vessel.stl', np.dtype([('n', '<3f4'), ('v', '<f4', (3, 3)), ('a', '<u2')]), offset=84)
    return records['v'].astype(float)


def main():
    worst = 0
    print('image                       | files | axis off, voxels | radius, %')
    for name, spacing, left, shear in (('0.5 x 0.5 x 1.5', [0.5, 0.5, 1.5], 1, 0), ('0.5 x 0.5 x 1.5, left-handed', [0.5, 0.5, 1.5], -1, 0),
                                       ('0.8', [0.8] * 3, 1, 0), ('0.5 x 0.5 x 1.5, sheared', [0.5, 0.5, 1.5], 1, 0.15)):
        steps = turned(0, 30) @ turned(1, 30) @ np.diag(spacing)
        steps[:, 0] = left * steps[:, 0] + shear * steps[:, 1]
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            files(folder, steps, spacing, shear)
            rows = []
            for file in sorted(f for f in folder.iterdir() if 'raw' not in f.suffix):
                facets = surface(sys.argv[1], file, folder / 'out')
                facets = facets[np.abs((facets.mean(1) - CENTRE) @ AXIS) < 6]
                area = np.linalg.norm(np.cross(facets[:, 1] - facets[:, 0], facets[:, 2] - facets[:, 0]), axis=1)
                off = from_axis(facets.mean(1))
                middles = from_axis((facets + np.roll(facets, 1, 1)) / 2)
                rows.append((np.linalg.norm(np.average(off, axis=0, weights=area)) / min(spacing),
                             100 * (np.average(np.linalg.norm(middles, axis=-1).mean(1), weights=area) / RADIUS - 1)))
        off, radius = np.array(rows).T
        worst = max(worst, off.max())
        print(f'{name:28}| {len(rows):5} | {off.min():.3f} to {off.max():.3f}   | {radius.min():+.2f} to {radius.max():+.2f}')
    return int(worst > 0.2)


if __name__ == '__main__':
    sys.exit(main())
