#pragma once
// One tetrahedron (edges 1, 2, 3 along the axes), written by VTK 9 in the encodings that .vtp allows; range hints removed.

namespace seldinger {

struct VtpSample {
    const char *name, *text;
};

inline const VtpSample kVtpSamples[] = {
    {"ascii", R"VTP(<?xml version="1.0"?>
<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian" header_type="UInt32">
<PolyData>
<Piece NumberOfPoints="4" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="4">
<PointData>
</PointData>
<CellData>
</CellData>
<Points>
<DataArray type="Float64" Name="Points" NumberOfComponents="3" format="ascii">
0 0 0 1 0 0
0 2 0 0 0 3
</DataArray>
</Points>
<Polys>
<DataArray type="Int64" Name="connectivity" format="ascii">
0 2 1 0 1 3
1 2 3 0 3 2
</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">
3 6 9 12
</DataArray>
</Polys>
</Piece>
</PolyData>
</VTKFile>
)VTP"},
    {"inline_base64", R"VTP(<?xml version="1.0"?>
<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian" header_type="UInt32">
<PolyData>
<Piece NumberOfPoints="4" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="4">
<PointData>
</PointData>
<CellData>
</CellData>
<Points>
<DataArray type="Float64" Name="Points" NumberOfComponents="3" format="binary">
YAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAPA/AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAEAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAIQA==
</DataArray>
</Points>
<Polys>
<DataArray type="Int64" Name="connectivity" format="binary">
YAAAAAAAAAAAAAAAAgAAAAAAAAABAAAAAAAAAAAAAAAAAAAAAQAAAAAAAAADAAAAAAAAAAEAAAAAAAAAAgAAAAAAAAADAAAAAAAAAAAAAAAAAAAAAwAAAAAAAAACAAAAAAAAAA==
</DataArray>
<DataArray type="Int64" Name="offsets" format="binary">
IAAAAAMAAAAAAAAABgAAAAAAAAAJAAAAAAAAAAwAAAAAAAAA
</DataArray>
</Polys>
</Piece>
</PolyData>
</VTKFile>
)VTP"},
    {"inline_zlib", R"VTP(<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">
<PolyData>
<Piece NumberOfPoints="4" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="4">
<PointData>
</PointData>
<CellData>
</CellData>
<Points>
<DataArray type="Float64" Name="Points" NumberOfComponents="3" format="binary">
AQAAAAAAAAAAgAAAAAAAAGAAAAAAAAAAFwAAAAAAAAA=eF5jYMAHPtjjlWZgcMAvzeEAAFbPAbg=
</DataArray>
</Points>
<Polys>
<DataArray type="Int64" Name="connectivity" format="binary">
AQAAAAAAAAAAgAAAAAAAAGAAAAAAAAAAHwAAAAAAAAA=eF5jYIAAJijNyIAKYHxmND5MPUwcBmB8mDwAA2gAEw==
</DataArray>
<DataArray type="Int64" Name="offsets" format="binary">
AQAAAAAAAAAAgAAAAAAAACAAAAAAAAAAEwAAAAAAAAA=eF5jZoAANijNCaV5oDQAAgAAHw==
</DataArray>
</Polys>
</Piece>
</PolyData>
</VTKFile>
)VTP"},
    {"appended_base64_zlib", R"VTP(<?xml version="1.0"?>
<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian" header_type="UInt32" compressor="vtkZLibDataCompressor">
<PolyData>
<Piece NumberOfPoints="4" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="4" >
<PointData>
</PointData>
<CellData>
</CellData>
<Points>
<DataArray type="Float64" Name="Points" NumberOfComponents="3" format="appended" offset="0" >
</DataArray>
</Points>
<Verts>
<DataArray type="Int64" Name="connectivity" format="appended" offset="56" />
<DataArray type="Int64" Name="offsets" format="appended" offset="72" />
</Verts>
<Lines>
<DataArray type="Int64" Name="connectivity" format="appended" offset="88" />
<DataArray type="Int64" Name="offsets" format="appended" offset="104" />
</Lines>
<Strips>
<DataArray type="Int64" Name="connectivity" format="appended" offset="120" />
<DataArray type="Int64" Name="offsets" format="appended" offset="136" />
</Strips>
<Polys>
<DataArray type="Int64" Name="connectivity" format="appended" offset="152" />
<DataArray type="Int64" Name="offsets" format="appended" offset="220" />
</Polys>
</Piece>
</PolyData>
<AppendedData encoding="base64">
_AQAAAACAAABgAAAAFwAAAA==eF5jYMAHPtjjlWZgcMAvzeEAAFbPAbg=AAAAAACAAAAAAAAAAAAAAACAAAAAAAAAAAAAAACAAAAAAAAAAAAAAACAAAAAAAAAAAAAAACAAAAAAAAAAAAAAACAAAAAAAAAAQAAAACAAABgAAAAHwAAAA==eF5jYIAAJijNyIAKYHxmND5MPUwcBmB8mDwAA2gAEw==AQAAAACAAAAgAAAAEwAAAA==eF5jZoAANijNCaV5oDQAAgAAHw==
</AppendedData>
</VTKFile>
)VTP"},
    {"appended_base64", R"VTP(<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<PolyData>
<Piece NumberOfPoints="4" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="4" >
<PointData>
</PointData>
<CellData>
</CellData>
<Points>
<DataArray type="Float64" Name="Points" NumberOfComponents="3" format="appended" offset="0" >
</DataArray>
</Points>
<Verts>
<DataArray type="Int64" Name="connectivity" format="appended" offset="140" />
<DataArray type="Int64" Name="offsets" format="appended" offset="152" />
</Verts>
<Lines>
<DataArray type="Int64" Name="connectivity" format="appended" offset="164" />
<DataArray type="Int64" Name="offsets" format="appended" offset="176" />
</Lines>
<Strips>
<DataArray type="Int64" Name="connectivity" format="appended" offset="188" />
<DataArray type="Int64" Name="offsets" format="appended" offset="200" />
</Strips>
<Polys>
<DataArray type="Int64" Name="connectivity" format="appended" offset="212" />
<DataArray type="Int64" Name="offsets" format="appended" offset="352" />
</Polys>
</Piece>
</PolyData>
<AppendedData encoding="base64">
_YAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAADwPwAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAABAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAACEA=AAAAAAAAAAA=AAAAAAAAAAA=AAAAAAAAAAA=AAAAAAAAAAA=AAAAAAAAAAA=AAAAAAAAAAA=YAAAAAAAAAAAAAAAAAAAAAIAAAAAAAAAAQAAAAAAAAAAAAAAAAAAAAEAAAAAAAAAAwAAAAAAAAABAAAAAAAAAAIAAAAAAAAAAwAAAAAAAAAAAAAAAAAAAAMAAAAAAAAAAgAAAAAAAAA=IAAAAAAAAAADAAAAAAAAAAYAAAAAAAAACQAAAAAAAAAMAAAAAAAAAA==
</AppendedData>
</VTKFile>
)VTP"},
};

}  // namespace seldinger
