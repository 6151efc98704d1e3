// The same hashes on another OpenCL implementation for the same processor, where the ICD loader finds one beside PoCL.
#include "golden/golden_table.h"

#include "engine.h"
#include "support/skip.h"

#include <doctest/doctest.h>

namespace seldinger::test::test_second_opencl {

TEST_SUITE("golden")
{
    TEST_CASE("golden: another OpenCL implementation gives the bits of the tables")
    {
        int tried = 0;
        for (const DeviceInfo& info : list_devices()) {
            if (info.type != "CPU" || info.platform.find("Portable") != std::string::npos) continue;
            CAPTURE(info.platform);
            test::check_golden_table("choices.txt", info.index);
            test::check_golden_table("worlds.txt", info.index);
            ++tried;
        }
        if (tried == 0)
            test::skip(
                "no OpenCL beside PoCL: pip install intel-opencl-rt intel-cmplr-lib-rt (300 MB), as docs/determinism.md says");
    }
}

}  // namespace seldinger::test::test_second_opencl
