// Steps of the wall in blocks.
#include "shell/wall_dynamics.h"

#include "core/state_walk.h"
#include "shell/wall_compliance.h"

#include <algorithm>
#include <cmath>
#include <Eigen/QR>
#include <functional>

namespace seldinger {
namespace {

// of the displacement: what may be taken on through a block of block_steps; more through a shorter one
constexpr double small_memory = 0.1;
constexpr double small_excess = 0.03, most_excess = 0.5;  // of large displacements' forces, likewise, and at all
constexpr double missed_excess = 1e-3;                    // of the displacement: by the extrapolation of a block
constexpr std::size_t rounds_kept = 8;                    // of relax()

double largest(const std::vector<double>& list)
{
    double most = 0;
    for (const double x : list) most = std::max(most, std::abs(x));
    return most;
}

}  // namespace

WallDynamics::WallDynamics(const ElasticWall& wall)
    : wall_(wall),
      start_(static_cast<std::size_t>(wall.unknowns())),
      memory_(start_.size()),
      change_(start_.size()),
      pushed_(start_.size()),
      patch_(static_cast<int>(start_.size() / 3)),
      known_(start_.size()),
      known_at_(start_.size() / 3)
{
}

void WallDynamics::forget() const { ++stamp_; }

std::vector<double> WallDynamics::displacement() const
{
    std::vector<double> w(start_);
    if (step_ == 0) return w;
    for (std::size_t i = 0; i < w.size(); ++i)
        w[i] = keep_ * start_[i] + ahead_ * (memory_[i] + (load_.empty() ? 0.0 : load_[i])) + slope_ * change_[i];
    for (std::size_t v = 0; !touched_.empty() && v < w.size() / 3; ++v) add_to(&w[3 * v], answer(static_cast<std::int32_t>(v)));
    return w;
}

Vec3 WallDynamics::answer(std::int32_t vertex) const
{
    if (!answer_begun_) factor_->begin(pushed_, answer_);
    answer_begun_ = true;
    Vec3 w;
    factor_->read(vertex, answer_, w.data());
    return w;
}

/// Contact asks for some three times the vertices that it pushes. A block of the patch takes up to 34 ns where the patch does not
/// fit the cache, an entry of the factor 0.7 ns.
bool WallDynamics::solves_cheaper() const { return touched_.size() * touched_.size() > factor_->entries() / 100; }

bool WallDynamics::begin_step(double h)
{
    forget();
    if (h != h_ || !factor_) return start_block(h);
    if (begins_block(h)) next_block();
    return true;
}

/// A step of another length than the last one.
bool WallDynamics::start_block(double h)
{
    const std::shared_ptr<const WallFactor> factor = wall_.compliance().factor(h);
    if (!factor) return false;
    start_ = displacement();
    h_ = h;
    factor_ = factor;
    patch_.use(factor_);
    s_ = h > 0 ? wall_.memory_split(h).kept : 0;
    load_.assign(wall_.load().begin(), wall_.load().end());
    WallSolveWork scratch;
    if (!load_.empty()) factor_->solve(load_, scratch);
    step_ = 0;
    next_block();
    return true;
}

void WallDynamics::next_block()
{
    const std::int32_t done = step_;
    patch_.trim();
    if (done > 0) start_ = displacement();
    std::vector<double>& y = scratch_;
    y.assign(start_.size(), 0.0);
    farthest_ = std::sqrt(3.0) * largest(start_);
    large_ = wall_.large_for(start_);
    limited_ = false;
    rounds_ = {};
    const bool moved = h_ > 0 && largest(start_) > 0;
    if (moved) wall_.add_memory_force(h_, start_, y);
    const double excess = add_answers(y, moved);
    singly_ = std::max(0, singly_ - done);
    if (large_ && done > 1 && largest_miss(y) > missed_excess * largest(start_)) singly_ = block_steps;
    steps_ = h_ > 0 && singly_ == 0 ? block_steps : 1;
    const auto may_last = [&](std::int32_t steps) {
        const double longer = double(block_steps) / steps;
        if (!moved) return std::abs(wall_.memory_share(h_)) <= longer * small_memory;
        return excess <= longer * small_excess * largest(start_) && largest(y) <= longer * small_memory * largest(start_);
    };
    while (steps_ > 1 && !may_last(steps_)) steps_ = large_ ? steps_ / 2 : 1;
    // at a constant step the memory's change over a block as long that is done is taken on; the first one knows none
    for (std::size_t i = 0; i < y.size(); ++i) {
        change_[i] = steps_ > 1 && done == steps_ ? (y[i] - memory_[i]) / done : 0.0;
        memory_[i] = y[i];
    }
    step_ = 0;
    keep_ = 1;
    ahead_ = slope_ = 0;
    answer_begun_ = false;
    for (const std::int32_t v : touched_) std::fill_n(&pushed_[3 * static_cast<std::size_t>(v)], 3, 0.0);
    touched_.clear();
    forget();
}

/// y = M^-1 (y - r(w0)). @param moved  else y is 0. @return the largest of M^-1 r [m]
double WallDynamics::add_answers(std::vector<double>& y, bool moved)
{
    WallSolveWork scratch;
    if (!large_) {
        if (moved) factor_->solve(y, scratch);
        return 0;
    }
    std::vector<double> excess(y.size(), 0.0);
    wall_.take_excess_force(*large_, start_, excess);
    if (moved) factor_->solve(y, excess, scratch);
    else factor_->solve(excess, scratch);
    const double most = largest(excess), limit = most_excess * largest(start_);
    limited_ = !(most <= limit);
    const double part = limited_ ? limit / most : 1;
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += part * excess[i];
    return most;
}

/// In order of vertices: the sum of now() does not depend on when they were touched first.
void WallDynamics::list_pushes() const
{
    pushes_.clear();
    for (const std::int32_t u : touched_) {
        const Vec3 f = at(pushed_, u);
        pushes_.push_back({patch_.slot(u), {f[0], f[0], f[0], f[1], f[1], f[1], f[2], f[2], f[2]}});
        patch_.provide(pushes_.back().slot);
    }
    pushes_at_ = stamp_;
}

Vec3 WallDynamics::now(std::int32_t vertex) const
{
    if (still_) return Vec3::Zero();
    if (step_ == 0) return at(start_, vertex);
    const std::size_t first = 3 * static_cast<std::size_t>(vertex);
    if (known_at_[static_cast<std::size_t>(vertex)] == stamp_) return Vec3(&known_[first]);
    Vec3 w = keep_ * at(start_, vertex) + ahead_ * (at(memory_, vertex) + at(load_, vertex)) + slope_ * at(change_, vertex);
    if (solves_cheaper()) {
        w += answer(vertex);
    } else {
        if (pushes_at_ != stamp_) list_pushes();
        const int slot = patch_.slot(vertex);
        double by[9] = {};  // per component of the force and of what it moves: nine sums side by side
        for (const SlotPush& push : pushes_) {
            const float* g = patch_.block(push.slot, slot);
            for (int k = 0; k < 9; ++k) by[k] += g[k] * push.force[k];
        }
        for (int r = 0; r < 3; ++r) w[r] += by[r] + by[3 + r] + by[6 + r];
    }
    w.store(&known_[first]);
    known_at_[static_cast<std::size_t>(vertex)] = stamp_;
    return w;
}

Vec3 WallDynamics::free(std::int32_t vertex) const
{
    Vec3 loaded = at(load_, vertex);
    if (still_) return loaded;
    return s_ * now(vertex) + at(memory_, vertex) + double(step_) * at(change_, vertex) + loaded;
}

void WallDynamics::end_step(std::span<const Push> pushed, double farthest)
{
    farthest_ = std::max(farthest_, farthest);
    answer_begun_ = false;
    for (const std::int32_t v : touched_)
        for (int c = 0; c < 3; ++c) pushed_[3 * static_cast<std::size_t>(v) + c] *= s_;
    for (const Push& push : pushed) {
        const auto place = std::lower_bound(touched_.begin(), touched_.end(), push.vertex);
        if (place == touched_.end() || *place != push.vertex) touched_.insert(place, push.vertex);
        add_to(&pushed_[3 * static_cast<std::size_t>(push.vertex)], push.force);
    }
    slope_ = s_ * slope_ + step_;
    keep_ *= s_;
    ahead_ = s_ * ahead_ + 1;
    ++step_;
    still_ = still_ && touched_.empty() && load_.empty();
    if (still_) step_ = 0, keep_ = 1, ahead_ = slope_ = 0;
    forget();
}

double WallDynamics::largest_miss(const std::vector<double>& y) const
{
    double most = 0;
    for (std::size_t i = 0; i < y.size(); ++i) most = std::max(most, std::abs(y[i] - memory_[i] - step_ * change_[i]));
    return most;
}

double WallDynamics::relax(std::span<const Push> pushed)
{
    std::vector<double> w(start_.size(), 0.0), y(w.size(), 0.0);
    for (const Push& push : pushed) add_to(&w[3 * static_cast<std::size_t>(push.vertex)], push.force);
    WallSolveWork scratch;
    factor_->solve(w, scratch);
    for (std::size_t i = 0; i < w.size(); ++i) w[i] += memory_[i] + (load_.empty() ? 0.0 : load_[i]);
    large_ = wall_.large_for(w);
    if (large_) {
        wall_.take_excess_force(*large_, w, y, true);
        factor_->solve(y, scratch);
    }
    for (std::size_t i = 0; i < y.size(); ++i) y[i] -= memory_[i];
    const double most = std::sqrt(3.0) * largest(y);
    std::vector<double> step = y;
    accelerate(step);
    const double change = largest(step), part = change > 0 ? std::min(1.0, 0.3 * largest(w) / change) : 1;  // far from its end
    for (std::size_t i = 0; i < y.size(); ++i) memory_[i] += step[i] *= part;
    rounds_.unmet = std::move(y);
    rounds_.step = std::move(step);
    forget();
    return most;
}

/// Anderson's method [Walker11, doi:10.1137/10078356X]: of the last rounds, the combination that would lack least. A wall that
/// stiffens a lot would swing, one that softens would hardly move. @param step  what y lacks; becomes the change of y
void WallDynamics::accelerate(std::vector<double>& step)
{
    if (rounds_.unmet.empty()) return;
    std::vector<double> change(step);
    for (std::size_t i = 0; i < change.size(); ++i) change[i] -= rounds_.unmet[i];
    rounds_.steps.push_back(std::move(rounds_.step));
    rounds_.changes.push_back(std::move(change));
    if (rounds_.steps.size() > rounds_kept)
        rounds_.steps.erase(rounds_.steps.begin()), rounds_.changes.erase(rounds_.changes.begin());
    const auto size = static_cast<Eigen::Index>(step.size()), kept = static_cast<Eigen::Index>(rounds_.steps.size());
    Eigen::MatrixXd changes(size, kept);
    for (Eigen::Index k = 0; k < kept; ++k)
        changes.col(k) = Eigen::Map<const Eigen::VectorXd>(rounds_.changes[static_cast<std::size_t>(k)].data(), size);
    Eigen::Map<Eigen::VectorXd> to(step.data(), size);
    const Eigen::VectorXd of = changes.colPivHouseholderQr().solve(to);
    to -= changes * of;
    for (Eigen::Index k = 0; k < kept; ++k)
        to -= of[k] * Eigen::Map<const Eigen::VectorXd>(rounds_.steps[static_cast<std::size_t>(k)].data(), size);
}

void WallDynamics::walk_state(StateWalk& walk)
{
    const char* name = "the wall's motion";
    const auto vertices = static_cast<double>(known_at_.size());
    std::uint8_t still = still_;
    walk({name, "", "accept", 0, 1}, still);
    walk({name, "J", "accept"}, work);
    if (walk.reads()) forget_motion();
    still_ = still != 0;
    if (still_) return;
    double numbers[] = {h_, keep_, ahead_, slope_};
    std::int32_t counts[] = {step_, steps_, static_cast<std::int32_t>(touched_.size()), singly_};
    walk({name, "", "accept"}, std::span(numbers));
    walk({name, "", "accept", 0, std::max<double>(block_steps, vertices)}, std::span(counts));
    if (walk.reads()) {
        StateWalk::need(numbers[0] >= 0 && counts[0] <= counts[1] && counts[1] >= 1 && counts[1] <= block_steps &&
                            counts[2] <= vertices && counts[3] <= block_steps && start_block(numbers[0]),
                        name);
        touched_.resize(static_cast<std::size_t>(counts[2]));
    }
    walk({name, "", "accept", 0, vertices - 1}, std::span(touched_));
    if (walk.checks())
        StateWalk::need(std::adjacent_find(touched_.begin(), touched_.end(), std::greater_equal<>()) == touched_.end(), name);
    for (auto* list : {&start_, &memory_, &change_, &pushed_}) walk({name, "m, N", "accept"}, std::span(*list));
    if (!walk.reads()) return;
    answer_begun_ = false;
    farthest_ = std::sqrt(3.0) * largest(start_);
    large_ = wall_.large_for(start_);
    keep_ = numbers[1], ahead_ = numbers[2], slope_ = numbers[3];
    step_ = counts[0], steps_ = counts[1], singly_ = counts[3];
    forget();
}

/// As if it had never been moved.
void WallDynamics::forget_motion()
{
    for (auto* list : {&start_, &memory_, &change_, &pushed_}) std::fill(list->begin(), list->end(), 0.0);
    touched_.clear();
    answer_begun_ = false;
    h_ = -1;
    factor_.reset();
    large_ = nullptr;
    limited_ = false;
    step_ = 0, steps_ = 1, singly_ = 0, keep_ = 1, ahead_ = slope_ = 0;
    forget();
}

}  // namespace seldinger
