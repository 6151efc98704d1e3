#pragma once
// A `seldinger` that runs while the test does other things to it or beside it.

#include "apps/app_fixture.h"

#include <functional>

namespace seldinger::test {

class BackgroundApp {
public:
    /// @param settings  of the environment, NAME=value
    BackgroundApp(const fs::path& folder, const std::vector<std::string>& arguments,
                  const std::vector<std::string>& settings = {})
        : out_(folder / ".out-background"),
          err_(folder / ".err-background"),
          child_((std::fflush(nullptr), fork()))  // what waits to be printed is printed once
    {
        REQUIRE(child_ >= 0);
        if (child_ != 0) return;
        if (!std::freopen(out_.c_str(), "w", stdout) || !std::freopen(err_.c_str(), "w", stderr) || chdir(folder.c_str()) != 0)
            _exit(126);
        for (const std::string& setting : settings) putenv(const_cast<char*>(setting.c_str()));
        std::vector<char*> argv = {const_cast<char*>(app_path())};
        for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
        argv.push_back(nullptr);
        execv(app_path(), argv.data());
        _exit(127);
    }
    ~BackgroundApp()
    {
        if (running()) send(SIGKILL), (void)result();
    }
    BackgroundApp(const BackgroundApp&) = delete;
    BackgroundApp& operator=(const BackgroundApp&) = delete;

    [[nodiscard]] pid_t pid() const { return child_; }
    [[nodiscard]] bool running()
    {
        if (!ended_) ended_ = waitpid(child_, &status_, WNOHANG) == child_;
        return !ended_;
    }
    void send(int signal) { kill(child_, signal); }

    /// @return whether `holds` came true while it ran
    bool wait_until(const std::function<bool()>& holds)
    {
        while (!holds()) {
            if (!running()) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return running();
    }
    /// Until `file` has more than so many lines.
    bool wait_for_rows(const fs::path& file, long rows)
    {
        return wait_until([&] {
            const std::string text = slurp(file);
            return std::count(text.begin(), text.end(), '\n') > rows;
        });
    }

    /// Waits for its end. @return code: the exit code, or minus the signal that ended it
    AppResult result()
    {
        while (!ended_) ended_ = waitpid(child_, &status_, 0) == child_;
        return app_result(status_, slurp(out_), slurp(err_));
    }

private:
    fs::path out_, err_;
    pid_t child_;
    int status_ = 0;
    bool ended_ = false;
};

}  // namespace seldinger::test
