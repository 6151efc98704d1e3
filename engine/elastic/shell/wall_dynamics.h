#pragma once
// The wall's motion from step to step, of one system, at the cost of the touched part.
//
// Backward Euler of C w' + K w = f with K = K_e + K_p + k_s A and C = tau K_e + c_s A is, with M = K + C/h,
//
//     M w1 = C/h w0 + f,    C/h = s M + B,    s = tau/(h + tau),    B = (c_s - tau k_s)/(h + tau) A - s K_p
//     w1 = s w0 + M^-1 B w0 + M^-1 f
//
// Under large displacements the right side has -r(w) too, what linear theory leaves out of the shell's forces
// (shell/large_shell.h), at the start of a block: B w0 becomes B w0 - r(w0), y below. It takes part as slowly as the wall gives
// way, and where the wall rests it is exact. In single steps a mode may be 1 + 2 tau/h times as stiff as in K, 41 times at the
// usual 1 ms, before this explicit part makes it swing. A block of n steps extrapolates r; with x = n h/tau and b = (n - 1)/(2 n)
// it may be 2/(x (1 + 2 b)) times as stiff: 13, 5.7, 2.7 times for 2, 4, 8 steps. r = a K w has M^-1 r = a w/(1 + tau/h): blocks
// of 8 steps are taken up to 3 % of w0 (a = 0.6), of 4 up to 6 % (1.3), of 2 up to 12 % (2.5), so that the tangent may be two to
// five times the secant. A block whose extrapolation has missed M^-1 r at its end by 1e-3 of w0 is followed by single steps. M^-1
// r is limited to half of w0, and steps in which that happens are flagged (is_limited). An equilibrium (h = 0) is found by
// relax(), again and again with r of its last answers.
//
// What tissue and wall relax alike is the first term; M^-1 B w0 is the little by which they differ, a few per cent of w0 that
// change slowly. It is solved for once in a block of `block_steps` steps, and extrapolated linearly in between from the last two
// blocks (an error of the order of the scheme's own). If it exceeds 10 % of w0, it is solved for in every step. Forces of a block
// are summed up, F = sum s^k f, and in between their part M^-1 F is known at any vertex from columns of M^-1 that contact has had
// solved for anyway. So a full solve is needed twice in a block, not twice in a step, and whoever asks only for a few vertices
// pays for these. Where contact touches so much of the wall that these sums read more memory than a solve, each step has its
// solve.

#include "algebra/block_cholesky.h"
#include "shell/elastic_wall.h"
#include "shell/wall_patch.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace seldinger {

class StateWalk;  // core/state_walk.h

class WallDynamics {
public:
    static constexpr int block_steps = 8;

    explicit WallDynamics(const ElasticWall& wall);

    /// The step to come is of h [s]; 0: an equilibrium, whatever the wall was like before. @return false: the wall has none,
    /// because nothing holds it in place or its pressure buckles it; it stays as it is
    bool begin_step(double h);
    /// Its compliance where it is touched, in this step.
    [[nodiscard]] WallPatch& patch() const { return patch_; }
    /// Displacement of a control vertex at the start of the step [m].
    [[nodiscard]] Vec3 now(std::int32_t vertex) const;
    /// Where it would be at the end of the step with no force on it [m].
    [[nodiscard]] Vec3 free(std::int32_t vertex) const;
    /// How far some place of it had gone when that was noted last; elsewhere it may be a little farther [m].
    [[nodiscard]] double farthest() const { return farthest_; }
    /// A force on a control vertex. Part of contact's state, so without gaps between its members.
    struct Push {
        std::int32_t wire;  // of the system's, that exerts it; the wall does not ask
        std::int32_t vertex;
        Vec3 force;  // [N]
    };
    /// The step is over. @param farthest  that it has been seen to go [m]
    void end_step(std::span<const Push> pushed, double farthest = 0);

    /// In an equilibrium, r of where the wall would be under these forces. @return how far that moves free() at most [m]; a
    /// small number ends it
    double relax(std::span<const Push> pushed);
    /// Whether a step is too long for the forces of large displacements.
    [[nodiscard]] bool is_limited() const { return limited_; }
    /// Steps of the block that the last begin_step() was in.
    [[nodiscard]] std::int32_t block_length() const { return steps_; }
    /// The shell that takes part in this block; null: the linear one alone.
    [[nodiscard]] const LargeShell* large() const { return large_; }

    /// All control vertices [3V] [m]; one solve.
    [[nodiscard]] std::vector<double> displacement() const;
    /// Whether it has never been moved.
    [[nodiscard]] bool still() const { return still_; }

    /// Rows of what must survive a step (core/state_walk.h).
    void walk_state(StateWalk& walk);

    double work = 0;  // done on the wall by contact since the beginning [J]

    /// Whether begin_step(h) starts a block, and so changes the state.
    [[nodiscard]] bool begins_block(double h) const { return h != h_ || !factor_ || step_ == steps_; }

private:
    [[nodiscard]] bool start_block(double h);
    void next_block();
    double add_answers(std::vector<double>& y, bool moved);
    /// Of the last block's extrapolation, against y at its end.
    [[nodiscard]] double largest_miss(const std::vector<double>& y) const;
    void accelerate(std::vector<double>& step);
    [[nodiscard]] Vec3 at(const std::vector<double>& list, std::int32_t vertex) const
    {
        return list.empty() ? Vec3(Vec3::Zero()) : Vec3(&list[3 * static_cast<std::size_t>(vertex)]);
    }
    void forget() const;
    void list_pushes() const;
    /// M^-1 F at a vertex.
    [[nodiscard]] Vec3 answer(std::int32_t vertex) const;
    /// Whether that is cheaper than sums over columns of what contact touches.
    [[nodiscard]] bool solves_cheaper() const;
    void forget_motion();

    const ElasticWall& wall_;
    bool still_ = true;
    // the block
    double h_ = -1;
    double s_ = 0, farthest_ = 0;
    std::int32_t step_ = 0, steps_ = 1;        // done, in all
    std::int32_t singly_ = 0;                  // steps to come that are taken one by one
    double keep_ = 1, ahead_ = 0, slope_ = 0;  // w = keep w_0 + ahead (y + load) + slope dy + M^-1 F
    std::vector<double> start_;                // w_0 [3V]
    std::vector<double> memory_, change_;      // y = M^-1 B w_0 and its change per step [3V]
    std::vector<double> pushed_;               // F [3V]
    std::vector<std::int32_t> touched_;        // vertices of F, in order
    // made from these
    std::shared_ptr<const WallFactor> factor_;
    const LargeShell* large_ = nullptr;
    bool limited_ = false;       // of blocks of one step
    /// Of relax(): what y lacked in its last round [3V], and how y and that changed from round to round.
    struct Rounds {
        std::vector<double> unmet, step;
        std::vector<std::vector<double>> steps, changes;
    };
    Rounds rounds_;
    std::vector<double> load_;  // M^-1 times the scene's loads [3V]; empty: none
    mutable WallPatch patch_;
    mutable std::vector<double> known_;            // now() of vertices that were asked for [3V]
    mutable std::vector<std::uint32_t> known_at_;  // [V] stamp
    mutable std::uint32_t stamp_ = 1, pushes_at_ = 0;
    struct SlotPush {
        int slot;
        double force[9];  // each component three times: beside its row of a block
    };
    mutable BlockCholesky::Partial answer_;  // M^-1 F
    mutable bool answer_begun_ = false;
    mutable std::vector<SlotPush> pushes_;  // F by slots of the patch, in order of vertices; of the stamp pushes_at_
    std::vector<double> scratch_;
};

}  // namespace seldinger
