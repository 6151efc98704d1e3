// The physics thread of a live session: wishes in, a step, numbers out.
#include "session/session.h"

#include "core/clock.h"
#include "core/error.h"
#include "record/checkpoint.h"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double view_period = 1.0 / 60;           // [s]
constexpr double shortest_twisted = 0.01;          // length of wire that torque is thought to act on, at least [m]
constexpr double page_force = 6, page_torque = 0.05;  // more, and a page's push goes no further [N], [N m]
// A hand that comes back from a silence may be elsewhere. The hub follows at these speeds [m/s], [rad/s], up to these forces [N],
// [N m].
constexpr double ease_speed = 0.05, ease_turn_speed = 6;
constexpr double ease_force = 1, ease_torque = 0.01;

double wire_mass(const World& world, int wire)
{
    const ConstRodView rod = world.rod(wire);
    double mass = 0;
    for (int i = 0; i < rod.n; ++i) mass += rod.mass[i];
    return mass;
}

/// A thread that others on the same core do not keep waiting, where the system lets it. @return how it is scheduled
const char* hurry()
{
    prctl(PR_SET_TIMERSLACK, 1000);
    const sched_param priority{1};
    return pthread_setschedparam(pthread_self(), SCHED_RR, &priority) == 0 ? "real-time round-robin" : "ordinary";
}

}  // namespace

void Session::stop()
{
    stop_ = true;
    if (hand_) hand_->wake();
}

Session::Instrument::Instrument(int of_world, const WireSetup& setup, const SessionOptions& options)
    : wire(of_world),
      hub(setup.feed.hub),
      start(setup.feed.advance),
      start_turn(setup.feed.turn),
      length(setup.wire.length),
      twist_stiffness(setup.wire.shaft.twist_stiffness),
      advance(options.advance, 1 / options.rate),
      turn(options.turn, 1 / options.rate)
{
}

Session::Session(const Scene& scene, WorldSetup setup, const SessionOptions& options, HandChannel* hand)
    : scene_(scene),
      options_(options),
      dt_(1 / options.rate),
      world_(std::make_unique<World>(std::move(setup))),
      hand_(hand),
      watch_(scene_, *world_, ScoreWatch::Patch::Always),
      pacer_(dt_)
{
    for (const int w : live_instruments(world_->setup()))
        instruments_.emplace_back(w, world_->setup().wires[static_cast<std::size_t>(w)], options);
    if (instruments_.empty())
        throw Error(ErrorKind::BadScene, fmt::format("{}: nothing is fed; a live session needs a [feed]", scene.source.string()));
    if (options.lockstep && hand == nullptr)
        throw Error(ErrorKind::BadScene,
                    "a session in lockstep needs a device that asks for steps; give one, or leave lockstep out");
    total_steps_ = options.duration > 0 ? std::max(1L, std::lround(options.duration * options.rate)) : 0;
    world_->watch_hand_stiffness();
    if (options.deadline > 0 || options.due) world_->cut_when([this] { return is_due(); });
    if (scene.start_settled) {
        const StepReport report = settle(*world_);
        if (report.failed())
            throw Error(ErrorKind::Stopped,
                        fmt::format("{}: no equilibrium was found to start from; try `seldinger run` on the scene",
                                    scene.source.string()));
    }
    initial_ = world_->save_state();
    watch_.begin(*world_, 0, score_);
    for (const Instrument& it : instruments_) {
        if (it.hub.driven()) control_.push(it.wire, 0, it.start_turn);
        else control_.move_to(it.wire, it.start, it.start_turn);
    }
    attempts_.reserve(most_attempts);
    hubs_.resize(2 * static_cast<std::size_t>(world_->wire_count()));
    entry_.reserve(16 + hubs_.size() * sizeof(double));
    shape_.wires.resize(static_cast<std::size_t>(world_->wire_count()));
    for (WireOutput& wire : shape_.wires) {
        for (auto* array : {&wire.material_s, &wire.radius, &wire.curvature, &wire.spin}) array->reserve(most_view_nodes);
        for (auto* array : {&wire.director, &wire.position, &wire.velocity, &wire.contact_force}) array->reserve(most_view_nodes);
    }
    for (int round = 0; round < 3; ++round) {
        for (auto& nodes : view.back().nodes) nodes.reserve(most_view_nodes);
        view.publish();
        view.take();
    }
    if (!options.record.empty()) prepare_record(options);
}

Session::~Session()
{
    stop();
    closing_ = true;
    if (physics_.joinable()) physics_.join();
    if (clerk_.joinable()) clerk_.join();
}

void Session::prepare_record(const SessionOptions& options)
{
    writer_.emplace(options.record, RecordHeader{version(), scene_.name, world_->device_name(), record_hash(scene_),
                                                 hash_of(world_->setup().mesh), dt_, world_->wire_count()});
}

double Session::clock() const
{
    if (options_.lockstep) return static_cast<double>(steps_) * dt_;
    return seconds_since(born_);
}

void Session::start()
{
    running_ = true;
    if (writer_) clerk_ = std::thread([this] { keep_record(); });
    physics_ = std::thread([this] {
        run();
        running_ = false;
    });
}

void Session::run()
{
    scheduling_ = hurry();
    began_ = clock();
    pacer_.start(began_);
    const auto all_done = [&] { return total_steps_ > 0 && static_cast<long>(pacer_.steps()) >= total_steps_; };
    while (!stop_ && !all_done() && !(stopped_ && total_steps_ > 0)) {
        if (options_.lockstep && !wait_for_hand()) break;
        const double woken = options_.lockstep ? clock() : wait_until_due();
        take_wishes();
        if (paused_ || stopped_) {
            pacer_.rest(woken);
            publish(woken);
            continue;
        }
        if (!options_.lockstep) wake_times.add(std::max(0.0, woken - pacer_.due()));
        pacer_.begin(woken);
        const auto before = Clock::now();
        step_once();
        step_time_ = seconds_since(before);
        step_times.add(step_time_);
        was_late_ = pacer_.finished(options_.lockstep ? pacer_.due() : clock());
        steps_ = pacer_.steps();
        const double now = clock();
        late_ = pacer_.late();
        note_latency(now);
        publish(now);
    }
    ended_ = clock();
    next_view_ = 0;
    publish(ended_);
}

/// @return when it woke [s]
double Session::wait_until_due()
{
    const auto due = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(pacer_.due()));
    std::this_thread::sleep_until(born_ + due);
    return clock();
}

/// @return false: the session is to end
bool Session::wait_for_hand()
{
    while (!stop_ && !hand_->input.take()) hand_->wait_for_request();
    return !stop_;
}

void Session::take_wishes()
{
    page.take();
    wish_ = page.front();
    if (hand_ && !options_.lockstep) hand_->input.take();
    std::uint32_t pedals = 0;
    for (const HandState& hand : hand_ ? hand_->input.front().hand : decltype(HandInput::hand){}) pedals |= hand.flags;
    fluoroscopy_ = wish_.fluoroscopy || (pedals & SEL_HAND_FLUOROSCOPY);
    contrast_ = wish_.contrast || (pedals & SEL_HAND_CONTRAST);
    paused_ = wish_.paused;
    if (wish_.resets != resets_) reset();
}

double Session::follow(double way, double speed, double force, double limit) const
{
    const bool pushes_on = force * speed > 0 && std::abs(force) > limit;
    return pushes_on ? way : way + speed * dt_;
}

/// Towards 0, and not beyond.
double Session::ease(double behind, double speed, double force, double limit) const
{
    const double left = follow(behind, behind > 0 ? -speed : speed, force, limit);
    return left * behind > 0 ? left : 0;
}

/// How much of an instrument may be inside: nothing while another one is that it takes turns with.
double Session::room_of(const Instrument& it) const
{
    const auto is_inside = [&](const Instrument& other) {
        const bool asked = !other.hub.driven() && hubs_[2 * static_cast<std::size_t>(other.wire)] > 0;
        return asked || other.start + world_->readings(other.wire).inserted > 0;
    };
    for (const CoaxialSpec& spec : world_->setup().coaxial) {
        const auto takes_turns = [&](int wire) { return std::ranges::find(spec.turns(), wire) != spec.turns().end(); };
        for (const Instrument& other : instruments_)
            if (other.wire != it.wire && takes_turns(it.wire) && takes_turns(other.wire) && is_inside(other)) return 0;
    }
    return it.length;
}

/// Where the hand is, and so where the world is asked to have the hub.
void Session::ask(Instrument& it)
{
    const auto number = static_cast<std::size_t>(&it - instruments_.data());
    if (wish_.instrument == static_cast<int>(number) && clock() < wish_.until) {
        it.page_way = std::clamp(follow(it.page_way, wish_.push, it.advance.force(), page_force), -it.length, it.length);
        it.page_turn = follow(it.page_turn, wish_.turn, it.turn.force(), page_torque);
    }
    const HandState hand = hand_ ? hand_->input.front().hand[number] : HandState{};
    if (hand.returns != it.hand.returns) it.behind += it.hand.advance - hand.advance, it.turn_behind += it.hand.turn - hand.turn;
    it.hand = hand;
    it.behind = ease(it.behind, ease_speed, it.advance.force(), ease_force);
    it.turn_behind = ease(it.turn_behind, ease_turn_speed, it.turn.force(), ease_torque);
    const double to = hand.advance - it.hand_zero + it.behind + it.page_way,
                 turned = hand.turn - it.turn_zero + it.turn_behind + it.page_turn;
    const double endless = 1e9;
    const double turn = it.start_turn + it.turn.next(turned, it.turn_load, -endless, endless);
    double asked = 0;
    if (it.hub.driven()) {
        asked = it.advance.pull(to);
        control_.push(it.wire, asked, turn, spring_of(options_.advance, dt_));
    } else {
        const double room = room_of(it);
        asked = std::clamp(it.start + it.advance.next(to, it.load, -it.start, room - it.start), 0.0, room);
        control_.move_to(it.wire, asked, turn);
    }
    hubs_[2 * static_cast<std::size_t>(it.wire)] = asked;
    hubs_[2 * static_cast<std::size_t>(it.wire) + 1] = turn;
}

/// Whether the step that is being computed has used up its time. A record needs to know when that was told.
bool Session::is_due()
{
    ++trials_;
    if (due_at_ > 0) return true;
    const bool due =
        options_.due ? options_.due(trials_) : !options_.lockstep && clock() >= pacer_.due() + options_.deadline * dt_;
    if (due) due_at_ = trials_;
    return due;
}

void Session::step_once()
{
    trials_ = due_at_ = 0;
    was_cut_short_ = false;
    for (Instrument& it : instruments_) ask(it);
    entry_.clear();
    const auto flags =
        static_cast<std::uint8_t>((fluoroscopy_ ? RecordEntry::fluoroscopy : 0) | (contrast_ ? RecordEntry::contrast : 0));
    put_step(entry_, flags, hubs_.data(), world_->wire_count());
    if (writer_ && !ring_.put(entry_)) record_lost_ = true;
    try {
        const StepReport report = step(*world_, control_, dt_);
        was_cut_short_ = (report.flags & StepCutShort) != 0;
        if (report.failed()) failure_ = fmt::format("step {} found no state; the last good one is shown", pacer_.steps() + 1);
    } catch (const std::exception& error) {
        failure_ = error.what();
    }
    if (was_cut_short_) {
        ++cut_short_;
        entry_.clear();
        put_cut_short(entry_, due_at_);
        if (writer_ && !ring_.put(entry_)) record_lost_ = true;
    }
    stopped_ = !failure_.empty();
    if (stopped_) return;  // the world is where it was before
    for (Instrument& it : instruments_) take_readings(it);
    watch_.stepped(*world_, 0, dt_, fluoroscopy_, contrast_, score_);
}

void Session::take_readings(Instrument& it)
{
    const WireReadings r = world_->readings(it.wire);
    if (it.hub.driven()) it.advance.pulled_to(r.inserted, r.hand_stiffness + (it.hub.mass / dt_ + it.hub.damping) / dt_);
    else it.advance.stepped(r.hand_force);
    it.turn.stepped(r.hand_torque);
    it.load = {r.hand_force, r.hand_stiffness, r.hand_stiffness > 0 ? wire_mass(*world_, it.wire) : 0.0};
    const double inside = std::max(it.start + r.inserted, shortest_twisted);
    it.turn_load = {r.hand_torque, r.hand_stiffness > 0 ? it.twist_stiffness / inside : 0.0, 0.0};
}

/// From a hand's report to the end of the step that was the first to know of it.
void Session::note_latency(double now)
{
    if (!hand_) return;
    for (std::size_t k = 0; k < instruments_.size(); ++k) {
        const HandState& hand = hand_->input.front().hand[k];
        if (!hand.heard || hand.arrived == instruments_[k].arrived) continue;
        instruments_[k].arrived = hand.arrived;
        latencies.add(now - hand.arrived);
    }
}

void Session::reset()
{
    resets_ = wish_.resets;
    world_->restore_state(initial_);
    stopped_ = false;
    failure_.clear();
    entry_.clear();
    put_reset(entry_);
    if (writer_ && !ring_.put(entry_)) record_lost_ = true;
    for (std::size_t k = 0; k < instruments_.size(); ++k) {
        Instrument& it = instruments_[k];
        it.hand = hand_ ? hand_->input.front().hand[k] : HandState{};
        it.hand_zero = it.hand.advance;
        it.turn_zero = it.hand.turn;
        it.page_way = it.page_turn = it.behind = it.turn_behind = 0;
        it.advance.place(0);
        it.turn.place(0);
        it.load = it.turn_load = {};
    }
    if (score_.begun && attempts_.size() < most_attempts) attempts_.push_back(score_);
    watch_.begin(*world_, 0, score_);
}

void Session::fill(StepNumbers& n) const
{
    n.step = pacer_.steps();
    n.time = static_cast<double>(pacer_.steps()) * dt_;
    n.late = pacer_.late();
    n.stretched = pacer_.stretched();
    n.step_time = step_time_;
    n.was_late = was_late_;
    n.cut_short = cut_short_;
    n.was_cut_short = was_cut_short_;
    n.paused = paused_;
    n.stopped = stopped_;
    n.fluoroscopy = fluoroscopy_;
    n.contrast = contrast_;
    n.resets = resets_;
    n.request = hand_ ? hand_->input.front().number : 0;
    n.instruments = instruments();
    n.score = score_;
    for (std::size_t k = 0; k < instruments_.size(); ++k) {
        const Instrument& it = instruments_[k];
        const WireReadings r = world_->readings(it.wire);
        n.instrument[k] = {it.advance.position() + it.advance.stretch(), r.inserted, r.turned,
                           it.advance.force(), it.turn.force(), it.advance.force_per_advance(), r.hand_force,
                           r.normal, static_cast<std::uint32_t>(r.contacts)};
    }
}

void Session::publish(double now)
{
    if (hand_) {
        fill(hand_->newest.back());
        hand_->newest.publish();
    }
    if (now < next_view_) return;
    next_view_ = now + view_period;
    publish_view();
}

void Session::publish_view()
{
    world_->read(shape_, Output::Shape);
    ViewFrame& frame = view.back();
    fill(frame.numbers);
    const Branches::Place place = watch_.branches().tip(*world_, 0);
    frame.numbers.stretch = place.stretch, frame.numbers.branch_depth = place.depth;
    for (std::size_t k = 0; k < instruments_.size(); ++k) {
        const WireOutput& wire = shape_.wires[static_cast<std::size_t>(instruments_[k].wire)];
        std::vector<ViewNode>& nodes = frame.nodes[k];
        nodes.clear();
        const std::size_t every = wire.position.size() / most_view_nodes + 1;
        for (std::size_t i = 0; i < wire.position.size(); i += every) {
            const Vec3& x = wire.position[i];
            nodes.push_back({static_cast<float>(x.x()), static_cast<float>(x.y()), static_cast<float>(x.z()),
                             static_cast<float>(wire.contact_force[i].norm())});
        }
    }
    view.publish();
}

/// The clerk: what the physics has put into the ring goes to the disk, several times a second.
void Session::keep_record()
{
    std::vector<std::uint8_t> entries;
    for (bool last = false; !last;) {
        last = closing_;
        if (!last) std::this_thread::sleep_for(std::chrono::milliseconds(100));
        entries.clear();
        ring_.take(entries);
        try {
            if (record_error_.empty()) writer_->append(entries);
        } catch (const Error& error) {
            record_error_ = error.what();
        }
    }
}

void Session::finish()
{
    if (physics_.joinable()) physics_.join();
    closing_ = true;
    if (clerk_.joinable()) clerk_.join();
    if (!writer_) return;
    if (record_lost_) record_error_ = fmt::format("{}: the disk was too slow, and steps are missing", options_.record.string());
    if (record_error_.empty()) writer_->finish(world_->state_hash());
    else throw Error(ErrorKind::BadFile, record_error_);
}

}  // namespace seldinger
