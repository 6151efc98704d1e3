#pragma once
// Time of a step by stages.

#include <initializer_list>

namespace seldinger {

/// Times of one step, all systems together [s].
struct StageTimes {
    double detect = 0, evaluate = 0, reduce = 0, wall = 0, solve = 0, adapt = 0;
    [[nodiscard]] double in_all() const { return detect + evaluate + reduce + wall + solve + adapt; }
    StageTimes& operator+=(const StageTimes& other)
    {
        detect += other.detect, evaluate += other.evaluate, reduce += other.reduce;
        wall += other.wall, solve += other.solve, adapt += other.adapt;
        return *this;
    }
    StageTimes& operator-=(const StageTimes& other)
    {
        detect -= other.detect, evaluate -= other.evaluate, reduce -= other.reduce;
        wall -= other.wall, solve -= other.solve, adapt -= other.adapt;
        return *this;
    }
    StageTimes& operator/=(double n)
    {
        for (double* time : {&detect, &evaluate, &reduce, &wall, &solve, &adapt}) *time /= n;
        return *this;
    }
};

}  // namespace seldinger
