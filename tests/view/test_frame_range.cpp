// The rate of a film.
#include "support/approx.h"
#include "view/frame_range.h"

namespace seldinger::test::test_frame_range {

TEST_SUITE("view/frame_range")
{
    TEST_CASE("property: a film plays in real time from 15 to 60 frames a second, faster or slower outside of that, or as asked")
    {
        const auto rate_of = [](double frames_per_second, double asked = 0) {
            RunFolder run;
            for (int k = 0; k < 31; ++k) {
                run.frames.emplace_back();
                run.frames.back().time = k / frames_per_second;
            }
            FrameChoice choice;
            choice.rate = asked;
            return film_rate(choice, run, {0, 30});
        };
        CHECK(rate_of(25) == test::about(25));
        CHECK(rate_of(5) == 15);
        CHECK(rate_of(1000) == 60);
        CHECK(rate_of(5, 5) == 5);
    }
}

}  // namespace seldinger::test::test_frame_range
