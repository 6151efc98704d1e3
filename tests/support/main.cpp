// The test program's main: doctest's, and exit code 77 (ctest: skipped) when every test case that ran said that it cannot run
// here.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "support/skip.h"

#include <cstdio>
#include <map>
#include <mutex>
#include <string>

namespace {

constexpr int all_skipped = 77;  // SKIP_RETURN_CODE in tests/CMakeLists.txt

std::mutex guard;
std::map<std::string, std::string> reasons;  // by test case
std::string running;
unsigned ran = 0;

struct CaseCounter : doctest::IReporter {
    explicit CaseCounter(const doctest::ContextOptions&) {}
    void report_query(const doctest::QueryData&) override {}
    void test_run_start() override {}
    void test_run_end(const doctest::TestRunStats&) override {}
    void test_case_start(const doctest::TestCaseData& test) override
    {
        const std::lock_guard lock(guard);
        running = test.m_name;
        ++ran;
    }
    void test_case_reenter(const doctest::TestCaseData&) override {}
    void test_case_end(const doctest::CurrentTestCaseStats&) override {}
    void test_case_exception(const doctest::TestCaseException&) override {}
    void subcase_start(const doctest::SubcaseSignature&) override {}
    void subcase_end() override {}
    void log_assert(const doctest::AssertData&) override {}
    void log_message(const doctest::MessageData&) override {}
    void test_case_skipped(const doctest::TestCaseData&) override {}
};
REGISTER_LISTENER("case_counter", 1, CaseCounter);

}  // namespace

namespace seldinger::test {

void skip(const std::string& reason)
{
    const std::lock_guard lock(guard);
    reasons.emplace(running, reason);
}

}  // namespace seldinger::test

int main(int argc, char** argv)
{
    doctest::Context context(argc, argv);
    const int result = context.run();
    if (context.shouldExit()) return result;
    for (const auto& [test, reason] : reasons) std::printf("skipped: %s: %s\n", test.c_str(), reason.c_str());
    if (result != 0) return result;
    if (ran == 0) {
        std::fputs("no test case of that name or source file\n", stderr);
        return 1;
    }
    return reasons.size() == ran ? all_skipped : 0;
}
