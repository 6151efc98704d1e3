// HTTP and WebSocket by Boost.Beast, everything in one thread: connections, frames, wishes and their limits.
#include "session/web_server.h"

#include "core/clock.h"
#include "core/error.h"
#include "session/page_wish.h"
#include "session/session.h"
#include "session/session_limits.h"
#include "session/web_content.h"
#include "session/web_policy.h"

#include <boost/asio.hpp>
#include <boost/beast.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <thread>
#include <utility>

namespace seldinger {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using boost::system::error_code;

constexpr double messages_per_second = 120;
constexpr auto frame_period = std::chrono::milliseconds(25);
constexpr auto request_time = std::chrono::seconds(10);
constexpr double wish_time = 0.3;  // a push lasts so long unless it is said again [s]

/// Whom a connection is counted for: an address of version 4, or a network of version 6, of which one machine has all addresses.
std::string who_is(const asio::ip::address& address)
{
    if (address.is_v4()) return address.to_string();
    if (address.to_v6().is_v4_mapped()) return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6()).to_string();
    const auto bytes = address.to_v6().to_bytes();
    return {bytes.begin(), bytes.begin() + 8};
}

using Frame = std::shared_ptr<const std::string>;
using Files = std::map<std::string, WebFile, std::less<>>;

class Connection;
class Socket;

/// What the connections share; one thread.
struct Hub {
    Session& session;
    Files files;
    WebOptions options;
    WebCounts counts;
    std::set<Socket*> sockets;
    std::map<std::string, std::size_t> connections_of;  // by who_is()
    std::size_t connections = 0;
    std::list<Connection*> waiting;  // for a request, the longest first
    WrongTokens wrong_tokens;
    PageWish wish;

    [[nodiscard]] Admission admitted(const http::request<http::empty_body>& request) const
    {
        const auto text = [&](http::field field) {
            const auto value = request[field];
            return std::string_view(value.data(), value.size());
        };
        const auto target = request.target();
        return admit(
            {{target.data(), target.size()}, text(http::field::host), text(http::field::origin), text(http::field::cookie)},
            options.address, options.token);
    }

    /// Whether `who` may have another connection. At the limit the connection that has waited longest without a whole request is
    /// closed; a page's request comes at once.
    bool make_room(const std::string& who);
    bool give_way(const std::string* of);

    void take(std::string_view message)
    {
        bool reset = false;
        if (!read_wish(message, wish, reset)) {
            ++counts.malformed;
            return;
        }
        wish.until = session.clock() + wish_time;
        wish.resets += reset ? 1 : 0;
        session.page.put(wish);
    }
};

/// A connection's place among those that there may be.
class Place {
public:
    Place(Hub& hub, std::string who) : hub_(hub), who_(std::move(who)) { ++hub_.connections, ++hub_.connections_of[who_]; }
    ~Place()
    {
        --hub_.connections;
        if (--hub_.connections_of[who_] == 0) hub_.connections_of.erase(who_);
    }
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;
    [[nodiscard]] const std::string& who() const { return who_; }

private:
    Hub& hub_;
    std::string who_;
};

/// One WebSocket.
class Socket : public std::enable_shared_from_this<Socket> {
public:
    Socket(beast::tcp_stream stream, Hub& hub, std::unique_ptr<Place> place)
        : stream_(std::move(stream)), hub_(hub), place_(std::move(place))
    {
    }
    ~Socket() { hub_.sockets.erase(this); }

    void accept(http::request<http::empty_body> request)
    {
        hub_.sockets.insert(this);
        request_ = std::move(request);
        stream_.set_option(websocket::stream_base::timeout{request_time, std::chrono::seconds(20), true});
        stream_.read_message_max(most_message_bytes);
        stream_.async_accept(request_, [self = shared_from_this()](error_code error) {
            if (error) return;
            ++self->hub_.counts.sockets;
            self->open_ = true;
            self->read();
        });
    }

    void send(const Frame& frame)
    {
        if (!open_) return;
        if (sending_) {
            ++hub_.counts.frames_dropped;
            return;
        }
        sending_ = frame;
        stream_.binary(true);
        stream_.async_write(asio::buffer(*sending_), [self = shared_from_this()](error_code error, std::size_t) {
            self->sending_.reset();
            if (error) self->open_ = false;
            else ++self->hub_.counts.frames;
        });
    }

    void close() { beast::get_lowest_layer(stream_).cancel(); }

private:
    void read()
    {
        stream_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
            if (error) {
                if (error != websocket::error::closed && error != asio::error::operation_aborted && error != asio::error::eof)
                    ++self->hub_.counts.malformed;
                self->open_ = false;
                return self->close();
            }
            self->take();
        });
    }

    void take()
    {
        const auto data = buffer_.cdata();
        if (!rate_.allow(seconds_of_the_clock())) {  // more than any page sends
            ++hub_.counts.malformed;
            open_ = false;
            return close();
        }
        if (stream_.got_text()) hub_.take({static_cast<const char*>(data.data()), data.size()});
        else ++hub_.counts.malformed;
        buffer_.consume(buffer_.size());
        read();
    }

    websocket::stream<beast::tcp_stream, false>
        stream_;  // without compression, which nobody asks for: half of what this file takes to compile
    Hub& hub_;
    std::unique_ptr<Place> place_;
    http::request<http::empty_body> request_;
    beast::flat_buffer buffer_{most_message_bytes};
    RateLimit rate_{messages_per_second};
    Frame sending_;
    bool open_ = false;
};

/// One HTTP connection, until it becomes a WebSocket.
class Connection : public std::enable_shared_from_this<Connection> {
public:
    Connection(tcp::socket socket, Hub& hub, std::string who)
        : stream_(std::move(socket)), hub_(hub), place_(std::make_unique<Place>(hub, std::move(who))), turn_(hub.waiting.end())
    {
    }
    ~Connection() { stop_waiting(); }
    [[nodiscard]] const std::string& who() const { return place_->who(); }
    void give_way()
    {
        stop_waiting();
        place_.reset();
        stream_.close();
    }

    void read()
    {
        parser_.emplace();
        parser_->header_limit(most_header_bytes);
        parser_->body_limit(0);
        stream_.expires_after(request_time);
        turn_ = hub_.waiting.insert(hub_.waiting.end(), this);
        http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
            self->stop_waiting();
            if (!self->place_) return;  // it gave way
            if (error == http::error::end_of_stream) return self->close();
            if (error) {
                ++self->hub_.counts.malformed;
                return self->close();
            }
            self->answer(self->parser_->release());
        });
    }

private:
    void stop_waiting()
    {
        if (turn_ != hub_.waiting.end()) hub_.waiting.erase(std::exchange(turn_, hub_.waiting.end()));
    }

    void answer(http::request<http::empty_body> request)
    {
        ++hub_.counts.requests;
        if (request.count(http::field::host) != 1 || request.count(http::field::origin) > 1) {  // [RFC 9112, 3.2]
            ++hub_.counts.refused;
            return refuse(request, http::status::bad_request, "expected one Host, and one Origin at most");
        }
        if (!hub_.wrong_tokens.may_try(who(), seconds_of_the_clock())) {
            ++hub_.counts.refused;
            return refuse(request, http::status::too_many_requests,
                          "too many wrong tokens came from this address; wait a second");
        }
        const Admission admission = hub_.admitted(request);
        if (admission == Admission::WrongToken) hub_.wrong_tokens.count(who(), seconds_of_the_clock());
        if (admission != Admission::Welcome) {
            ++hub_.counts.refused;
            static constexpr const char* why[] = {"", "this name is not the session's", "a page of another site asks",
                                                  "the session's token is missing or wrong: open the page with ?token=..."};
            return refuse(request, http::status::forbidden, why[static_cast<int>(admission)]);
        }
        const auto target = request.target();
        const std::string_view path = std::string_view(target.data(), target.size()).substr(0, target.find('?'));
        if (websocket::is_upgrade(request)) return upgrade(path, std::move(request));
        if (request.method() != http::verb::get && request.method() != http::verb::head)
            return refuse(request, http::status::method_not_allowed, "only GET");
        const auto file = hub_.files.find(path);
        if (file == hub_.files.end()) return refuse(request, http::status::not_found, "no such page");
        reply(request, http::status::ok, file->second);
    }

    void upgrade(std::string_view path, http::request<http::empty_body> request)
    {
        if (path != "/ws" || hub_.sockets.size() >= most_sockets) {
            ++hub_.counts.refused;
            if (path != "/ws") return refuse(request, http::status::not_found, "no such page");
            return refuse(request, http::status::service_unavailable, "too many pages are connected; close one");
        }
        stream_.expires_never();
        std::make_shared<Socket>(std::move(stream_), hub_, std::move(place_))->accept(std::move(request));
    }

    void refuse(const http::request<http::empty_body>& request, http::status status, const char* why)
    {
        refusal_ = {"text/plain; charset=utf-8", std::string(why) + "\n"};
        reply(request, status, refusal_);
    }

    /// @param file  outlives the answer
    void reply(const http::request<http::empty_body>& request, http::status status, const WebFile& file)
    {
        response_ = {};
        response_.result(status);
        response_.version(request.version());
        response_.keep_alive(request.keep_alive() && status == http::status::ok);
        response_.set(http::field::content_type, file.type);
        response_.set(http::field::cache_control, "no-store");
        response_.set("Content-Security-Policy",
                      "default-src 'self'; img-src 'self' data:; connect-src 'self' ws: wss:; frame-ancestors 'none'");
        response_.set("X-Content-Type-Options", "nosniff");
        response_.set("Referrer-Policy", "no-referrer");
        const auto target = request.target();
        const std::string token = query_value({target.data(), target.size()}, "token");
        if (status == http::status::ok && !token.empty() &&
            same_secret(token, hub_.options.token))  // another's text is no cookie of ours
            response_.set(http::field::set_cookie, "seldinger_token=" + token + "; HttpOnly; SameSite=Strict; Path=/");
        response_.content_length(file.body.size());
        if (request.method() != http::verb::head) response_.body() = {file.body.data(), file.body.size()};
        stream_.expires_after(request_time * 6);
        http::async_write(stream_, response_, [self = shared_from_this()](error_code error, std::size_t) {
            if (error || !self->response_.keep_alive()) return self->close();
            self->read();
        });
    }

    void close()
    {
        error_code ignored;
        stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    }

    beast::tcp_stream stream_;
    Hub& hub_;
    std::unique_ptr<Place> place_;
    std::list<Connection*>::iterator turn_;  // among those that wait
    beast::flat_buffer buffer_{most_header_bytes};
    std::optional<http::request_parser<http::empty_body>> parser_;
    http::response<http::span_body<const char>> response_;
    WebFile refusal_;  // kept while it is sent; the other files are the hub's
};

bool Hub::make_room(const std::string& who)
{
    const auto of_one = connections_of.find(who);
    if (of_one != connections_of.end() && of_one->second >= most_connections_of_one) return give_way(&who);
    return connections < most_connections || give_way(nullptr);
}

/// @param of  whose connection; none: anybody's
bool Hub::give_way(const std::string* of)
{
    const auto found = std::find_if(waiting.begin(), waiting.end(), [&](const Connection* c) { return !of || c->who() == *of; });
    if (found == waiting.end()) return false;
    ++counts.gave_way;
    (*found)->give_way();
    return true;
}

}  // namespace

struct WebServer::Impl {
    Impl(const WebOptions& options, const Scene& scene, Session& session)
        : hub{session, web_files(scene, session.world().setup(), session.target(), session.branches(), 1 / session.step_length()),
              options, {},
              {},      {},
              0,       {},
              {},      {}}
    {
    }

    void listen()
    {
        acceptor.async_accept([this](error_code error, tcp::socket socket) {
            if (!acceptor.is_open()) return;
            if (error) return listen_later();
            error_code gone;
            const std::string who = who_is(socket.remote_endpoint(gone).address());
            if (!gone && hub.make_room(who)) std::make_shared<Connection>(std::move(socket), hub, who)->read();
            else ++hub.counts.refused;
            listen();
        });
    }

    /// Without a free descriptor, a new connection keeps waiting: asking again at once would take a core until one is free.
    void listen_later()
    {
        ++hub.counts.not_accepted;
        retry.expires_after(frame_period);
        retry.async_wait([this](error_code error) {
            if (!error) listen();
        });
    }

    void tick()
    {
        timer.expires_after(frame_period);
        timer.async_wait([this](error_code error) {
            if (error) return;
            if (!hub.sockets.empty() && hub.session.view.take()) {
                auto frame = std::make_shared<std::string>();
                put_frame(hub.session.view.front(), hub.session.clock(), static_cast<int>(hub.sockets.size()), *frame);
                const auto sockets = hub.sockets;
                for (Socket* socket : sockets) socket->send(frame);
            }
            tick();
        });
    }

    Hub hub;  // outlives the connections, which the context holds
    asio::io_context context{1};
    tcp::acceptor acceptor{context};
    asio::steady_timer timer{context}, retry{context};
    std::thread thread;
    int port = 0;
};

WebServer::WebServer(const WebOptions& given, const Scene& scene, Session& session)
{
    WebOptions options = given;
    if (options.address.starts_with('[') && options.address.ends_with(']'))
        options.address = options.address.substr(1, options.address.size() - 2);
    error_code error;
    const auto address = asio::ip::make_address(options.address, error);
    if (error)
        throw Error(ErrorKind::BadScene,
                    fmt::format("--bind: \"{}\": expected an address such as 127.0.0.1 or 0.0.0.0", options.address));
    if (!address.is_loopback() && options.token.empty())
        throw Error(ErrorKind::BadScene,
                    fmt::format("--bind {}: others can reach this address; give a token with --token", options.address));
    if (!options.token.empty() && !is_token(options.token))
        throw Error(
            ErrorKind::BadScene,
            fmt::format(
                "--token: got {} characters; expected at least {} of A-Z a-z 0-9 - . _ ~ and no others. Fix: leave --token "
                "out, and one is made where others can reach the page",
                options.token.size(), least_token));
    impl_ = std::make_unique<Impl>(options, scene, session);
    tcp::acceptor& acceptor = impl_->acceptor;
    const tcp::endpoint endpoint(address, static_cast<unsigned short>(options.port));
    acceptor.open(endpoint.protocol(), error);
    if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor.bind(endpoint, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (error)
        throw Error(ErrorKind::BadFile, fmt::format("{}:{}: cannot be opened: {}; choose another port with --port",
                                                    options.address, options.port, error.message()));
    impl_->port = acceptor.local_endpoint().port();
}

WebServer::~WebServer()
{
    if (impl_) stop();
}

void WebServer::start()
{
    impl_->listen();
    impl_->tick();
    impl_->thread = std::thread([this] { impl_->context.run(); });
}

void WebServer::stop()
{
    impl_->context.stop();
    if (impl_->thread.joinable()) impl_->thread.join();
}

int WebServer::port() const { return impl_->port; }
WebCounts WebServer::counts() const { return impl_->hub.counts; }

}  // namespace seldinger
