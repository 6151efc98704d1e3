#pragma once
// X-ray angiographic pictures as a DICOM file: X-Ray Angiographic Image Storage, multi-frame, explicit VR little endian, 12 bits
// in 16 (PS3.3 A.14, PS3.5 7.1, PS3.10 7). Written by hand: data elements in rising order of tags, lengths even.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace seldinger {

struct AngiographicImage {
    int columns = 0, rows = 0;
    std::vector<std::uint16_t> grey;         // [frames x rows x columns], 0 ... 4095, low is much absorbed
    std::vector<double> primary, secondary;  // of each frame [deg], LAO and CRA positive
    double sid = 0, sod = 0, pixel = 0;      // [m]; pixel: pitch on the detector
    double kvp = 0;                          // [kV]; 0: one energy, not said
    double frame_time = 0;                   // [s]; of a single frame anything
    bool logarithmic = false;                // else grey is proportional to the signal
    bool contrast = false;                   // iodine is in the picture
    std::string description;                 // of the series
    std::string identity;                    // equal texts make equal UIDs
};

/// The file's bytes. The same image makes the same bytes: no date, no random number.
[[nodiscard]] std::string dicom_file(const AngiographicImage& image);

/// Under its name only when it is complete. @throws Error BadFile: a folder, no place to write; more than 4 GiB
void write_dicom(const std::filesystem::path& path, const AngiographicImage& image);

}  // namespace seldinger
