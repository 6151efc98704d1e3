#pragma once
// A live session: a separate thread steps the world's first system in real time, with input from hands and page.
//
// Physics (this file) takes the newest wishes, steps, publishes; hand_channel.h and web_server.h talk to the outside; a clerk
// writes the record. They meet in triple buffers and a ring: none ever waits for another, and the loop neither locks nor
// allocates.

#include "core/clock.h"
#include "session/byte_ring.h"
#include "session/coupling.h"
#include "session/hand_channel.h"
#include "session/pacer.h"
#include "session/page_wish.h"
#include "session/score.h"
#include "session/session_record.h"
#include "session/snapshot.h"
#include "session/time_histogram.h"

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

namespace seldinger {

struct SessionOptions {
    double rate = 1000;    // steps a second
    double duration = 0;   // session time [s]; 0: until it is stopped
    bool lockstep = false;  // a step for each request of the hand, whenever it comes: the same session on any machine
    double deadline = 0;  // share of the period after which a step ends at the next state that can be (World::cut_when); 0: never
    std::function<bool(std::uint32_t trials)> due;  // in place of the clock: asked before each trial of a step, counted from 1 on
    CouplingSpec advance = advance_coupling, turn = turn_coupling;
    std::filesystem::path record;
};

class Session {
public:
    /// @param setup  of `scene`, loaded   @param hand  may be null   @throws Error: the record, a task that the vessel has not
    Session(const Scene& scene, WorldSetup setup, const SessionOptions& options, HandChannel* hand);
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    void start();
    /// Asks it to end; it does after the step that it is at.
    void stop();
    [[nodiscard]] bool running() const { return running_; }
    /// Waits for its end and closes the record. @throws Error BadFile: the record could not be written
    void finish();

    /// Seconds since the session was made; in lockstep, of session time.
    [[nodiscard]] double clock() const;
    [[nodiscard]] const Scene& scene() const { return scene_; }
    [[nodiscard]] const World& world() const { return *world_; }  // after finish()
    [[nodiscard]] const ScoreNumbers& score() const { return score_; }
    [[nodiscard]] const TaskTarget& target() const { return watch_.target(); }
    [[nodiscard]] const Branches& branches() const { return watch_.branches().of(0); }
    [[nodiscard]] double step_length() const { return dt_; }  // [s]
    [[nodiscard]] int instruments() const { return static_cast<int>(instruments_.size()); }
    /// Summary and score sheet as JSON; after finish().
    [[nodiscard]] std::string summary() const;
    /// Reason why it stopped without a request; empty: it did not.
    [[nodiscard]] const std::string& failure() const { return failure_; }

    TripleBuffer<PageWish> page;   // to the physics
    TripleBuffer<ViewFrame> view;  // from the physics, sixty times a second
    TimeHistogram step_times, wake_times, latencies;
    /// So far; any thread.
    [[nodiscard]] std::uint64_t steps_so_far() const { return steps_; }
    [[nodiscard]] std::uint64_t late_so_far() const { return late_; }
    [[nodiscard]] std::uint64_t cut_short_so_far() const { return cut_short_; }

private:
    struct Instrument {
        Instrument(int of_world, const WireSetup& setup, const SessionOptions& options);
        int wire;              // of the world
        HubSpec hub;           // where a force drives it: that of the coupling
        double start = 0, start_turn = 0, length = 0, twist_stiffness = 0;
        Coupling advance, turn;
        double page_way = 0, page_turn = 0;    // what the page has pushed and turned
        double hand_zero = 0, turn_zero = 0;   // of the hand's port, since the last reset
        HandState hand;                        // at the last step
        double behind = 0, turn_behind = 0;    // what the hub has still to make up for after a hand came back elsewhere
        double arrived = -1;                   // the hand's newest report that was used
        HubLoad load, turn_load;
    };

    static constexpr std::size_t most_attempts = 500;  // kept
    void prepare_record(const SessionOptions& options);
    void run();
    [[nodiscard]] double wait_until_due();
    bool wait_for_hand();
    void take_wishes();
    void step_once();
    [[nodiscard]] bool is_due();
    [[nodiscard]] double room_of(const Instrument& it) const;
    void ask(Instrument& it);
    [[nodiscard]] double follow(double way, double speed, double force, double limit) const;
    [[nodiscard]] double ease(double behind, double speed, double force, double limit) const;
    void take_readings(Instrument& it);
    void note_latency(double now);
    void reset();
    void publish(double now);
    void publish_view();
    void fill(StepNumbers& numbers) const;
    void keep_record();

    const Scene scene_;
    SessionOptions options_;
    double dt_;
    std::unique_ptr<World> world_;
    HandChannel* hand_;
    ScoreWatch watch_;
    ScoreNumbers score_;
    std::vector<ScoreNumbers> attempts_;  // ended by a reset; room for most_attempts, so that a reset allocates nothing
    std::vector<Instrument> instruments_;
    std::vector<std::uint8_t> initial_;  // state
    Control control_;
    Output shape_;
    std::vector<double> hubs_;
    std::vector<std::uint8_t> entry_;
    Pacer pacer_;
    PageWish wish_;
    bool paused_ = false, stopped_ = false, was_late_ = false, was_cut_short_ = false, fluoroscopy_ = false, contrast_ = false;
    std::uint32_t resets_ = 0, trials_ = 0, due_at_ = 0;  // the last two: of the present step; 0: its time is not up
    double step_time_ = 0, next_view_ = 0;
    std::string failure_, scheduling_ = "ordinary";
    Clock::time_point born_ = Clock::now();
    double began_ = 0, ended_ = 0;  // on its clock [s]
    long total_steps_ = 0;          // 0: no end

    std::optional<RecordWriter> writer_;
    ByteRing ring_{1 << 20};
    std::atomic<bool> record_lost_{false}, closing_{false};
    std::string record_error_;
    std::thread physics_, clerk_;
    std::atomic<bool> stop_{false}, running_{false};
    std::atomic<std::uint64_t> steps_{0}, late_{0}, cut_short_{0};
};

}  // namespace seldinger
