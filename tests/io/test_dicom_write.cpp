// A DICOM file read back element by element: angles of the C-arm, distances, frames, grey values.
#include "io/dicom_write.h"

#include "support/approx.h"

#include <cstring>
#include <map>
#include <string>

namespace seldinger::test::test_dicom_write {

namespace {

/// Values by tag, explicit VR little endian [PS3.5, 7.1.2].
std::map<std::uint32_t, std::string> elements_of(const std::string& file)
{
    std::map<std::uint32_t, std::string> found;
    REQUIRE(file.size() > 132);
    REQUIRE(file.substr(128, 4) == "DICM");
    std::size_t at = 132;
    const auto number = [&](int bytes) {
        std::uint32_t value = 0;
        REQUIRE(at + static_cast<std::size_t>(bytes) <= file.size());
        for (int k = 0; k < bytes; ++k) value |= static_cast<std::uint32_t>(static_cast<unsigned char>(file[at++])) << (8 * k);
        return value;
    };
    while (at < file.size()) {
        const std::uint32_t group = number(2), element = number(2);
        const std::string vr = file.substr(at, 2);
        at += 2;
        const bool wide = vr == "OB" || vr == "OW";
        if (wide) CHECK(number(2) == 0);
        const std::uint32_t length = number(wide ? 4 : 2);
        REQUIRE(at + length <= file.size());
        CHECK(length % 2 == 0);
        found[group << 16 | element] = file.substr(at, length);
        at += length;
    }
    return found;
}

AngiographicImage image(std::vector<double> primary, std::vector<double> secondary)
{
    AngiographicImage made;
    made.columns = 3, made.rows = 2;
    for (std::size_t k = 0; k < 6 * primary.size(); ++k) made.grey.push_back(static_cast<std::uint16_t>(700 * k % 4096));
    made.primary = std::move(primary);
    made.secondary = std::move(secondary);
    made.sid = 1.1, made.sod = 0.75, made.pixel = 0.0004, made.kvp = 80, made.frame_time = 1 / 15.0;
    return made;
}

double decimal(const std::map<std::uint32_t, std::string>& of, std::uint32_t tag)
{
    REQUIRE(of.count(tag) == 1);
    return std::stod(of.at(tag));
}

/// Numbers between backslashes.
std::vector<double> decimals(const std::string& text)
{
    std::vector<double> found;
    for (std::size_t at = 0; at <= text.size(); at = std::min(text.find('\\', at), text.size()) + 1)
        found.push_back(std::stod(text.substr(at)));
    return found;
}

}  // namespace

TEST_SUITE("io/dicom_write")
{
    // [PS3.3, C.8.7.5.1.2]: the primary angle is positive towards the patient's left (LAO), the secondary one towards the head
    // (CRA). Distances and the pitch are in millimetres.
    TEST_CASE("property: angles keep their signs, LAO and CRA positive, and distances are in millimetres")
    {
        for (const double cranial : {25.0, -25.0}) {
            const auto read = elements_of(dicom_file(image({-30}, {cranial})));
            CHECK(decimal(read, 0x00181510) == about(-30).epsilon(1e-9));
            CHECK(decimal(read, 0x00181511) == about(cranial).epsilon(1e-9));
            CHECK(read.at(0x00181500) == "STATIC");
            CHECK(decimal(read, 0x00181110) == about(1100).epsilon(1e-9));
            CHECK(decimal(read, 0x00181111) == about(750).epsilon(1e-9));
            CHECK(decimal(read, 0x00181114) == about(1100.0 / 750).epsilon(1e-9));
            CHECK(decimal(read, 0x00180060) == about(80).epsilon(1e-9));
            for (const double pitch : decimals(read.at(0x00181164))) CHECK(pitch == about(0.4).epsilon(1e-9));
        }
    }

    TEST_CASE("property: a turning C-arm says the first frame's angles, and each frame's from there")
    {
        const auto read = elements_of(dicom_file(image({10, 12, 15}, {-5, -8, -5})));
        CHECK(read.at(0x00181500) == "DYNAMIC ");
        CHECK(decimal(read, 0x00181510) == about(10).epsilon(1e-9));
        CHECK(decimal(read, 0x00181511) == about(-5).epsilon(1e-9));
        CHECK(decimals(read.at(0x00181520)) == std::vector<double>{0, 2, 5});
        CHECK(decimals(read.at(0x00181521)) == std::vector<double>{0, -3, 0});
        CHECK(decimal(read, 0x00280008) == 3);
        CHECK(decimal(read, 0x00181063) == about(1000 / 15.0).epsilon(1e-9));
    }

    TEST_CASE("property: rows, columns and grey values are those of the picture")
    {
        const AngiographicImage made = image({0, 0}, {0, 0});
        const auto read = elements_of(dicom_file(made));
        const auto two = [](const std::string& bytes, std::size_t k) {
            return static_cast<unsigned char>(bytes[2 * k]) + 256 * static_cast<unsigned char>(bytes[2 * k + 1]);
        };
        CHECK(two(read.at(0x00280010), 0) == 2);
        CHECK(two(read.at(0x00280011), 0) == 3);
        const std::string& pixels = read.at(0x7fe00010);
        REQUIRE(pixels.size() == 2 * made.grey.size());
        for (std::size_t k = 0; k < made.grey.size(); ++k) CHECK(two(pixels, k) == made.grey[k]);
    }
}

}  // namespace seldinger::test::test_dicom_write
