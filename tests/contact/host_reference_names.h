// What the cases of kernels against their host twins call by short names; `seldinger` may be another namespace here.
#pragma once

namespace seldinger {}  // whichever it is

namespace {

using namespace seldinger;
using sel_device::Queue;
using sel_reference::first_difference;
using sel_reference::Guarded;

#ifdef SEL_FLOAT32
constexpr bool float32 = true;
#else
constexpr bool float32 = false;
#endif

}  // namespace
