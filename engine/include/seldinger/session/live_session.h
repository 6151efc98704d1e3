#pragma once
// `seldinger live` for programs: a scene in real time, a device on UDP (session/hand_packet.h), a page. Component `live`.
//
//     seldinger::LiveSession session("training/left-subclavian", {});
//     session.start();                                       // until stop() or its duration
//     session.finish();

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace seldinger {

struct Scene;   // the engine's own
class Session;  // likewise

struct LiveOptions {
    double rate = 1000;     // steps a second
    double duration = 0;    // session time [s]; 0: until stop()
    double deadline = 0;    // share of a period after which a step ends before its equations hold; 0: never
    bool lockstep = false;  // a step for each request of the device, whenever it comes
    double coupling_stiffness = 500, coupling_damping = 1;  // between hand and instrument [N/m], [N s/m]
    std::string hand_address = "127.0.0.1", page_address = "127.0.0.1";
    std::string page_token;                  // secret of the page's address; needed where that is not this machine alone
    int hand_port = 9090, page_port = 8080;  // 0: any that is free; page_port -1: no page
    std::filesystem::path record;  // beside it .scene.toml, and after finish() .summary.json, .score.json, .score.html
    int device = -1;               // of list_devices()
};

class LiveSession {
public:
    /// @param scene  a scene file, or the name of a scene that comes with the program  @param overrides  as of --set
    /// @throws Error BadFile (a port in use, the record), BadScene
    LiveSession(const std::filesystem::path& scene, const LiveOptions& options, const std::vector<std::string>& overrides = {});
    LiveSession(const Scene& scene, const LiveOptions& options);  // the engine's own
    ~LiveSession();
    LiveSession(const LiveSession&) = delete;
    LiveSession& operator=(const LiveSession&) = delete;

    [[nodiscard]] int hand_port() const;
    [[nodiscard]] int page_port() const;  // -1: no page
    void start();
    [[nodiscard]] bool running() const;
    [[nodiscard]] std::uint64_t steps() const;  // so far
    /// Asks it to end; it does after the step that it is at.
    void stop();
    /// Waits for the end and writes the files. @return the summary as JSON (docs/live.md)  @throws Error BadFile
    std::string finish();
    /// After finish(): reason why it ended unasked; empty: it did not.
    [[nodiscard]] std::string failure() const;
    [[nodiscard]] std::string state_hash() const;  // after finish()

    [[nodiscard]] const Session& session() const;  // the engine's own

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace seldinger
