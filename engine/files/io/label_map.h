#pragma once
// Reads label maps: NIfTI (.nii, .nii.gz), NRRD (.nrrd, .seg.nrrd) and MetaImage (.mha, .mhd), as voxels of one label in
// DICOM's axes: LPS, millimetres.
//
// The headers are read here and not by a library. ITK 5.2 reads all three, and is 29 MB beside HDF5, GDCM, MINC and FFTW, which a
// wheel would have to carry. libnifti and teem read one format each. What is left to do is three tables of keys; zlib unpacks.

#include "voxels/voxels.h"

#include <zlib.h>

#include <filesystem>
#include <memory>
#include <string_view>

namespace seldinger {

/// By the name's end.
[[nodiscard]] bool is_label_map(const std::filesystem::path& path);

/// A file's bytes in order, as they are or unpacked.
class ByteStream {
public:
    /// @param packed  gzip or zlib, as the bytes say
    ByteStream(std::string_view bytes, bool packed);
    ~ByteStream();
    ByteStream(const ByteStream&) = delete;
    ByteStream& operator=(const ByteStream&) = delete;
    /// @return how many there were: fewer at the end, or where they do not unpack
    [[nodiscard]] std::size_t read(char* to, std::size_t count);
    /// Whether the packed data end here, and their checksum fits.
    [[nodiscard]] bool ends_well();
    [[nodiscard]] std::uint64_t most() const { return packed_ ? 1032 * left_.size() + 65536 : left_.size(); }  // zlib's best

private:
    std::string_view left_;
    bool packed_, ended_ = false, well_ = true;
    z_stream state_{};
};

struct LabelName {
    double value = 0;
    int layer = 0;
    std::string name;
};

/// What a header says of its voxels.
struct VoxelHeader {
    VoxelGrid grid;         // LPS, mm
    char kind = 'u';        // 'i', 'u' or 'f'; 't': numbers as text
    std::size_t bytes = 1;  // of a number
    bool big_endian = false;
    double slope = 1, intercept = 0;
    int layers = 1;  // numbers of each voxel
    std::vector<LabelName> names;
    std::string note;  // for people
    std::unique_ptr<ByteStream> voxels;
};

// label_headers.cpp. The stream that they hand on is of `bytes`. @throws Error BadFile
[[nodiscard]] VoxelHeader nifti_header(std::string_view bytes, const std::string& name);
[[nodiscard]] VoxelHeader nrrd_header(std::string_view bytes, const std::string& name);
[[nodiscard]] VoxelHeader meta_header(std::string_view bytes, const std::string& name);

/// The bytes of a .mhd with its voxels behind it, as a .mha has them. @throws Error BadFile
[[nodiscard]] std::string with_voxels(std::string header, const std::filesystem::path& path);

/// Voxels of one label, or fractions: probabilities, where 0.5 is the surface.
struct LabelVoxels {
    VoxelGrid grid;
    std::vector<VoxelRun> runs;
    std::vector<float> fractions;    // of every voxel; empty: a label
    std::vector<std::string> notes;  // for people
};

/// @param label  number or name; empty: the only one
/// @throws Error BadFile: damaged, no orientation, no such label, several and none given, an image that is no label map
[[nodiscard]] LabelVoxels read_label(std::string_view bytes, const std::filesystem::path& path, const std::string& label);

}  // namespace seldinger
