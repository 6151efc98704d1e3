// Branches of a centreline: their numbers, their mouths, and the one that a point lies in.
#include "shapes/aortic_arch.h"
#include "support/approx.h"
#include "vessel/branches.h"

namespace seldinger::test::test_branches {

namespace {

/// Points every `step` from the end of `line`, point `from`, along `direction`; the first one's parent is `from`.
int grow(Centreline& line, int from, const Vec3& start, const Vec3& direction, int count, double radius)
{
    for (int k = from < 0 ? 0 : 1; k <= count; ++k) {
        line.points.push_back(start + (0.001 * k) * direction);
        line.radius.push_back(radius);
        line.parent.push_back(from);
        from = static_cast<int>(line.points.size()) - 1;
    }
    return from;
}

/// A trunk along x of 80 mm and radius 5 mm; at 20 mm a branch of 30 mm along y, at 40 mm one along -y that forks 10 mm on.
struct Tree {
    Centreline line;
    Tree()
    {
        grow(line, -1, Vec3::Zero(), Vec3::UnitX(), 80, 0.005);
        grow(line, 20, Vec3(0.02, 0, 0), Vec3::UnitY(), 30, 0.002);
        const int fork = grow(line, 40, Vec3(0.04, 0, 0), -Vec3::UnitY(), 10, 0.002);
        grow(line, fork, Vec3(0.04, -0.01, 0), Vec3::UnitZ(), 10, 0.001);
        grow(line, fork, Vec3(0.04, -0.01, 0), -Vec3::UnitY(), 15, 0.001);
    }
};

}  // namespace

TEST_SUITE("vessel/branches")
{
    TEST_CASE("analytic: branches count in the order in which they leave on the path from the root, the trunk's end last")
    {
        const Tree tree;
        const Branches branches(tree.line);
        REQUIRE(branches.count() == 4);
        const auto end = [&](int number) { return tree.line.points[static_cast<std::size_t>(branches.points(number).back())]; };
        CHECK((end(1) - Vec3(0.02, 0.03, 0)).norm() < 1e-12);
        CHECK((end(2) - Vec3(0.04, -0.01, 0.01)).norm() < 1e-12);  // both leave 50 mm from the root: by the end's index
        CHECK((end(3) - Vec3(0.04, -0.025, 0)).norm() < 1e-12);
        CHECK((end(4) - Vec3(0.08, 0, 0)).norm() < 1e-12);
        CHECK(branches.from_root(branches.points(1).front()) == test::about(0.021));
        CHECK(branches.from_root(branches.points(3).back()) == test::about(0.065));
    }

    TEST_CASE("analytic: a point is in a branch from its mouth on, before it in none, and its depth is that behind the mouth")
    {
        const Tree tree;
        const Branches branches(tree.line);
        const auto at = [&](double x, double y, double z) { return branches.locate(Vec3(x, y, z)); };
        CHECK(at(0.01, 0, 0).branch == 0);    // the trunk before any fork
        CHECK(at(0.03, 0.001, 0).branch == 0);  // between forks: leads to three
        CHECK(at(0.02, 0.004, 0).branch == 0);  // in the trunk's lumen yet
        CHECK(at(0.02, 0.0101, 0.001).branch == 1);
        // the mouth is the first point beyond 5 mm, 6 mm; depths are of the foot on the axis, whatever the spacing of its points
        CHECK(at(0.02, 0.0101, 0.001).depth == test::about(0.0041));
        CHECK(at(0.02, 0.0104, 0.0015).depth == test::about(0.0044));
        CHECK(at(0.02, 0.0106, 0.0015).depth == test::about(0.0046));
        CHECK(at(0.02, 0.0599, 0.001).depth == test::about(0.024));  // past the end: that of the end
        CHECK(at(0.02, 0.0058, 0).depth == 0);  // nearer to the mouth than to the point before it
        CHECK(at(0.04, -0.006, 0).branch == 0);  // behind one fork, before the next
        CHECK(at(0.04, -0.01, 0.008).branch == 2);
        CHECK(at(0.04, -0.02, 0).branch == 3);
        CHECK(at(0.058, 0, 0).branch == 4);
        CHECK(at(0.042, 0, 0).branch == 0);
    }

    TEST_CASE("analytic: a tube has one branch, all of it, and an empty centreline none")
    {
        Centreline tube;
        grow(tube, -1, Vec3::Zero(), Vec3::UnitX(), 20, 0.005);
        const Branches one(tube);
        CHECK(one.count() == 1);
        CHECK(one.locate(Vec3(0.007, 0.001, 0)).branch == 1);
        CHECK(one.locate(Vec3(0.007, 0.001, 0)).depth == test::about(0.007));
        CHECK(Branches(Centreline{}).locate(Vec3::Zero()).branch == 0);
    }

    TEST_CASE("property: the arch's are left subclavian, left carotid, brachiocephalic and the root, as seen from the diaphragm")
    {
        const GeneratedVessel arch = make_aortic_arch(ArchSpec{});
        const Branches branches(arch.centreline);
        REQUIRE(branches.count() == 4);
        // the patient's left is +y here (superior +x, anterior +z): the subclavian's end is farthest there
        const auto end = [&](int number) {
            return arch.centreline.points[static_cast<std::size_t>(branches.points(number).back())];
        };
        const double radius[] = {0.01041 / 2, 0.00828 / 2, 0.0125 / 2};
        for (int number = 1; number <= 3; ++number) {
            CAPTURE(number);
            CHECK(arch.centreline.radius[static_cast<std::size_t>(branches.points(number).back())] ==
                  test::about(radius[number - 1]).epsilon(0.02));
            CHECK(branches.locate(end(number)).branch == number);
        }
        CHECK(branches.locate(end(4)).branch == 4);
    }

    TEST_CASE("analytic: every stretch between forks has a path, and a tip in it is said to be there")
    {
        const Tree tree;
        const Branches branches(tree.line);
        const auto path_at = [&](double x, double y, double z) { return branches.path(branches.locate(Vec3(x, y, z))); };
        CHECK(path_at(0.01, 0, 0) == "0");
        CHECK(path_at(0.02, 0.015, 0) == "1");
        CHECK(path_at(0.03, 0, 0) == "1+");  // a branch of 2 mm leaves a trunk of 5 mm: that goes on
        CHECK(path_at(0.04, -0.0075, 0) == "2");
        CHECK(path_at(0.04, -0.01, 0.008) == "2.1");  // two of 1 mm: both are branches
        CHECK(path_at(0.04, -0.02, 0) == "2.2");
        CHECK(path_at(0.07, 0, 0) == "3");
        CHECK(branches.locate(Vec3(0.04, -0.0075, 0)).depth == test::about(0.0015));  // its mouth is 6 mm from the fork
        // numbers are those of the ends, as before
        CHECK(branches.stretch(branches.find("2.2")).number == 3);
        CHECK(branches.stretch(branches.find("3")).number == 4);
        CHECK(branches.stretch(branches.find("2")).number == 0);
        CHECK(branches.find("2.3") == -1);
        CHECK(branches.find("") == -1);
        CHECK(branches.stretch(branches.find("2.2")).words() == "branch \"2.2\", end 3");
        CHECK(branches.stretch(branches.find("1")).words() == "branch 1");
        CHECK(branches.stretch(branches.find("1+")).words() == "the trunk past branch 1");
    }

    TEST_CASE("analytic: a fork of two like arms has two branches, each with its own")
    {
        Centreline line;
        const int fork = grow(line, -1, Vec3::Zero(), Vec3::UnitX(), 40, 0.004);
        for (const double side : {1.0, -1.0}) {
            const int twigs = grow(line, fork, Vec3(0.04, 0, 0), Vec3(0, side, 0), 50, 0.003);
            for (const double up : {1.0, -1.0})
                grow(line, twigs, Vec3(0.04, 0.05 * side, 0), Vec3(0, 0, up), side > 0 && up > 0 ? 40 : 30, 0.0022);
        }
        const Branches branches(line);
        REQUIRE(branches.count() == 4);
        for (const double side : {1.0, -1.0}) {
            const std::string arm = branches.path(branches.locate(Vec3(0.04, 0.024 * side, 0)));
            CAPTURE(arm);
            CHECK((arm == "1" || arm == "2"));
            for (const double up : {1.0, -1.0}) {
                const std::string twig = branches.path(branches.locate(Vec3(0.04, 0.05 * side, 0.02 * up)));
                CAPTURE(twig);
                CHECK((twig == arm + ".1" || twig == arm + ".2"));
            }
        }
    }

    TEST_CASE("property: from the inlet in use, branches count as the one who pushes meets them")
    {
        const Tree tree;
        CHECK(end_at(tree.line, Vec3(0, 0.001, 0)) == -1);           // at the root
        CHECK(end_at(tree.line, Vec3(0.03, 0, 0)) == -1);            // in mid-lumen: from the root
        const int end = end_at(tree.line, Vec3(0.075, 0, 0.001));  // one radius in from the trunk's end
        REQUIRE(end >= 0);
        CHECK((tree.line.points[static_cast<std::size_t>(end)] - Vec3(0.08, 0, 0)).norm() < 1e-12);
        const Branches branches(tree.line, end);
        REQUIRE(branches.count() == 4);
        const auto at = [&](double x, double y, double z) { return branches.locate(Vec3(x, y, z)); };
        CHECK(at(0.04, -0.01, 0.008).branch == 1);  // at 40 mm from here, the other at 60 mm; both of its own leave at 50 mm
        CHECK(at(0.04, -0.02, 0).branch == 2);
        CHECK(branches.path(at(0.02, 0.015, 0)) == "3");  // 90 mm away: the longest is the trunk
        CHECK(branches.path(at(0.04, -0.0075, 0)) == "1");
        CHECK(branches.path(at(0.07, 0, 0)) == "0");
        CHECK(branches.path(at(0.01, 0, 0)) == "2");      // 80 mm away
        CHECK(branches.line().lengths()[static_cast<std::size_t>(end)] == 0);
    }

    TEST_CASE("property: a stretch has the name that most of its points have, and is found by it")
    {
        Tree tree;
        tree.line.names = {"aorta", "left renal"};
        tree.line.name_of.assign(tree.line.points.size(), -1);
        for (std::size_t i = 0; i <= 80; ++i) tree.line.name_of[i] = 0;
        for (std::size_t i = 81; i <= 110; ++i) tree.line.name_of[i] = i < 84 ? 0 : 1;
        const Branches branches(tree.line);
        CHECK(branches.stretch(branches.find("left renal")).path == "1");
        CHECK(branches.stretch(branches.find("aorta")).path == "0");  // the first of its pieces
        CHECK(branches.stretch(branches.find("1")).words() == "branch 1 (left renal)");
        CHECK(branches.stretch(branches.find("2")).name.empty());
    }
}

}  // namespace seldinger::test::test_branches
