#pragma once
// Keeps a driver's compiler quiet, and names the device if the compiler ends the process.

#include <string>

namespace seldinger::device {

/// Number of threads that are inside the compiler or wait for it. For those seconds they respond to nothing else. Any thread.
[[nodiscard]] int compiling_threads();

/// While it lives this thread counts as one of them.
class CompilerBusy {
public:
    CompilerBusy();
    ~CompilerBusy();
    CompilerBusy(const CompilerBusy&) = delete;
    CompilerBusy& operator=(const CompilerBusy&) = delete;
};

/// Around one call of a driver's compiler. What the compiler writes to stderr is kept back: reasons of a failed build are in its
/// log, which our own message quotes. Some compilers call exit() or abort() at code that they do not know. The process then
/// prints `message` with the compiler's last words, and ends with exit code 5. One call at a time: others wait.
class CompilerWatch {
public:
    /// @param message  names device and file, and says what to do
    explicit CompilerWatch(const std::string& message);
    ~CompilerWatch();
    CompilerWatch(const CompilerWatch&) = delete;
    CompilerWatch& operator=(const CompilerWatch&) = delete;

private:
    CompilerBusy busy_;
};

}  // namespace seldinger::device
