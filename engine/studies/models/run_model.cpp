// Steps one scene under one model from sample to sample, timing the steps alone, and averages forces before each sample.
#include "models/run_model.h"

#include "core/clock.h"
#include "models/run_watch.h"
#include "run/scene_run.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

namespace seldinger {
namespace {

constexpr int samples_by_default = 40;
constexpr long contact_looks = 4;  // contact rows are fetched from the device so often per averaging time

/// Wall and processor time between start() and stop().
class Stopwatch {
public:
    void start() { wall_start_ = Clock::now(), cpu_start_ = cpu_now(); }
    void stop()
    {
        wall_ += seconds_since(wall_start_);
        cpu_ += cpu_now() - cpu_start_;
    }
    [[nodiscard]] double wall() const { return wall_; }
    [[nodiscard]] double cpu() const { return cpu_; }

private:
    static double cpu_now()
    {
        timespec now{};
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
        return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
    }
    Clock::time_point wall_start_{};
    double cpu_start_ = 0, wall_ = 0, cpu_ = 0;
};

/// Means of forces over the steps that end within the averaging time before a sample.
class Averager {
public:
    explicit Averager(double wire_length) : length_(wire_length) {}

    /// @param part  of the step, that lies within the mean
    void add(const Simulation& simulation, bool look_at_contacts, double part = 1)
    {
        const WireReadings now = simulation.readings();
        weight_ += part;
        hand_ += part * now.hand_force, friction_ += part * now.friction, normal_ += part * now.normal;
        if (!look_at_contacts) return;
        ++looks_;
        const std::vector<double> up_to = accumulate_forces(simulation.contact_forces(), length_);
        for (std::size_t k = 0; k < up_to.size(); ++k) up_to_[k] += up_to[k];
    }

    /// Leaves the averager empty.
    void write(Sample& sample)
    {
        const double all = weight_ > 0 ? weight_ : 1;
        sample.hand_force = hand_ / all, sample.friction = friction_ / all, sample.normal = normal_ / all;
        for (double& force : up_to_) force /= std::max(looks_, 1);
        sample.contact_up_to = std::move(up_to_);
        *this = Averager(length_);
    }

private:
    double length_;
    int looks_ = 0;
    double weight_ = 0, hand_ = 0, friction_ = 0, normal_ = 0;
    std::vector<double> up_to_ = std::vector<double>(contact_grid, 0.0);
};

/// One run from the start. Only the steps themselves are timed.
class OneRun {
public:
    OneRun(const StudyScene& scene, const Scene& changed, const RunPlan& plan, std::unique_ptr<Simulation> simulation)
        : plan_(plan),
          simulation_(std::move(simulation)),
          watch_(changed, scene.setup, plan.limits, plan.end_on_blow_up, *simulation_),
          average_(changed.wire.length),
          meter_(plan.average),
          dt_(changed.dt),
          settles_(settles_first(changed)),
          is_static_(changed.integrator.scheme == Scheme::Static),
          touches_(scene.scene.vessel.shape != VesselShape::None)
    {
        result_.trajectory.wire_length = changed.wire.length;
        until_ = plan.until > 0 ? std::min(plan.until, changed.duration) : changed.duration;
        interval_ = plan.interval > 0 ? plan.interval : until_ / samples_by_default;
    }

    ModelRun go()
    {
        if (settles_ && !settle()) return finish();
        if (is_static_) {
            average_.add(*simulation_, touches_);
            take_peaks(1, true);  // one solution
            keep_sample(0);
            result_.complete = true;
            return finish();
        }
        const long samples = std::max(1L, std::lround(until_ / interval_));
        const double length = until_ / static_cast<double>(samples);
        for (long k = 1; k <= samples; ++k) {
            if (plan_.stop && plan_.stop()) {
                result_.stopped = true;
                return finish();
            }
            if (!advance_to_sample(static_cast<double>(k - 1) * length, length)) return finish();
            keep_sample(static_cast<double>(k) * length);
            if (plan_.after_sample && !plan_.after_sample(result_.trajectory.samples.back(), clock_.wall(), clock_.cpu()))
                return finish();
        }
        result_.complete = true;
        return finish();
    }

private:
    bool settle()
    {
        clock_.start();
        const StepReport report = simulation_->settle();
        clock_.stop();
        if (report.failed()) return watch_.after_step(*simulation_, report, 0);
        return true;
    }

    // @return false when the run is over
    bool advance_to_sample(double from, double length)
    {
        const long steps = std::max(1L, static_cast<long>(std::ceil(length / dt_ - 1e-9)));
        const double h = length / static_cast<double>(steps);
        // the first of these steps lies in the mean with a part
        const double in_mean = std::clamp(plan_.average / h, 1.0, static_cast<double>(steps));
        const long averaged = std::lround(std::ceil(in_mean - 1e-9));
        const long every = std::max(1L, averaged / contact_looks);
        for (long k = 1; k <= steps; ++k) {
            clock_.start();
            const StepReport report = simulation_->step(h);
            clock_.stop();
            result_.simulated = from + static_cast<double>(k) * h;
            result_.wall_far_steps += (report.flags & StepWallFar) != 0;
            if (!watch_.after_step(*simulation_, report, result_.simulated)) {
                result_.failed_at = result_.simulated;
                return false;
            }
            if ((plan_.processor_time ? clock_.cpu() : clock_.wall()) > plan_.wall_limit) {
                result_.over_limit = true;
                return false;
            }
            if (plan_.stop_now && plan_.stop_now()) {
                result_.stopped = true;
                return false;
            }
            take_peaks(h, (steps - k) % every == 0);
            if (k <= steps - averaged) continue;
            const double part = k == steps - averaged + 1 ? in_mean - static_cast<double>(averaged - 1) : 1.0;
            average_.add(*simulation_, touches_ && (steps - k) % every == 0, part);
        }
        return true;
    }

    /// @param h  of the step [s]
    void take_peaks(double h, bool look_at_contacts)
    {
        if (!plan_.peaks) return;
        const WireReadings now = simulation_->readings();
        meter_.add(now.hand_force, now.friction, h);
        since_look_ += h;
        if (touches_ && look_at_contacts) meter_.look(simulation_->force_per_length(), std::exchange(since_look_, 0.0));
        result_.trajectory.peaks = meter_.peaks();
    }

    void keep_sample(double t)
    {
        Sample sample;
        const WireReadings now = simulation_->readings();
        sample.t = t;
        sample.inserted = now.inserted;
        sample.shape = simulation_->shape();
        average_.write(sample);
        result_.nodes = std::max(result_.nodes, now.nodes);
        result_.contacts = std::max(result_.contacts, now.contacts);
        result_.wall_move = std::max(result_.wall_move, simulation_->wall_move());
        result_.trajectory.samples.push_back(std::move(sample));
    }

    ModelRun finish()
    {
        result_.verdict = watch_.verdict();
        result_.outcome = result_.verdict.outcome;
        result_.readings = result_.verdict.readings;
        result_.wall_limit = plan_.wall_limit;
        const double per = is_static_ || result_.simulated == 0 ? 1 : result_.simulated;
        const double wall = clock_.wall() / per, cpu = clock_.cpu() / per;
        result_.cost = {wall, wall, wall, cpu, cpu, cpu, 1};
        return std::move(result_);
    }

    const RunPlan& plan_;
    std::unique_ptr<Simulation> simulation_;
    RunWatch watch_;
    Averager average_;
    PeakMeter meter_;
    double since_look_ = 0;  // [s]
    Stopwatch clock_;
    double dt_, until_ = 0, interval_ = 0;
    bool settles_, is_static_, touches_;
    ModelRun result_;
};

Cost cost_of(std::vector<Cost> runs)
{
    std::sort(runs.begin(), runs.end(), [](const Cost& a, const Cost& b) { return a.wall < b.wall; });
    Cost cost = runs[(runs.size() - 1) / 2];
    cost.lowest = runs.front().wall;
    cost.highest = runs.back().wall;
    cost.repeats = static_cast<int>(runs.size());
    std::sort(runs.begin(), runs.end(), [](const Cost& a, const Cost& b) { return a.cpu < b.cpu; });
    cost.cpu = runs[(runs.size() - 1) / 2].cpu;
    cost.cpu_lowest = runs.front().cpu;
    cost.cpu_highest = runs.back().cpu;
    return cost;
}

}  // namespace

ModelRun run_model(const StudyScene& scene, const Model& model, const RunPlan& plan, const std::vector<Baseline>& baselines)
{
    const Scene changed = apply(model, scene.scene);
    ModelRun first = OneRun(scene, changed, plan, make_simulation(scene, model, baselines)).go();
    std::vector<Cost> runs = {first.cost};
    const double of_one = (plan.processor_time ? first.cost.cpu : first.cost.wall) * (first.simulated > 0 ? first.simulated : 1);
    for (int k = 1; k < plan.repeats && first.complete && k * of_one < plan.repeat_wall; ++k) {
        const ModelRun again = OneRun(scene, changed, plan, make_simulation(scene, model, baselines)).go();
        if (again.complete) runs.push_back(again.cost);
        if (again.stopped) break;
    }
    first.cost = cost_of(std::move(runs));
    return first;
}

}  // namespace seldinger
