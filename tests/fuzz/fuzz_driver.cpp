// One fuzz target as a program of libFuzzer's: SEL_FUZZ_TARGET names it.
#include "fuzz_targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    static const seldinger::fuzz::Target* const target = seldinger::fuzz::find_target(SEL_FUZZ_TARGET);
    target->run(bytes, size);
    return 0;
}
