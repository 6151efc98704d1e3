// One fuzz target as a program of libFuzzer's: SEL_FUZZ_TARGET names it.
#include "fuzz_targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    seldinger::fuzz::SEL_FUZZ_TARGET({bytes, size});
    return 0;
}
