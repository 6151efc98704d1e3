#pragma once
// The session's web server in a separate thread: the page over HTTP, frames and wishes over a WebSocket. Clients that are slow
// lose frames, clients that are wrong lose the connection; the physics notices neither.

#include <cstdint>
#include <memory>
#include <string>

namespace seldinger {

class Session;
struct Scene;

struct WebOptions {
    std::string address = "127.0.0.1", token;
    int port = 8080;  // 0: any that is free
};

/// Counts of bytes and connections.
struct WebCounts {
    std::uint64_t requests = 0, refused = 0, malformed = 0, sockets = 0, frames = 0, frames_dropped = 0;
    std::uint64_t gave_way = 0;      // connections that were closed for newer ones
    std::uint64_t not_accepted = 0;  // looks at a connection that there was no descriptor for
};

class WebServer {
public:
    /// Opens the port and reads the page. @throws Error BadScene: an address that others reach without a token, a weak token;
    /// BadFile: port in use, the page's files missing
    WebServer(const WebOptions& options, const Scene& scene, Session& session);
    ~WebServer();
    WebServer(const WebServer&) = delete;
    WebServer& operator=(const WebServer&) = delete;

    void start();
    void stop();
    [[nodiscard]] int port() const;
    [[nodiscard]] WebCounts counts() const;  // after stop()

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace seldinger
