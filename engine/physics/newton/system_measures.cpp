// Measures of a system's residuals and moves, and questions to all its wires in turn.
#include "newton/system_problem.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

void SystemProblem::ask(const ForceTerms& terms)
{
    for (WireProblem* wire : solved_) wire->terms = terms.answer(wire->wire, Ask::Trial);
}

bool SystemProblem::admissible() const
{
    return std::all_of(solved_.begin(), solved_.end(), [](const WireProblem* wire) { return wire->terms.admissible; });
}

double SystemProblem::open() const
{
    double open = 1;
    for (const WireProblem* wire : solved_) open = std::min(open, wire->terms.open);
    return open;
}

double SystemProblem::largest_force() const
{
    double most = 0;
    for (const WireProblem* wire : solved_) most = std::max(most, wire->terms.largest_force);
    return most;
}

void SystemProblem::note_residuals()
{
    for (WireProblem* wire : solved_) {
        wire->norm = wire->residual_norm();
        wire->rounding = wire->terms.rounding;
        wire->rounding_most = wire->terms.rounding_most;
    }
    for (const CoaxialProblem* group : solved_coaxial_) group->fold_rounding();
}

bool SystemProblem::balanced() const
{
    return std::all_of(solved_.begin(), solved_.end(),
                       [](const WireProblem* wire) { return wire->norm <= wire->tolerance + wire->rounding_most; });
}

bool SystemProblem::may_improve() const
{
    return std::any_of(solved_.begin(), solved_.end(),
                       [](const WireProblem* wire) { return wire->norm > wire->tolerance + wire->rounding; });
}

double SystemProblem::residual_share() const
{
    double share = 0;
    for (const WireProblem* wire : solved_) share = std::max(share, wire->norm / (wire->tolerance + wire->rounding_most));
    return share;
}

bool SystemProblem::residual_below(double share) const
{
    return std::all_of(solved_.begin(), solved_.end(),
                       [&](const WireProblem* wire) { return wire->residual_norm() <= share * wire->tolerance; });
}

double SystemProblem::norm(std::span<const double> d) const
{
    double squares = 0;
    for (const WireProblem* wire : solved_) squares += wire->squared_norm(of_wire(*wire, d));
    return std::sqrt(squares);
}

double SystemProblem::largest_move(std::span<const double> d) const
{
    double largest = 0;
    for (const WireProblem* wire : solved_) largest = std::max(largest, wire->largest_move(of_wire(*wire, d)));
    return largest;
}

double SystemProblem::largest_surface_move(std::span<const double> d) const
{
    double largest = 0;
    for (const WireProblem* wire : solved_) largest = std::max(largest, wire->largest_surface_move(of_wire(*wire, d)));
    return largest;
}

double SystemProblem::largest_turn(std::span<const double> d) const
{
    double largest = 0;
    for (const WireProblem* wire : solved_) largest = std::max(largest, wire->largest_turn(of_wire(*wire, d)));
    return largest;
}

double SystemProblem::smallest_radius() const
{
    double least = solved_.front()->smallest_radius();
    for (const WireProblem* wire : solved_) least = std::min(least, wire->smallest_radius());
    return least;
}

double SystemProblem::length_scale() const
{
    double least = solved_.front()->length_scale;
    for (const WireProblem* wire : solved_) least = std::min(least, wire->length_scale);
    return least;
}

double SystemProblem::residual_along(std::span<const double> d) const
{
    double sum = 0;
    for (int i = 0; i < size(); ++i)
        if (!prescribed[i]) sum += residual[i] * d[i];
    return sum;
}

bool SystemProblem::at_prescribed() const
{
    for (int i = 0; i < size(); ++i)
        if (prescribed[i] && trial[i] != prescribed_value[i]) return false;
    return true;
}

void SystemProblem::set_prescribed()
{
    for (int i = 0; i < size(); ++i)
        if (prescribed[i]) trial[i] = prescribed_value[i];
}

// ---- tensions and references of all wires -----------------------------------------------------------------------------------

void SystemProblem::set_base()
{
    for (WireProblem* wire : solved_) wire->tension.set_base(wire->stretch());
}

void SystemProblem::predict_tension(std::span<const double> d, double alpha)
{
    for (WireProblem* wire : solved_) wire->tension.predict(wire->stretch(), of_wire(*wire, d), alpha);
}

void SystemProblem::correct_tension(std::span<const double> correction)
{
    for (WireProblem* wire : solved_) wire->tension.correct(wire->stretch(), of_wire(*wire, correction));
}

void SystemProblem::mixed_residual(std::span<double> out) const
{
    std::copy_n(residual.begin(), size(), out.begin());
    for (const WireProblem* wire : solved_) {
        const std::size_t first = static_cast<std::size_t>(first_of(*wire));
        wire->tension.change_residual(wire->stretch(), out.subspan(first, static_cast<std::size_t>(wire->size())));
    }
}

void SystemProblem::take_linear_tensions()
{
    for (WireProblem* wire : solved_)
        wire->base_tension_excess = wire->tension.take_linear(wire->stretch(), wire->q.residual);
}

bool SystemProblem::far_from_reference() const
{
    return std::any_of(solved_.begin(), solved_.end(), [](const WireProblem* wire) { return wire->far_from_reference(); });
}

void SystemProblem::move_reference()
{
    for (WireProblem* wire : solved_) wire->move_reference();
}

void SystemProblem::keep_reference()
{
    for (WireProblem* wire : solved_) wire->keep_reference();
}

void SystemProblem::restore_reference()
{
    for (WireProblem* wire : solved_) wire->restore_reference();
}

void SystemProblem::return_to_start() { std::copy_n(start.begin(), size(), trial.begin()); }

}  // namespace seldinger
