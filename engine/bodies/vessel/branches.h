#pragma once
// The branches of a vessel, one numbering for tasks, tables, Python and pages.
//
// Ends are numbered: a branch with a number is the part behind the last fork on the path from the root to an end of the
// centreline. Numbers count from 1 in the order in which these branches leave on that path; the end of the trunk (the longest
// path) counts last.
//
// Every stretch between two forks has a path, too: "0" is the trunk before its first branch, "1", "2" ... leave it in that order,
// "2.1" leaves branch 2. A trunk goes on past a branch that is clearly narrower: "1+" is the trunk between branches 1 and 2,
// "2.1+" branch 2 behind its first one. At a fork of like widths it ends, and both are branches. Behind its last branch a
// vessel's own end is the last of them. Where no branch has branches, paths and numbers agree.
//
// A point belongs to a stretch from its mouth on, where it has left the lumen's ball about its fork; before that it is in the
// vessel that the stretch leaves.

#include "vessel/centreline.h"

#include <string>
#include <string_view>
#include <vector>

namespace seldinger {

/// From one fork, or a root, to the next, or an end.
struct Stretch {
    std::string path, name;   // name: as a file calls it; may be empty
    int number = 0;           // of its end, from 1; 0: it ends in a fork
    int from = -1;            // the stretch that it leaves; -1: none
    double mouth = 0;         // arc length from the root [m]
    std::vector<int> points;  // behind the fork, outwards: indices into the centreline. Never empty
    /// "branch 2", "branch \"2.1\" (end 3)", "the trunk past branch 1": how messages call it.
    [[nodiscard]] std::string words() const;
};

class Branches {
public:
    Branches() = default;
    /// @param root  point of the line that they count from; -1: its own root
    explicit Branches(Centreline line, int root = -1);

    [[nodiscard]] const Centreline& line() const { return line_; }
    [[nodiscard]] int count() const { return static_cast<int>(numbered_.size()); }
    [[nodiscard]] const std::vector<Stretch>& stretches() const { return stretches_; }
    [[nodiscard]] const Stretch& stretch(int index) const { return stretches_[static_cast<std::size_t>(index)]; }
    /// Index of the stretch of branch `number`, from 1.
    [[nodiscard]] int numbered(int number) const { return numbered_[static_cast<std::size_t>(number - 1)]; }
    /// Index of the stretch with this path or name; -1: none. A name that several have is the first's, as seen from the root.
    [[nodiscard]] int find(std::string_view path_or_name) const;
    /// Points of branch `number` (from 1).
    [[nodiscard]] const std::vector<int>& points(int number) const { return stretch(numbered(number)).points; }
    /// Arc length of a point along the centreline from its root [m].
    [[nodiscard]] double from_root(int point) const { return from_root_[static_cast<std::size_t>(point)]; }
    /// How far a point lies behind the mouth of a stretch, < 0 before it [m].
    [[nodiscard]] double depth(int index, int point) const { return from_root(point) - stretch(index).mouth; }

    struct Place {
        int branch = 0;    // number, from 1; 0: in a stretch that ends in a fork, or no centreline
        double depth = 0;  // of the nearest point of the axis behind the mouth of that stretch, along it [m]
        int stretch = -1;  // index; -1: no centreline
    };
    [[nodiscard]] Place locate(const Vec3& p) const;
    /// Path of a place; empty: no centreline.
    [[nodiscard]] std::string path(const Place& place) const { return place.stretch < 0 ? "" : stretch(place.stretch).path; }

private:
    void cut_at_forks();
    void number_ends();
    void find_mouths();
    void take_names();
    void name_paths();
    int name_vessel(int stretch, const std::string& path, int level);
    [[nodiscard]] double width(int stretch) const;

    Centreline line_;
    std::vector<Stretch> stretches_;
    std::vector<std::vector<int>> leaving_;  // [stretches] those that leave each one's end
    std::vector<int> numbered_;
    std::vector<double> reach_;   // [stretches] arc length from the root to the farthest end behind it [m]
    std::vector<int> first_end_, last_end_;  // [stretches] lowest and highest number of an end behind it
    std::vector<double> from_root_;  // [P]
    std::vector<int> stretch_of_;    // [P] that the point belongs to
};

/// The end of the centreline that an inlet lies at; -1: its root, or none.
[[nodiscard]] int end_at(const Centreline& line, const Vec3& inlet);

}  // namespace seldinger
